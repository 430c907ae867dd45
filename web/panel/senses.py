"""Senses: the camera's image, the stored view most like it, how different they are, and which cells are active. Tick: one tick
stage by stage, and what its parts cost.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from web.messages import Parameter, PoseCellLayer, Senses, Snapshot, TickWalk, Timing
from web.panel.part import Content

RECENT = 60
MOST = 65535  # the strongest column of pose cells
RATE = "robot.sensor_rate_hz"  # ticks a second


class RecentViews:
    """The views that were active recently, oldest first."""

    def __init__(self) -> None:
        self.numbers: tuple[int, ...] = ()
        self._kept: deque[int] = deque(maxlen=RECENT)
        self._run = self._tick = -1

    def remember(self, snapshot: Snapshot) -> None:
        if snapshot.run != self._run or snapshot.tick < self._tick:  # another run, or gone back in time
            self._kept.clear()
        self._run, self._tick = snapshot.run, snapshot.tick
        active = snapshot.senses.active_view
        if active >= 0 and (not self._kept or self._kept[-1] != active):
            self._kept.append(active)
        if len(self._kept) != len(self.numbers) or (self._kept and self._kept[-1] != self.numbers[-1]):
            self.numbers = tuple(self._kept)


def views(snapshot: Snapshot, recent: tuple[int, ...]) -> Content:
    """Camera image and verdict, what the front end makes of it, the best match, the difference against the threshold, and the
    views that were active recently."""
    senses = snapshot.senses
    data = {
        "known": snapshot.views,
        "recent": recent,
        "active": senses.active_view,
        "verdict": _verdict(senses),
        "seen": {"title": f"{senses.front_end} now", "words": f"the present view: {senses.seen_words}"},
        "best": None,
        "difference": _difference(senses),
    }
    pictures: dict[str, NDArray[Any]] = {"camera": senses.camera, "seen": senses.seen}
    if senses.best is not None:
        words = f"the stored view {senses.best_view}: {senses.best_words}"
        data["best"] = {"view": senses.best_view, "words": words}
        pictures["best"] = senses.best
    return Content(data, pictures)


def _verdict(senses: Senses) -> dict[str, str]:
    """Whether the active view is new, known, a false positive or none, in words."""
    if senses.false_positive:
        words = f"false positive {senses.false_positives}: rightly #{senses.best_view}"
        return {"tone": "false", "words": words}
    if senses.active_view < 0:
        return {"tone": "none", "words": "nothing to see"}
    tone, words = ("new", "new: recruited") if senses.recruited else ("known", "known: recalled")
    return {"tone": tone, "words": words}


def _difference(senses: Senses) -> dict[str, Any]:
    """The difference as a bar, whose full length is twice the threshold."""
    known = senses.difference <= senses.threshold
    if not math.isfinite(senses.difference):
        return {"words": "difference: nothing to compare with", "share": 1.0, "known": known}
    words = f"difference to the best view {senses.difference:.1f} (threshold {senses.threshold:.1f})"
    share = min(max(senses.difference / max(2 * senses.threshold, 1e-9), 0.0), 1.0)
    return {"words": words, "share": round(share, 3), "known": known}


def cells(layer: PoseCellLayer) -> Content:
    """Pose cells from above, and by heading."""
    places, packets, strength = from_above(layer)
    turns = np.bincount(layer.cells[:, 0], weights=layer.activity, minlength=layer.shape[0]).astype(np.float32)
    data = {"size": (layer.shape[1], layer.shape[2])}
    return Content(data, {"places": places, "packets": packets, "strength": strength, "by_heading": turns})


def from_above(layer: PoseCellLayer) -> tuple[NDArray[np.uint32], NDArray[np.uint8], NDArray[np.uint16]]:
    """Each packet's activity summed over theta': places (y' n_x + x'), the packet's rank, and the share of the strongest."""
    _, n_y, n_x = layer.shape
    place = layer.cells[:, 1] * n_x + layer.cells[:, 2]
    rank = np.minimum(layer.owners(), 255)
    pairs, row = np.unique(rank * (n_y * n_x) + place, return_inverse=True)
    sums = np.bincount(row.ravel(), weights=layer.activity, minlength=len(pairs))
    share = np.rint(sums / max(float(sums.max(initial=0.0)), 1e-12) * MOST)
    return (pairs % (n_y * n_x)).astype(np.uint32), (pairs // (n_y * n_x)).astype(np.uint8), share.astype(np.uint16)


def walk(walk: TickWalk | None) -> Content:
    """The stages; those to come have no words yet."""
    if walk is None:
        return Content({"at": None, "stages": []})
    stages = [(stage.title, stage.words if k <= walk.at else "") for k, stage in enumerate(walk.stages)]
    return Content({"at": walk.at, "stages": stages})


def timings(timings: tuple[Timing, ...], parameters: tuple[Parameter, ...]) -> Content:
    """Milliseconds of each part over the last hundred ticks, and how many a tick may take at x1."""
    rate_hz = next((float(p.value) for p in parameters if p.name == RATE), 10.0)
    parts = [(timing.part, round(timing.mean_ms, 3), round(timing.worst_ms, 2)) for timing in timings]
    return Content({"there_are_ms": 1000 / rate_hz, "parts": parts})
