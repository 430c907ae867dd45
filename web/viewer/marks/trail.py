"""A path on a floor whose older parts fade into it."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Palette, Rgb
from web.viewer.primitives.tone_mapping import vertex_paint

SEGMENTS, STEP = 240, 0.16  # plate units
RISE = 0.015  # where the path crosses itself, the newer part is on top


class Trail:
    def __init__(
        self, scene: viser.SceneApi, palette: Palette, name: str, colour: Rgb, thickness: float, dashed: bool = False
    ) -> None:
        self._floor, self._line, self._dashed = np.array(palette.floor), np.array(colour), dashed
        self._segments = scene.add_line_segments(
            name, meshes.NOWHERE, np.zeros((1, 2, 3), np.uint8), thickness=thickness
        )

    def show(self, path: NDArray[np.float64], longest: float = np.inf, half: tuple[float, float] | None = None) -> None:
        """path: (n, 2) on the plate, oldest first. Steps longer than `longest` are left out, and what leaves the floor,
        `half` as wide and deep."""
        if len(path) < 2:
            self.hide()
            return
        line = meshes.lifted(meshes.thinned(path, STEP)[-SEGMENTS - 1 :], 0.02)
        steps = np.hypot(*np.diff(line[:, :2], axis=0).T)
        away: NDArray[np.bool_] = np.asarray(steps > longest)
        if half is not None:
            beside = np.any(np.abs(line[:, :2]) > half, axis=1)
            away |= beside[:-1] | beside[1:]
        line[:, 2] += np.linspace(0.0, RISE, len(line))
        points = meshes.open_line(line)
        points[away] = -50.0
        ages = np.linspace(0.0, 1.0, len(points) + 1) ** 0.7
        tints = vertex_paint(self._floor + (self._line - self._floor) * (0.08 + 0.92 * ages[:, None]))
        colours = np.stack([tints[:-1], tints[1:]], 1)
        every = slice(None, None, -2) if self._dashed else slice(None)
        self._segments.points, self._segments.colors = points[every], colours[every]

    def hide(self) -> None:
        self._segments.points, self._segments.colors = meshes.NOWHERE, np.zeros((1, 2, 3), np.uint8)
