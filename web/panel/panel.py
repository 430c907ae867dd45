"""The side panel as data: what each part holds, how often it is sent, and what each page has been sent.

A part's message is {"type": "panel", "part", "data"}, framed with its arrays if it has any, so that the page can draw them as
they are. Only the parts of open tabs are sent, only when they have changed, and only those arrays that have changed. Each is
made once for all pages.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import orjson
from numpy.typing import NDArray

from web.latest import Throttle
from web.messages import Snapshot
from web.panel.inspected import active, inspected
from web.panel.memory import memory
from web.panel.part import Content
from web.panel.senses import RecentViews, cells, timings, views, walk
from web.panel.truth import numbers, office, series, tags
from web.panel.tune import tune
from web.switches import SWITCHES, Switches

TABS = ("Senses", "Memory", "Inspect", "Tick", "Truth", "Office", "Tune")
SOON_S = 0.05  # after this time, content that came too early is tried again

MANY_BYTES = 4096  # larger colour pictures go as JPEG with whole colours, a fifth of the bytes
_JPEG = (cv2.IMWRITE_JPEG_QUALITY, 93, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444)


@dataclass(frozen=True, slots=True, eq=False)
class PanelInput:
    """Everything that the panel is made from at one moment."""

    snapshot: Snapshot
    recent: tuple[int, ...]  # views
    on: frozenset[str]  # switches


@dataclass(frozen=True, slots=True)
class Part:
    tab: str
    name: str
    hz: float
    of: Callable[[PanelInput], tuple[Any, ...]]  # what it is made from; made again when one is another object
    make: Callable[..., Content]


def _switches(on: frozenset[str]) -> Content:
    rows = [{"name": s.name, "tab": s.tab, "words": s.words, "hint": s.hint, "on": s.name in on} for s in SWITCHES]
    return Content({"switches": rows})


def _office(snapshot: Snapshot) -> tuple[Any, ...]:
    return snapshot.living, snapshot.parameters, snapshot.presets, snapshot.preset, snapshot.switches


PARTS = (
    Part("Senses", "views", 6, lambda s: (s.snapshot, s.recent), views),
    Part("Senses", "cells", 3, lambda s: (s.snapshot.pose_cells,), cells),
    Part("Memory", "switches", 10, lambda s: (s.on,), _switches),
    Part("Memory", "memory", 2, lambda s: (s.snapshot,), memory),
    Part("Inspect", "switches", 10, lambda s: (s.on,), _switches),
    Part("Inspect", "active", 4, lambda s: (s.snapshot,), active),
    Part("Inspect", "inspected", 4, lambda s: (s.snapshot.inspected,), inspected),
    Part("Tick", "walk", 10, lambda s: (s.snapshot.walk,), walk),
    Part("Tick", "timings", 1, lambda s: (s.snapshot.timings, s.snapshot.parameters), timings),
    Part("Truth", "switches", 10, lambda s: (s.on,), _switches),
    Part("Truth", "numbers", 2, lambda s: (s.snapshot,), numbers),
    Part("Truth", "series", 1, lambda s: (s.snapshot.series,), series),
    Part("Office", "office", 5, lambda s: _office(s.snapshot), office),
    Part("Office", "tags", 5, lambda s: (s.snapshot.tags,), tags),
    Part("Tune", "tune", 5, lambda s: (s.snapshot.parameters,), tune),
)


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """A part's content as it is sent."""

    data: bytes
    arrays: dict[str, Packed]


class Panel:
    """What there is to show, for all pages. Each content is made once."""

    def __init__(self, switches: Switches) -> None:
        self._switches = switches
        self._recent = RecentViews()
        self._made: dict[str, tuple[tuple[Any, ...], Made]] = {}

    def remember(self, snapshot: Snapshot) -> None:
        """Keep what the newest snapshot alone does not tell. To be called for every snapshot that is sent."""
        self._recent.remember(snapshot)

    def input_of(self, snapshot: Snapshot) -> PanelInput:
        return PanelInput(snapshot, self._recent.numbers, self._switches.on)

    def made(self, part: Part, of: tuple[Any, ...]) -> Made:
        known = self._made.get(part.name)
        if known is not None and all(a is b for a, b in zip(known[0], of, strict=True)):
            return known[1]
        content = part.make(*of)
        data = orjson.dumps(content.data, option=orjson.OPT_SERIALIZE_NUMPY)
        made = Made(data, {name: packed(array) for name, array in content.arrays.items()})
        self._made[part.name] = of, made
        return made


class PanelReader:
    """One page: the tabs that it has open, and what it has been sent."""

    def __init__(self, panel: Panel) -> None:
        self.tabs: Collection[str] = ()
        self._panel = panel
        self._sent: dict[str, Made] = {}
        self._last: Snapshot | None = None
        self._news: list[str | bytes] = []
        self._throttles = {part: Throttle(part.hz, self._sender(part)) for part in PARTS}

    def news(self, snapshot: Snapshot, now_s: float) -> list[str | bytes]:
        """The messages that are due: text, or bytes where there are arrays."""
        self._news, shown = [], self._panel.input_of(snapshot)
        if snapshot.sought(self._last):
            for throttle in self._throttles.values():
                throttle.hurry()
        self._last = snapshot
        for part, throttle in self._throttles.items():
            if part.tab in self.tabs:
                throttle.offer(now_s, *part.of(shown))
        return self._news

    @property
    def soon_s(self) -> float | None:
        """After how long to ask again even if nothing is new, because something came too early; None: not needed."""
        waiting = any(throttle.waiting for part, throttle in self._throttles.items() if part.tab in self.tabs)
        return SOON_S if waiting else None

    def _sender(self, part: Part) -> Callable[..., None]:
        def send(*of: Any) -> None:
            self._send(part, self._panel.made(part, of))

        return send

    def _send(self, part: Part, made: Made) -> None:
        before = self._sent.get(part.name)
        self._sent[part.name] = made
        arrays = made.arrays
        if before is not None:
            arrays = {name: array for name, array in arrays.items() if array != before.arrays.get(name)}
            if not arrays and made.data == before.data and made.arrays.keys() == before.arrays.keys():
                return
        head = {"type": "panel", "part": part.name, "data": orjson.Fragment(made.data), "has": list(made.arrays)}
        if arrays:
            self._news.append(framed(head, arrays))
        else:
            self._news.append(orjson.dumps(head).decode())


@dataclass(frozen=True, slots=True)
class Packed:
    """One array: how to read it, and its bytes."""

    kind: str  # "u1", "u2", "f4": numbers; "jpeg": a picture that the browser unpacks
    shape: tuple[int, ...]
    body: bytes


def packed(array: NDArray[Any]) -> Packed:
    """An array as it is sent: large colour pictures as JPEG, all others as they are."""
    if array.dtype == np.uint8 and array.ndim == 3 and array.nbytes > MANY_BYTES:
        _, image = cv2.imencode(".jpg", np.ascontiguousarray(array[..., ::-1]), _JPEG)
        return Packed("jpeg", array.shape, image.tobytes())
    little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    return Packed(f"{array.dtype.kind}{array.dtype.itemsize}", array.shape, little.tobytes())


def framed(head: dict[str, Any], arrays: Mapping[str, Packed]) -> bytes:
    """The whole message: four bytes with the head's length (little-endian), the head as JSON, then the arrays one after the
    other. The head gets the arrays' names, kinds, shapes and lengths in their order. Each array begins at a multiple of four:
    the head is padded with spaces, an array with zeros."""
    listed = [{"name": n, "kind": p.kind, "shape": p.shape, "bytes": len(p.body)} for n, p in arrays.items()]
    text = _to_four(orjson.dumps({**head, "arrays": listed}), b" ")
    bodies = (_to_four(array.body, b"\0") for array in arrays.values())
    return b"".join((len(text).to_bytes(4, "little"), text, *bodies))


def _to_four(raw: bytes, filler: bytes) -> bytes:
    return raw + filler * (-len(raw) % 4)
