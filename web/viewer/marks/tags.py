"""The names of tagged places on the map: a ring at each, and its name beside it."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.label_room import TAG, LabelRoom
from web.viewer.primitives.labels import Pill, add_mesh
from web.viewer.primitives.palette import Palette

RING, RING_WIDTH, RING_Z = 0.14, 0.05, 0.1
PILL, BELOW, PILL_Z = 0.4, 0.5, 0.2


class TagMarks:
    """More marks are made when there are more tags; those that are not needed are hidden."""

    def __init__(
        self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom, pill_z: float = PILL_Z
    ) -> None:
        self._pill_z, self._room = pill_z, room
        self._scene, self._palette, self._name = scene, palette, name
        self._rings: list[viser.FrameHandle] = []
        self._pills: list[Pill] = []
        self._shown: tuple[object, ...] = ()

    def show(self, names: list[str], places: NDArray[np.float64]) -> None:
        """places: (k, 2) on the plate. Only what has changed is sent."""
        now = (*names, places.tobytes())
        if now == self._shown:
            return
        self._shown = now
        for k, (name, (x, y)) in enumerate(zip(names, places.tolist(), strict=True)):
            if k == len(self._rings):
                self._add(k)
            self._rings[k].position = (x, y, 0.0)
            self._rings[k].visible = True
            self._pills[k].show(name, self._palette.sheet, (x, y - BELOW, self._pill_z))
        for k in range(len(names), len(self._rings)):
            self._rings[k].visible = False
            self._pills[k].hide()

    def _add(self, k: int) -> None:
        name, palette = f"{self._name}_{k}", self._palette
        self._rings.append(self._scene.add_frame(name, show_axes=False, visible=False))
        add_mesh(self._scene, f"{name}/ring", meshes.ring(RING, RING_WIDTH, RING_Z), palette.lit(palette.text))
        pill = Pill(self._scene, f"{name}_pill", PILL, palette.text, palette, room=self._room, rank=TAG)
        self._pills.append(pill)


def last_named(places: NDArray[np.float64], apart: float) -> list[int]:
    """Those of (n, k) places that are named: of such as are nearer to one another than `apart` only the last."""
    return [k for k, here in enumerate(places) if not (np.linalg.norm(places[k + 1 :] - here, axis=1) <= apart).any()]
