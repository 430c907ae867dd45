"""Marks for what is inspected, on the map and among the pose cells, always in the colour of text."""

from __future__ import annotations

import math

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import CellReport, ExperienceReport, MapLayer, Report, ViewReport, WhyReport
from web.viewer.fits import HEIGHT, CellFit, MapFit, broken_where_it_wraps
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import TAG, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette

LINKS, SPOTS, SPOT_CORNERS = 32, 24, 12
CELLS = 300
ZONE_SEGMENTS = 120
CORNERS = 48
NOTHING = np.zeros((0, 2, 3), np.float32)


class MapMark:
    """A ring and a name at the experience, with its links bright; small rings at all that belong to a view or a cell."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, root: str, room: LabelRoom) -> None:
        self.frame = scene.add_frame(f"{root}/inspected", show_axes=False, visible=False)
        add_mesh(scene, f"{root}/inspected/casing", meshes.ring(0.26, 0.14, 0.08), palette.lit(palette.casing))
        add_mesh(scene, f"{root}/inspected/ring", meshes.ring(0.26, 0.07, 0.1), palette.lit(palette.text))
        self._ink = palette.sheet
        self.pill = Pill(scene, f"{root}/inspected_name", 0.46, palette.text, palette, room=room, rank=TAG)
        self.links = scene.add_line_segments(
            f"{root}/inspected_links",
            meshes.NOWHERE,
            palette.drawn(palette.text),
            thickness=0.045,
        )

    def show(self, report: Report | None, layer: MapLayer | None, fit: MapFit) -> None:
        segments, at = NOTHING, None
        if layer is not None and isinstance(report, ExperienceReport):
            at = fit.to_plate(np.array([[report.pose.x, report.pose.y]]))[0].tolist()
            ends = links_of(report, len(layer.xy))
            segments = meshes.lifted(fit.to_plate(layer.xy), 0.07)[ends].astype(np.float32).reshape(-1, 2, 3)
        elif layer is not None and isinstance(report, ViewReport | CellReport | WhyReport):
            rows = spots_of(report, len(layer.xy))
            spots = [meshes.circle(0.16, (x, y), SPOT_CORNERS) for x, y in fit.to_plate(layer.xy[rows]).tolist()]
            segments = np.concatenate([NOTHING, *(meshes.closed_line(spot, 0.09) for spot in spots)])
        self.frame.visible = at is not None
        self.pill.hide()
        if at is not None and isinstance(report, ExperienceReport):
            self.frame.position = (*at, 0.0)
            self.pill.show(f"#{report.id}", self._ink, (at[0], at[1] + 0.62, 0.3))
        self.links.points = meshes.some(segments, LINKS + SPOTS * SPOT_CORNERS)


class CellMark:
    """An experience's zone of influence as a drum, or a column of cells; and the cells that the view is linked to."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, root: str) -> None:
        self._scene, self._palette, self._root = scene, palette, root
        self.zone = scene.add_line_segments(
            f"{root}/zone", meshes.NOWHERE, palette.drawn(palette.text), thickness=0.035
        )
        self.cells: viser.BatchedMeshHandle | None = None
        self._shape = (0, 0, 0)

    def show(self, report: Report | None, shape: tuple[int, int, int]) -> None:
        fit = CellFit(shape)
        if shape != self._shape or self.cells is None:
            self._shape, self.cells = shape, self._add_cells(fit)
        positions, scales = np.full((CELLS, 3), -50.0, np.float32), np.full(CELLS, 1e-3, np.float32)
        if isinstance(report, ExperienceReport | ViewReport):
            cells, sizes = linked_cells(report)
            positions[: len(cells)], scales[: len(cells)] = fit.cells(cells), sizes
        lines = NOTHING
        if isinstance(report, ExperienceReport):
            lines = zone_lines(report, fit)
        elif isinstance(report, CellReport):
            lines = column_lines(report, fit)
        self.zone.points = meshes.some(lines, ZONE_SEGMENTS)
        self.cells.batched_positions, self.cells.batched_scales = positions, scales

    def _add_cells(self, fit: CellFit) -> viser.BatchedMeshHandle:
        vertices, faces = meshes.sharp(meshes.UNIT_CUBE)
        return self._scene.add_batched_meshes_simple(
            f"{self._root}/view_cells",
            vertices * np.array(fit.voxel, np.float32),
            faces,
            batched_wxyzs=np.tile(np.array([1, 0, 0, 0], np.float32), (CELLS, 1)),
            batched_positions=np.full((CELLS, 3), -50.0, np.float32),
            batched_scales=np.full(CELLS, 1e-3, np.float32),
            batched_colors=np.tile(self._palette.batched(np.array([self._palette.text])), (CELLS, 1)),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )


def links_of(report: ExperienceReport, count: int) -> NDArray[np.int64]:
    """(n, 2) the experiences between which its links go; count: of all that are shown."""
    ends = np.array([(link.start, link.end) for link in report.links], np.int64).reshape(-1, 2)[:LINKS]
    return ends[(ends < count).all(1)]


def spots_of(report: ViewReport | CellReport | WhyReport, count: int) -> list[int]:
    """The experiences that belong to it; count: of all that are shown."""
    return [row for row in report.experiences if row < count][:SPOTS]


def linked_cells(report: ExperienceReport | ViewReport) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """(k, 3) the cells that its view is linked to, strongest first, and (k,) how large each is drawn: 1 fills the cell."""
    links = report.hebbian
    strength = np.minimum(links.strength[:CELLS] / max(links.saturation, 1e-9), 1.0)
    return links.cells[:CELLS], 0.25 + 0.5 * np.sqrt(strength)


def zone_lines(report: ExperienceReport, fit: CellFit) -> np.ndarray:
    """(n, 2, 3) top and bottom of the zone. Where it leaves the box, it goes on at the other side."""
    x, y, theta = report.cell
    around = np.vstack([meshes.circle(report.zone_xy, (x, y), CORNERS), [[x + report.zone_xy, y]]])
    turn = math.tau / fit.shape[0]
    rings: list[np.ndarray] = []
    for layer in (theta - report.zone_theta, theta + report.zone_theta):
        rings.append(broken_where_it_wraps(fit.path(np.column_stack([around, np.full(len(around), layer * turn)]))))
    return np.concatenate(rings)


def column_lines(report: CellReport, fit: CellFit) -> np.ndarray:
    """(8, 2, 3) the column's foot and its four edges."""
    x, y, _ = fit.cells(np.array([[0, report.y, report.x]]))[0]
    half_x, half_y = fit.voxel[0] / 2, fit.voxel[1] / 2
    foot = np.array([(x + a * half_x, y + b * half_y) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    edges = np.stack([meshes.lifted(foot, 0.02), meshes.lifted(foot, HEIGHT)], 1).astype(np.float32)
    return np.concatenate([meshes.closed_line(foot, 0.02), edges])
