"""The route to the goal: a ribbon with a casing, and pills that say in how many seconds the robot will be there."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.label_room import ROUTE, LabelRoom
from web.viewer.primitives.labels import Pill, add_mesh
from web.viewer.primitives.palette import Palette

RIBBON, CASING = 0.15, 0.30
PILLS = 12
EVERY_S, APART = 5.0, 1.15
CLEAR_OF_FLAG, CLEAR_OF_ROBOT = 1.0, 0.7
PILL_M = 0.42


class Route:
    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom) -> None:
        self._palette = palette
        self._casing = add_mesh(scene, f"{name}/casing", meshes.NOTHING, palette.lit(palette.casing))
        self._ribbon = add_mesh(scene, f"{name}/ribbon", meshes.NOTHING, palette.lit(palette.route))
        self._pills = [
            Pill(scene, f"{name}/pill_{k}", PILL_M, palette.route, palette, palette.casing, room, ROUTE)
            for k in range(PILLS)
        ]

    def show(self, xy: NDArray[np.float64], arrival_s: NDArray[np.float32], goal: NDArray[np.float64]) -> None:
        """`xy` (r, 2) on the plate, `arrival_s` (r,) seconds from now; `goal` is where the flag stands."""
        if len(xy) < 2:
            self.hide()
            return
        line = meshes.smoothed(xy, 0.12)
        self._casing.vertices, self._casing.faces = meshes.ribbon(line, CASING, 0.14)
        self._ribbon.vertices, self._ribbon.faces = meshes.ribbon(line, RIBBON, 0.165)
        stops = pill_stops(xy, np.asarray(arrival_s, np.float64), goal, self._palette.letters)
        for k, pill in enumerate(self._pills):
            if k < len(stops):
                seconds, x, y = stops[k]
                pill.show(f"{seconds:.0f} s", self._palette.casing, (x, y, 0.38))
            else:
                pill.hide()

    def hide(self) -> None:
        for mesh in (self._casing, self._ribbon):
            mesh.vertices, mesh.faces = meshes.NOTHING
        for pill in self._pills:
            pill.hide()


def pill_stops(
    xy: NDArray[np.float64], arrival_s: NDArray[np.float64], goal: NDArray[np.float64], letters: float = 1.0
) -> list[tuple[float, float, float]]:
    """(seconds, x, y) at regular times, without those that are too near to another, to the robot or to the flag."""
    stops: list[tuple[float, float, float]] = []
    step = EVERY_S
    while arrival_s[-1] / step > 4 * PILLS:
        step *= 2
    for seconds in np.arange(step, float(arrival_s[-1]), step):
        x, y = (float(np.interp(seconds, arrival_s, xy[:, k])) for k in (0, 1))
        apart = all(np.hypot(x - a, y - b) >= APART * letters for _, a, b in stops)
        clear = (
            np.hypot(*(goal - (x, y))) >= CLEAR_OF_FLAG * letters
            and np.hypot(*(xy[0] - (x, y))) >= CLEAR_OF_ROBOT * letters
        )
        if apart and clear and len(stops) < PILLS:
            stops.append((float(seconds), x, y))
    return stops
