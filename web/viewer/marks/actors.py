"""What moves and changes in the office, in 3-D: leaves of doors, boxes, people, lamps and their light, and daylight. Handles are
moved, not made anew.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import LivingLayer
from web.viewer.fits import METRE_HIGH, OfficeFit
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import add_mesh
from web.viewer.primitives.palette import Palette, Rgb, mix

LEAF_THICK, LEAF_HIGH, LAMP_Z = 0.07, 2.05 * METRE_HIGH, 0.74
LAMP_RADIUS = 0.09
LIT: Rgb = (255, 236, 170)
NIGHT: Rgb = (4, 8, 20)  # laid over the floor
SHINE, POOL, DARKEST = 0.16, 0.6, 0.75  # opacity of a lamp's light; its share of the lamp's reach; opacity of the night
POOL_Z, DARK_Z = 0.026, 0.022  # just above the floor
# transparent meshes are drawn by the distance of their origin: the nearest to the eye last
LATE: NDArray[np.float32] = np.array((0.0, -20.0, 16.0), np.float32)
DOOR_RGB: Rgb = (150, 104, 62)
REACH = 0.35  # plate units: a click this near to a leaf means the door
_SQUARE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
_MESHES = {
    "door": meshes.extruded(_SQUARE, 0.0, 1.0),
    "box": meshes.extruded(_SQUARE, 0.0, 1.0),
    "lamp": meshes.extruded(meshes.circle(1.0), 0.0, 1.0),
}
_NO_ROWS = (np.zeros((0, 4)), np.zeros((0, 6)), np.zeros((0, 5)), np.zeros((0, 4)))


class LivingThings:
    """Handles below `root`, by kind. More are made when there are more things; those that are not needed are hidden."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, root: str) -> None:
        self._scene, self._palette, self._root = scene, palette, root
        self._handles: dict[str, list[_Thing]] = {"door": [], "box": [], "lamp": []}
        self._crowd = Crowd(scene, palette, f"{root}/people")
        hidden = {"position": tuple(LATE.tolist()), "visible": False}
        self._pools = add_mesh(scene, f"{root}/pools", meshes.NOTHING, LIT, opacity=SHINE, **hidden)
        self._dark = add_mesh(scene, f"{root}/dark", meshes.NOTHING, NIGHT, opacity=0.5, **hidden)
        self._lit: tuple[Any, ...] = ()
        self._dimmed: tuple[Any, ...] = ()
        self.layer: LivingLayer | None = None

    def show(self, layer: LivingLayer | None, fit: OfficeFit) -> None:
        self.layer = layer
        rows = _NO_ROWS if layer is None else (layer.doors, layer.boxes, layer.people, layer.lamps)
        doors, boxes, people, lamps = rows
        self._crowd.show(people, np.zeros((0, 3), np.uint8) if layer is None else layer.people_rgb, fit)
        for i, leaf in enumerate(doors):
            self._door(self._handle("door", i, DOOR_RGB), leaf, fit)
        for i, box in enumerate(boxes):
            self._box(self._handle("box", i, _rgb(layer.box_rgb[i]) if layer else DOOR_RGB), box, fit)
        for i, (x, y, _, on) in enumerate(lamps):
            handle = self._handle("lamp", i, LIT if on else unlit(self._palette))
            self._move(handle, fit, float(x), float(y), LAMP_Z * fit.relief, 0.0, (LAMP_RADIUS, LAMP_RADIUS, 0.02))
        for kind, count in zip(self._handles, map(len, (doors, boxes, lamps)), strict=True):
            for thing in self._handles[kind][count:]:
                self._hide(thing)
        self._shine(np.asarray(lamps, np.float64), fit)
        self._dim(1.0 if layer is None else layer.daylight, fit)

    def _shine(self, lamps: NDArray[np.float64], fit: OfficeFit) -> None:
        """Shows light on the floor below each lamp that shines."""
        shining = lamps[lamps[:, 3] > 0]
        now = (shining.tobytes(), fit.scale)
        if now == self._lit:
            return
        self._lit = now
        self._pools.visible = bool(len(shining))
        if len(shining):
            middles = fit.to_plate(shining[:, :2])
            discs = [
                meshes.disc((float(x), float(y)), POOL * float(reach) * fit.scale, POOL_Z, 36)
                for (x, y), reach in zip(middles, shining[:, 2], strict=True)
            ]
            vertices, self._pools.faces = meshes.joined(*discs)
            self._pools.vertices = vertices - LATE

    def _dim(self, daylight: float, fit: OfficeFit) -> None:
        """Darkens the floor: the less daylight, the darker."""
        now = (round(min(max(daylight, 0.0), 1.0), 2), fit.size_m)
        if now == self._dimmed:
            return
        self._dimmed = now
        self._dark.visible = now[0] < 1.0
        if now[0] < 1.0:
            half_x, half_y = (0.5 * side * fit.scale for side in fit.size_m)
            vertices, self._dark.faces = meshes.flat_polygon(2 * _SQUARE * (half_x, half_y), DARK_Z)
            self._dark.vertices = vertices - LATE
            self._dark.opacity = DARKEST * (1.0 - now[0])

    def door_at(self, place: tuple[float, float], fit: OfficeFit) -> tuple[str, bool] | None:
        """The door whose leaf a click (plate units) has hit, and whether the click opens it."""
        if self.layer is None or len(self.layer.doors) == 0:
            return None
        starts, ends = fit.to_plate(self.layer.doors[:, :2]), fit.to_plate(self.layer.doors[:, 2:])
        along = ends - starts
        share = np.clip(((np.array(place) - starts) * along).sum(1) / (along**2).sum(1), 0.0, 1.0)
        away = np.hypot(*(starts + share[:, None] * along - place).T)
        nearest = int(np.argmin(away))
        if away[nearest] > REACH:
            return None
        return self.layer.door_names[nearest], not bool(self.layer.door_wanted[nearest])

    def _door(self, thing: _Thing, leaf: NDArray[np.floating], fit: OfficeFit) -> None:
        x1, y1, x2, y2 = (float(v) for v in leaf)
        size = (math.hypot(x2 - x1, y2 - y1) * fit.scale, LEAF_THICK * fit.relief, LEAF_HIGH * fit.relief)
        self._move(thing, fit, (x1 + x2) / 2, (y1 + y2) / 2, 0.0, math.atan2(y2 - y1, x2 - x1), size)

    def _box(self, thing: _Thing, box: NDArray[np.floating], fit: OfficeFit) -> None:
        x, y, width, depth, height, angle = (float(v) for v in box)
        size = (width * fit.scale, depth * fit.scale, height * METRE_HIGH * fit.relief)
        self._move(thing, fit, x, y, 0.0, angle, size)

    def _handle(self, kind: str, i: int, colour: Rgb) -> _Thing:
        things, paint = self._handles[kind], self._palette.lit(colour)
        if i == len(things):
            things.append(_Thing(add_mesh(self._scene, f"{self._root}/{kind}_{i}", _MESHES[kind], paint), paint))
        if things[i].paint != paint:
            things[i].paint = things[i].handle.color = paint
        return things[i]

    def _move(
        self, thing: _Thing, fit: OfficeFit, x: float, y: float, z: float, angle: float,
        size: tuple[float, float, float],
    ) -> None:  # fmt: skip
        """Moves a thing; only what has changed is sent."""
        px, py = (float(v) for v in fit.to_plate(np.array([[x, y]]))[0])
        now = (px, py, z, angle, size)
        if thing.shown == now:
            return
        thing.shown, handle = now, thing.handle
        handle.position = (px, py, z)
        handle.wxyz = (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))
        handle.scale = size
        handle.visible = True

    def _hide(self, thing: _Thing) -> None:
        if thing.shown is not None:
            thing.shown = None
            thing.handle.visible = False


@dataclass
class _Thing:
    handle: viser.MeshHandle
    paint: Rgb
    shown: tuple[Any, ...] | None = None  # where it stands now; None: hidden


def unlit(palette: Palette) -> Rgb:
    """The colour of a lamp that does not shine."""
    return mix(palette.slab, palette.text_2, 0.3)


def _rgb(row: NDArray[np.uint8]) -> Rgb:
    return int(row[0]), int(row[1]), int(row[2])


HEAD = (0.62, 0.8, 1.0)  # shares of a person's height: shoulders, chin, top
AWAY = (0.0, 0.0, -50.0)  # far below the plates


class Crowd:
    """All people as one batch: handles for each of fifty would need six hundred messages a second. It has a place for each
    person; the places of people who have left are far below the plates."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str) -> None:
        self._scene, self._palette, self._name = scene, palette, name
        self._handle: viser.BatchedMeshHandle | None = None
        self._places = 0
        self._shown: tuple[bytes, ...] = ()

    def show(self, people: NDArray[np.floating], rgb: NDArray[np.uint8], fit: OfficeFit) -> None:
        """people: (n, 5) x, y, heading, radius, height, as in `LivingLayer`. Only what has changed is sent."""
        if len(people) > self._places:
            self._make(len(people))
        if self._handle is None:
            return
        n, rows = len(people), np.asarray(people, np.float64).reshape(-1, 5)
        at = np.tile(np.array(AWAY, np.float32), (self._places, 1))
        sizes, turns = np.ones((self._places, 3)), np.zeros(self._places)
        at[:n, :2], at[:n, 2] = fit.to_plate(rows[:, :2]), 0.0
        sizes[:n, :2] = np.maximum(rows[:, 3:4] * fit.scale, 0.07)
        sizes[:n, 2] = rows[:, 4] * METRE_HIGH * max(fit.relief, 0.5)
        turns[:n] = 0.5 * rows[:, 2]
        colours = np.zeros((self._places, 3), np.uint8)
        if n:
            colours[:n] = self._palette.batched(rgb)
        names = ("batched_positions", "batched_scales", "batched_wxyzs", "batched_colors")
        wxyz = np.column_stack([np.cos(turns), 0 * turns, 0 * turns, np.sin(turns)])
        arrays = (at, sizes.astype(np.float32), wxyz.astype(np.float32), colours)
        now = tuple(array.tobytes() for array in arrays)
        for name, array, is_now, was in zip(names, arrays, now, self._shown or now, strict=True):
            if is_now != was or not self._shown:
                setattr(self._handle, name, array)
        self._shown = now
        if self._handle.visible != bool(n):
            self._handle.visible = bool(n)

    def _make(self, places: int) -> None:
        self._places, self._shown = places, ()
        self._handle = self._scene.add_batched_meshes_simple(
            self._name,
            *_figure(),
            batched_wxyzs=np.tile(np.array((1, 0, 0, 0), np.float32), (places, 1)),
            batched_positions=np.tile(np.array(AWAY, np.float32), (places, 1)),
            batched_scales=np.ones((places, 3), np.float32),
            batched_colors=np.zeros((places, 3), np.uint8),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )


def _figure() -> meshes.Mesh:
    """A person of radius 1 and height 1 who looks along +x."""
    circle, nose = meshes.circle(1.0, corners=20), meshes.rounded_rectangle(0.2, 0.3, 0.08, 4, centre=(0.55, 0.0))
    return meshes.joined(
        meshes.extruded(circle * (0.7, 1.0), 0.0, HEAD[0]),
        meshes.extruded(circle * 0.5, HEAD[0] + 0.02, HEAD[2]),
        meshes.extruded(nose, HEAD[1] - 0.06, HEAD[1] + 0.06),
    )
