"""The route to the goal: a ribbon with its pills, the goal's flag, and how pills are kept from covering each other."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.labels import ROUTE, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette

RIBBON, CASING = 0.15, 0.30
PILLS = 12
EVERY_S, APART = 5.0, 1.15
CLEAR_OF_FLAG, CLEAR_OF_ROBOT = 1.0, 0.7
PILL_M = 0.42


class Route:
    """A ribbon with a casing, and pills that say in how many seconds the robot will be there."""

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


HEIGHT, PILL = 1.5, 0.6
DOT, DOT_Z, DOT_CORNERS = 0.085, 0.09, 12


class GoalFlag:
    """A pole, a pennant, two rings, a pill with the time left, and a dot at each experience that stands for the goal."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom) -> None:
        self._palette, self._room = palette, room
        self._frame = scene.add_frame(name, show_axes=False, visible=False)
        self._dots = add_mesh(scene, f"{name}_places", meshes.NOTHING, palette.lit(palette.goal))
        self._dotted = b""
        for k, (radius, width) in enumerate(((0.24, 0.07), (0.44, 0.04))):
            add_mesh(scene, f"{name}/ring_{k}", meshes.ring(radius, width, 0.12), palette.lit(palette.goal))
        pole = meshes.extruded(meshes.rounded_rectangle(0.07, 0.07, 0.034, 4), 0.0, HEIGHT)
        add_mesh(scene, f"{name}/pole", pole, palette.lit(palette.pole, (0.0, -1.0, 0.0)))
        corners = np.array([(0.03, 0.0, HEIGHT), (0.03, 0.0, HEIGHT - 0.5), (0.75, 0.0, HEIGHT - 0.25)], np.float32)
        pennant = (corners, np.array([[0, 1, 2]], np.uint32))
        add_mesh(scene, f"{name}/pennant", pennant, palette.lit(palette.goal, (0.0, -1.0, 0.0)), side="double")
        self._pill = Pill(scene, f"{name}/pill", PILL, palette.goal, palette)

    def show(self, at: NDArray[np.float64], words: str, places: NDArray[np.float64]) -> None:
        """at: (2,), places: (k, 2), on the plate."""
        self._frame.position = (float(at[0]), float(at[1]), 0.0)
        self._frame.visible = True
        self._pill.show(words, self._palette.on_goal, (0.0, 0.0, HEIGHT + 0.46))
        self._room.fix(self, [((float(at[0]), float(at[1]), HEIGHT + 0.46), self._pill.width, PILL)])
        self._dot(places)

    def hide(self) -> None:
        self._frame.visible = False
        self._room.fix(self, [])
        self._dot(np.zeros((0, 2)))

    def _dot(self, places: NDArray[np.float64]) -> None:
        """Shows a dot at each place. Only what has changed is sent."""
        now = places.tobytes()
        if now != self._dotted:
            self._dotted = now
            dots = [meshes.disc((x, y), DOT, DOT_Z, DOT_CORNERS) for x, y in places.tolist()]
            self._dots.vertices, self._dots.faces = meshes.joined(*dots) if dots else meshes.NOTHING


GAP = 0.1


def spread(
    centres: NDArray[np.float64], widths: NDArray[np.float64], height: float, rounds: int = 60
) -> NDArray[np.float64]:
    """(n, 2) centres in the plane in which pills are seen, moved no more than needed so that no two bars overlap; the first of a
    pair moves less."""
    places = np.array(centres, np.float64)
    for _ in range(rounds):
        moved = False
        for i in range(len(places)):
            for j in range(i + 1, len(places)):
                moved |= _part(places, i, j, (widths[i] + widths[j]) / 2 + GAP, height + GAP)
        if not moved:
            return places
    return _stacked(places, height)


def overlap(a: NDArray[np.float64], b: NDArray[np.float64], width: float, height: float) -> bool:
    """Whether two bars overlap. width, height: the sums of their half widths and of their half heights."""
    return bool(abs(a[0] - b[0]) < width - 1e-9 and abs(a[1] - b[1]) < height - 1e-9)


def _part(places: NDArray[np.float64], i: int, j: int, width: float, height: float) -> bool:
    if not overlap(places[i], places[j], width, height):
        return False
    apart = places[j] - places[i]
    across, up = width - abs(apart[0]), height - abs(apart[1])
    axis, lack = (1, up) if up <= across else (0, across)
    side = 1.0 if apart[axis] >= 0 else -1.0
    places[i, axis] -= side * (lack * 0.3 + 1e-6)
    places[j, axis] += side * (lack * 0.7 + 1e-6)
    return True


def _stacked(places: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """A layout that always works: one above the other, in the order of their heights."""
    order = np.argsort(places[:, 1], kind="stable")
    floor = -np.inf
    for row in order:
        places[row, 1] = floor = max(places[row, 1], floor + height + GAP)
    return places
