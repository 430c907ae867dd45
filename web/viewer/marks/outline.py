"""The true walls under the map, dim, for people only: the robot never learns them."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Rgb

MOST = 1200  # walls; of more, the longest are drawn
PX = 1.5  # at any distance
Segments = NDArray[np.float64]


class Outline:
    def __init__(self, scene: viser.SceneApi, name: str, colour: Rgb, half: tuple[float, float], z: float) -> None:
        """half: of the floor's width and depth."""
        self._half, self._z = half, z
        self._shown = b""
        self.lines = scene.add_line_segments(name, meshes.NOWHERE, colour, thickness=PX, thickness_units="screen")

    def show(self, walls: Segments) -> None:
        """walls: (n, 4) from x, y to x, y on the plate. What leaves the floor is cut off. Only what has changed is sent."""
        inside = clipped(np.asarray(walls, np.float64).reshape(-1, 4), self._half)
        if len(inside) > MOST:
            lengths = np.hypot(inside[:, 2] - inside[:, 0], inside[:, 3] - inside[:, 1])
            inside = inside[np.sort(np.argsort(-lengths, kind="stable")[:MOST])]
        lines = meshes.stepped(np.stack([inside[:, :2], inside[:, 2:]], 1))
        points = np.dstack([lines, np.full(lines.shape[:2], self._z)])
        now = points.tobytes()
        if now != self._shown:
            self._shown = now
            self.lines.points = meshes.some(points, MOST)


def clipped(walls: Segments, half: tuple[float, float]) -> Segments:
    """Those parts of (n, 4) segments that lie within a rectangle around the origin (Liang and Barsky 1984)."""
    start, along = walls[:, :2], walls[:, 2:] - walls[:, :2]
    enters, leaves = np.zeros(len(walls)), np.ones(len(walls))
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in (0, 1):
            near, far = (-half[k] - start[:, k]) / along[:, k], (half[k] - start[:, k]) / along[:, k]
            level = along[:, k] == 0
            beside = level & (np.abs(start[:, k]) > half[k])
            first, last = np.minimum(near, far), np.maximum(near, far)
            enters = np.where(level, enters, np.maximum(enters, first))
            leaves = np.where(level, leaves, np.minimum(leaves, last))
            leaves = np.where(beside, -1.0, leaves)
    kept = leaves > enters
    start, along, enters, leaves = start[kept], along[kept], enters[kept, None], leaves[kept, None]
    return np.hstack([start + enters * along, start + leaves * along])
