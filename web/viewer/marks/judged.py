"""What people alone know, on the map: the true walls, and how far off the estimate is and may be."""

from __future__ import annotations

import math

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.labels import ERROR, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette, Rgb

MOST = 1200  # walls; of more, the longest are drawn
PX = 1.5  # at any distance
Segments = NDArray[np.float64]


class Outline:
    """The true walls under the map, dim. The robot never learns them."""

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


Z, TRUE_Z = 0.2, 0.16
SIGMAS = 2.0  # the ellipse reaches so many standard deviations
LEAST = 0.16  # plate units: a shorter line would lie beneath the arrow
WORTH_M = 0.25  # a smaller error has no number
LABEL_M = 0.34


class Doubt:
    """A line from the estimate to the true place with its length, and an ellipse of its covariance."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, root: str, room: LabelRoom) -> None:
        self._palette = palette
        self._line = scene.add_line_segments(
            f"{root}/error", meshes.NOWHERE, palette.drawn(palette.true_path), thickness=0.06
        )
        self._true = scene.add_frame(f"{root}/true_place", show_axes=False, visible=False)
        add_mesh(scene, f"{root}/true_place/ring", meshes.ring(0.17, 0.06), palette.lit(palette.true_path))
        add_mesh(scene, f"{root}/true_place/dot", meshes.disc((0.0, 0.0), 0.07, 0.0), palette.lit(palette.true_path))
        self._label = Pill(scene, f"{root}/error_label", LABEL_M, palette.true_path, palette, room=room, rank=ERROR)
        self._ellipse = scene.add_line_segments(
            f"{root}/doubt",
            meshes.closed_line(meshes.circle(1.0, corners=48), 0.0),
            palette.drawn(palette.robot),
            thickness=2.0,
            thickness_units="screen",
            visible=False,
        )
        self._shown: tuple[float, ...] = ()

    def show_error(self, estimate: NDArray[np.float64], true: NDArray[np.float64] | None, metres: float) -> None:
        """Both (2,) on the plate; true: None where nobody knows it."""
        apart = 0.0 if true is None else math.dist(estimate, true)
        self._true.visible = true is not None and apart >= LEAST
        if true is None or apart < LEAST:
            self._line.points = meshes.NOWHERE
            self._label.hide()
            return
        ends = meshes.stepped(np.stack([estimate, true]))
        self._line.points = meshes.lifted(ends, Z)[None].astype(np.float32)
        self._true.position = (*ends[1].tolist(), TRUE_Z)
        words = words_of(metres)
        if not words:
            self._label.hide()
            return
        x, y = ends[1].tolist()
        self._label.show(words, self._palette.sheet, (x, y + 0.42, 0.4))

    def show_spread(self, at: NDArray[np.float64], along: float, across: float, turn_rad: float) -> None:
        """at: (2,), along and across: one standard deviation each, all in plate units."""
        x, y, a, b = (float(v) for v in meshes.stepped(np.array([*at, SIGMAS * along, SIGMAS * across])))
        now = (x, y, a, b, round(turn_rad, 2))
        if now != self._shown:
            self._shown = now
            self._ellipse.position = (x, y, Z)
            self._ellipse.wxyz = (math.cos(turn_rad / 2), 0.0, 0.0, math.sin(turn_rad / 2))
            self._ellipse.scale = (max(a, 1e-3), max(b, 1e-3), 1.0)
        self._ellipse.visible = True

    def hide_error(self) -> None:
        self.show_error(np.zeros(2), None, 0.0)

    def hide_spread(self) -> None:
        self._ellipse.visible = False


def words_of(metres: float) -> str:
    if metres < WORTH_M:
        return ""
    return f"{metres:.1f} m off" if metres < 10 else f"{metres:.0f} m off"
