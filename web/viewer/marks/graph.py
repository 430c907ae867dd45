"""The map's pose graph: its links as lines, its experiences as dots, and where loops were closed.

Lines and dots lie some hundred in each scene node. Only nodes in which one has moved or changed its colour are sent again, so a
large map costs what moves in it, and a new experience costs no more in it than in a small one.
"""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import Closure
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import CLOSURE, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette, Rgb

LINES_A_NODE = 192
PX = 1.0  # thickness at any distance; with a thickness in plate units, viser would draw each line twice


class Links:
    def __init__(self, scene: viser.SceneApi, name: str, colour: Rgb) -> None:
        self._scene, self._name, self._colour = scene, name, colour
        self.nodes: list[viser.LineSegmentsHandle] = []

    def show(self, places: NDArray[np.floating], links: NDArray[np.integer]) -> None:
        """places: (n, 3) of the experiences; links: (m, 2) rows of it. There and back are one line; old lines come first."""
        pairs = np.unique(np.sort(links.reshape(-1, 2), 1)[:, ::-1], axis=0)
        lines = places[pairs].astype(np.float32)
        for k in range(0, max(len(lines), len(self.nodes) * LINES_A_NODE), LINES_A_NODE):
            if k == len(self.nodes) * LINES_A_NODE:
                self._add()
            self.nodes[k // LINES_A_NODE].points = meshes.some(lines[k : k + LINES_A_NODE], LINES_A_NODE)

    def _add(self) -> None:
        name = f"{self._name}_{len(self.nodes)}"
        line = self._scene.add_line_segments(name, meshes.NOWHERE, self._colour, thickness=PX, thickness_units="screen")
        self.nodes.append(line)


DOTS_A_NODE = 256
FAR = -50.0


class Nodes:
    def __init__(self, scene: viser.SceneApi, name: str, size: float) -> None:
        self._scene, self._name, self._size = scene, name, size
        self.clouds: list[viser.PointCloudHandle] = []

    def place(self, places: NDArray[np.floating]) -> None:
        """(n, 3) where the dots are; there are no others."""
        for k in range(max(-(-len(places) // DOTS_A_NODE), len(self.clouds))):
            if k == len(self.clouds):
                self._add()
            points = np.full((DOTS_A_NODE, 3), FAR, np.float32)
            some = places[k * DOTS_A_NODE : (k + 1) * DOTS_A_NODE]
            points[: len(some)] = some
            self.clouds[k].points = points

    def paint(self, colours: NDArray[np.uint8]) -> None:
        """(n, 3); of more dots than there are, the first count."""
        for k, cloud in enumerate(self.clouds):
            painted = np.zeros((DOTS_A_NODE, 3), np.uint8)
            some = colours[k * DOTS_A_NODE : (k + 1) * DOTS_A_NODE]
            painted[: len(some)] = some
            cloud.colors = painted

    def _add(self) -> None:
        name, far = f"{self._name}_{len(self.clouds)}", np.full((DOTS_A_NODE, 3), FAR, np.float32)
        black, size = np.zeros((DOTS_A_NODE, 3), np.uint8), self._size
        cloud = self._scene.add_point_cloud(
            name, far, black, point_size=size, point_shape="circle", point_shading="flat"
        )
        self.clouds.append(cloud)


RING, WIDTH, Z = 0.2, 0.07, 0.11
LABEL_M, ABOVE, LABEL_Z = 0.4, 0.48, 0.45
MOST = 4  # are marked
WORTH_M = 0.05  # a smaller correction has no number
TOLD_S = 40.0  # so long the newest says what it did
REACH = 0.3  # plate units: a click this near to a ring means it


class ClosureMarks:
    """A ring at the experience that was met again at each loop closure; the newest says how far it moved the map."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom) -> None:
        self._ink, colour = palette.sheet, palette.packets[3]
        self._label_m = LABEL_M * palette.letters
        self._rings: list[viser.FrameHandle] = []
        for k in range(MOST):
            self._rings.append(scene.add_frame(f"{name}_{k}", show_axes=False, visible=False))
            add_mesh(scene, f"{name}_{k}/casing", meshes.ring(RING, 2 * WIDTH, Z), palette.lit(palette.casing))
            add_mesh(scene, f"{name}_{k}/ring", meshes.ring(RING, WIDTH, Z + 0.02), palette.lit(colour))
        self._label = Pill(scene, f"{name}_label", LABEL_M, colour, palette, room=room, rank=CLOSURE)
        self._told = False  # whether the newest has its label
        self._shown: list[tuple[Closure, NDArray[np.float64]]] = []

    def show(self, closures: tuple[Closure, ...], places: NDArray[np.float64], time_s: float) -> None:
        """places: (n, 2) of all experiences on the plate; time_s: now."""
        last = [closure for closure in closures[-MOST:] if closure.end < len(places)]
        self._shown = [(closure, meshes.stepped(places[closure.end])) for closure in last]
        for k, ring in enumerate(self._rings):
            ring.visible = k < len(last)
            if k < len(last):
                x, y = self._shown[k][1].tolist()
                ring.position = (x, y, 0.0)
        self._told = bool(last) and time_s - last[-1].time_s <= TOLD_S
        if not self._told:
            self._label.hide()
            return
        x, y = self._shown[-1][1].tolist()
        self._label.show(words_of(last[-1]), self._ink, (x, y + ABOVE, LABEL_Z))

    def at(self, place: tuple[float, float]) -> Closure | None:
        """The closure whose ring or label a click (plate units) has hit; the newest where rings lie over one another."""
        for k, (closure, (x, y)) in enumerate(reversed(self._shown)):
            if np.hypot(x - place[0], y - place[1]) <= REACH:
                return closure
            if k == 0 and self._told:
                x, y, _ = self._label.frame.position
                if abs(x - place[0]) <= self._label.width / 2 and abs(y + 0.3 - place[1]) <= self._label_m / 2:
                    return closure
        return None


def words_of(closure: Closure) -> str:
    if closure.moved_m < WORTH_M:
        return "loop closed"
    return f"loop closed: moved the map by {closure.moved_m:.1f} m"
