"""The goal's flag on the map: a pole, a pennant, two rings, a pill with the time left, and a dot at each experience that
stands for the goal."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.label_room import LabelRoom
from web.viewer.primitives.labels import Pill, add_mesh
from web.viewer.primitives.palette import Palette

HEIGHT, PILL = 1.5, 0.6
DOT, DOT_Z, DOT_CORNERS = 0.085, 0.09, 12


class GoalFlag:
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
