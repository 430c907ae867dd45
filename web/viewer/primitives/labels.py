"""Words in the scene that change in place: a sign lies flat or leans towards the eye; a pill is a sign on a bar.

The labels over a plate share its room, in which what may move gives way to what stays where it is, so that none covers another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import images, meshes
from web.viewer.primitives.palette import Palette, Rgb

Array = NDArray[np.float64]
Place = tuple[float, float, float]
LEAN_RAD = math.radians(90 - 50)  # labels face a camera 50 degrees above the horizon
FLAT = (1.0, 0.0, 0.0, 0.0)
LEANING = (math.cos(LEAN_RAD / 2), math.sin(LEAN_RAD / 2), 0.0, 0.0)
LEANING_NORMAL = (0.0, -math.sin(LEAN_RAD), math.cos(LEAN_RAD))
GAP = 0.08  # plate units
NEAR = 8  # labels around which a free place is looked for first
NAME, TAG, ROUTE, CLOSURE, ROBOT, GHOST, ERROR = range(7)  # the later one gives way


def add_mesh(scene: viser.SceneApi, name: str, mesh: meshes.Mesh, colour: Rgb, **options: Any) -> viser.MeshHandle:
    return scene.add_mesh_simple(name, *mesh, color=colour, cast_shadow=False, receive_shadow=False, **options)


def add_picture(
    scene: viser.SceneApi, name: str, image: images.Pixels, width: float, height: float, **options: Any
) -> viser.ImageHandle:
    options.setdefault("format", "png")
    upright = images.upright(image)
    return scene.add_image(name, upright, width, height, cast_shadow=False, receive_shadow=False, **options)


class Sign:
    """Words in a line `height` high, smaller if they were longer than `most`; `anchor` says which end of them is at the
    place."""

    def __init__(
        self, scene: viser.SceneApi, name: str, height: float, *, anchor: str = "left", leaning: bool = False,
        most: float = math.inf,
    ) -> None:  # fmt: skip
        self._height, self._most = height * 1.3, most
        self._anchor = {"left": 0.5, "centre": 0.0, "right": -0.5}[anchor]
        self._image = images.text(" ", (0, 0, 0), 16)
        self.handle = add_picture(
            scene, name, self._image, 0.1, self._height, visible=False, wxyz=LEANING if leaning else FLAT
        )

    def show(self, image: images.Pixels, at: Place) -> None:
        """`image` comes from `images.text`, which hands out the same object for the same words."""
        ratio = image.shape[1] / image.shape[0]
        height = min(self._height, self._most / ratio)
        width = height * ratio
        if image is not self._image:
            self._image = image
            self.handle.image = images.upright(image)
            self.handle.render_width, self.handle.render_height = width, height
        self.handle.position = (at[0] + width * self._anchor, at[1], at[2])
        self.handle.visible = True

    def hide(self) -> None:
        self.handle.visible = False


class Pill:
    """Words on a rounded bar that leans towards the eye, centred at a place; in a room, where it covers nothing. The bar is an
    opaque mesh, because transparent images hide what is drawn after them."""

    def __init__(
        self, scene: viser.SceneApi, name: str, height: float, fill: Rgb, palette: Palette, rim: Rgb | None = None,
        room: LabelRoom | None = None, rank: int = 0,
    ) -> None:  # fmt: skip
        """height: where letters are 1; rank: which label of the room gives way to which."""
        height *= palette.letters
        self._height, self._room, self._rank = height, room, rank
        self._words: str = ""
        self.width = 0.0
        self.frame = scene.add_frame(name, show_axes=False, visible=False, wxyz=LEANING)
        self._bar = add_mesh(scene, f"{name}/bar", meshes.NOTHING, palette.lit(fill, LEANING_NORMAL), side="double")
        self._rim = None
        if rim is not None:
            self._rim = add_mesh(scene, f"{name}/rim", meshes.NOTHING, palette.lit(rim, LEANING_NORMAL), side="double")
        self._ink = Sign(scene, f"{name}/words", height * 0.62, anchor="centre")

    def show(self, words: str, ink: Rgb, at: Place) -> None:
        if words != self._words:
            self._words = words
            image = images.text(words, ink, 72, True)
            self.width = pill_width(words, self._height)
            self._ink.show(image, (0.0, 0.0, 0.012))
            self._bar.vertices, self._bar.faces = _bar(self.width, self._height, 0.0)
            if self._rim is not None:
                self._rim.vertices, self._rim.faces = _bar(self.width + 0.09, self._height + 0.09, -0.012)
        if self._room is None:
            self._move(at)
        else:
            self._room.put(self, self._rank, at, (self.width, self._height), self._move)
        self.frame.visible = True

    def hide(self) -> None:
        self.frame.visible = False
        if self._room is not None:
            self._room.leave(self)

    def _move(self, at: Place) -> None:
        self.frame.position = at


def pill_width(words: str, height: float) -> float:
    """How wide the bar under `words` will be."""
    image = images.text(words, (0, 0, 0), 72, True)
    return max(height, height * 0.62 * 1.3 * image.shape[1] / image.shape[0] + height * 0.6)


def _bar(width: float, height: float, z: float) -> meshes.Mesh:
    return meshes.flat_polygon(meshes.rounded_rectangle(width, height, height / 2 - 1e-4), z)


class LabelRoom:
    """The labels of one plate, as an eye before it sees them. One that has to give way moves aside, forwards or backwards."""

    def __init__(self, half: tuple[float, float]) -> None:
        """half: of the width and of the depth in which labels are kept, plate units."""
        self._room = np.array([_seen((-half[0], -half[1], 0.0)), _seen((half[0], half[1], 1.5))])
        self._fixed: dict[Hashable, tuple[int, Array]] = {}
        self._labels: dict[Hashable, _Label] = {}

    def fix(self, owner: Hashable, things: Sequence[tuple[Place, float, float]], rank: int = NAME) -> None:
        """These labels or bodies of an owner, each with its place, width and height, stay where they are; there are no others
        of it."""
        bars = np.array([(*_seen(at), width, height) for at, width, height in things]).reshape(-1, 4)
        if not np.array_equal(bars, self._fixed.get(owner, (rank, np.zeros((0, 4))))[1]):
            self._fixed[owner] = rank, bars
            self._settle(rank)

    def put(
        self, owner: Hashable, rank: int, at: Place, size: tuple[float, float], move: Callable[[Place], None]
    ) -> None:
        """A label that would be best `at` a place. move: takes it to one."""
        self._labels[owner] = _Label(rank, at, size, move)
        self._settle(rank, owner)

    def leave(self, owner: Hashable) -> None:
        label = self._labels.pop(owner, None)
        if label is not None:
            self._settle(label.rank)

    def _settle(self, rank: int, owner: Hashable | None = None) -> None:
        """Gives all labels from a rank on their places; of that rank, those from this owner's on."""
        placed: list[Array] = []
        before = owner is not None
        for key, label in sorted(self._labels.items(), key=lambda item: item[1].rank):
            before = before and key != owner
            if label.rank >= rank and not before:
                fixed = [bars for first, bars in self._fixed.values() if first <= label.rank]
                taken = np.vstack([np.zeros((0, 4)), *fixed, *placed])
                wanted, size = _seen(label.at), np.array(label.size)
                bar = np.concatenate([clear_place(wanted, size, taken, self._room, GAP), size])
                if not np.array_equal(bar, label.bar):
                    label.bar = bar
                    aside, up = (bar[:2] - wanted).tolist()
                    label.move((label.at[0] + aside, label.at[1] + up / math.cos(LEAN_RAD), label.at[2]))
            placed.append(label.bar)


@dataclass
class _Label:
    rank: int
    at: Place
    size: tuple[float, float]
    move: Callable[[Place], None]
    bar: Array = field(default_factory=lambda: np.full(4, np.nan))  # as it is seen; it has no place yet


def _seen(at: Place) -> Array:
    """(2,) a place of the plate in the plane in which labels lie."""
    return np.array([at[0], at[1] * math.cos(LEAN_RAD) + at[2] * math.sin(LEAN_RAD)])


def clear_place(at: Array, size: Array, taken: Array, room: Array, gap: float) -> Array:
    """The place nearest to `at` (2,) where the bar of a label covers nothing; where there is none, `at` within the room.

    size: (2,) of the bar; taken: (n, 4) middles and sizes of bars; room: (2, 2) its lower left corner and its upper right one.
    """
    low, high = room[0] + size / 2, room[1] - size / 2
    low, high = np.minimum(low, (low + high) / 2), np.maximum(high, (low + high) / 2)
    wanted = np.clip(at, low, high)
    reach = (taken[:, 2:] + size) / 2 + gap
    order = np.argsort(np.abs((taken[:, :2] - wanted) / np.maximum(reach, 1e-9)).max(1), kind="stable")
    if not _covered(wanted[None], taken, reach)[0]:
        return wanted
    for some in (order[:NEAR], order[: 3 * NEAR], order):
        across, up = (
            np.concatenate([wanted[k : k + 1], taken[some, k] - reach[some, k], taken[some, k] + reach[some, k]])
            for k in (0, 1)
        )
        places = np.stack(np.meshgrid(across, up), -1).reshape(-1, 2)
        places = places[((places >= low) & (places <= high)).all(1)]
        free = places[~_covered(places, taken, reach)]
        if len(free):
            return free[np.hypot(*(free - wanted).T).argmin()]
    return wanted


def _covered(places: Array, taken: Array, reach: Array) -> NDArray[np.bool_]:
    """(k,) whether a bar at each place (k, 2) would cover one. reach: (n, 2) how far their middles must be apart."""
    across, up = (np.abs(places[:, k, None] - taken[:, k]) < reach[:, k] - 1e-9 for k in (0, 1))
    return np.any(across & up, axis=1)
