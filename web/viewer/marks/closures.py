"""Where loops were closed: a ring at the experience that was met again; the newest says how far it moved the map."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import Closure
from web.viewer.primitives import meshes
from web.viewer.primitives.label_room import CLOSURE, LabelRoom
from web.viewer.primitives.labels import Pill, add_mesh
from web.viewer.primitives.palette import Palette

RING, WIDTH, Z = 0.2, 0.07, 0.11
LABEL_M, ABOVE, LABEL_Z = 0.4, 0.48, 0.45
MOST = 4  # are marked
WORTH_M = 0.05  # a smaller correction has no number
TOLD_S = 40.0  # so long the newest says what it did
REACH = 0.3  # plate units: a click this near to a ring means it


class ClosureMarks:
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
