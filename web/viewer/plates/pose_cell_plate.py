"""The pose-cell plate: where the network believes the robot is. Packets are voxels in a glass box; their glow is below."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import ExperienceReport, GoalMemoryLayer, Hypothesis, OccupancyLayer, PoseCellLayer, Report, Snap
from web.messages.robot_status import packet_words
from web.viewer.camera_views import CELLS_AT, camera_for, seen_by
from web.viewer.fits import HEIGHT, SIDE, CellFit, broken_where_it_wraps
from web.viewer.marks.hypotheses import CellHypotheses
from web.viewer.marks.inspected import CellMark
from web.viewer.marks.route import spread
from web.viewer.plates import overlays
from web.viewer.plates.plate import FLOOR_Z, Plate, point_on_plane
from web.viewer.primitives import images, meshes
from web.viewer.primitives.labels import LEAN_RAD, Pill, Place, Sign, add_mesh, add_picture, pill_width
from web.viewer.primitives.palette import Palette, mix, vertex_paint

ORIGIN = (*CELLS_AT, 0.0)
HALF = SIDE / 2
VOXELS, VOXEL_STEP, VOXEL_SPARE = 500, 64, 128  # room for them grows in steps, and shrinks when this much is unused
PACKETS = 4
PATH_SEGMENTS, PATH_STEP = 120, 0.1
DASHES = 48
FLOOR_PX = 288
PILL_M = 0.62
BELIEVES = "where the network believes the robot is"
NO_ACTIVITY = "no activity yet"
SNAPPED = "where it believes it is - S to F: the last snap"
LEAST_SHARE = 0.005  # a packet with less would show as 0 %
WEAKEST = 0.02  # share of the strongest cell


class PoseCellPlate(Plate):
    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str = "pose_cells") -> None:
        super().__init__(scene, palette, name, ORIGIN)
        self.set_heading("Pose cells", BELIEVES)
        self._box = GlassBox(scene, palette, self.root)
        self._shape: tuple[int, int, int] = (0, 0, 0)
        self._layer: PoseCellLayer | None = None
        self._shown = 0  # voxels
        self._fit = CellFit((36, 60, 60))
        self._ground = images.gridded_floor((SIDE, SIDE), FLOOR_PX / SIDE, palette.floor, palette.grid, SIDE / 16)
        self.under = self._ground  # the floor image that the glow falls on
        lies = {"position": (0, 0, FLOOR_Z), "format": "jpeg", "jpeg_quality": 80}
        self._floor = add_picture(scene, f"{self.root}/floor", self._ground, SIDE, SIDE, **lies)
        self._capacity = VOXEL_STEP
        self._voxels = self._add_voxels()
        self._path = scene.add_line_segments(
            f"{self.root}/path", meshes.NOWHERE, palette.drawn(palette.packet_path), thickness=0.04
        )
        self._snap = scene.add_line_segments(
            f"{self.root}/snap", meshes.NOWHERE, palette.drawn(palette.goal), thickness=0.05
        )
        drops = np.repeat(vertex_paint(palette.packets)[:, None], 2, 1)
        nowhere = np.repeat(meshes.NOWHERE, PACKETS, 0)
        self._drops = scene.add_line_segments(f"{self.root}/drops", nowhere, drops, thickness=0.03)
        self._rings = [
            add_mesh(scene, f"{self.root}/ring_{k}", meshes.ring(0.36, 0.05), palette.lit(colour), visible=False)
            for k, colour in enumerate(palette.packets)
        ]
        self._pills = [
            Pill(scene, f"{self.root}/packet_{k}", PILL_M, colour, palette) for k, colour in enumerate(palette.packets)
        ]
        self._ends = [Pill(scene, f"{self.root}/snap_{letter}", 0.4, palette.goal, palette) for letter in "SF"]
        self._empty = Sign(scene, f"{self.root}/empty", 0.4 * palette.letters, anchor="centre", leaning=True)
        self._others = CellHypotheses(scene, palette, f"{self.root}/other")
        self.mark = CellMark(scene, palette, self.root)
        self._way = scene.add_frame(f"{self.root}/way", show_axes=False, visible=False)
        add_mesh(scene, f"{self.root}/way/casing", way_arrow(0.05), palette.lit(palette.casing), position=(0, 0, 0.02))
        add_mesh(scene, f"{self.root}/way/body", way_arrow(0.0), palette.lit(palette.goal), position=(0, 0, 0.03))
        self._goal = add_mesh(
            scene, f"{self.root}/goal", meshes.ring(0.24, 0.08, 0.02), palette.lit(palette.goal), visible=False
        )

    @property
    def fit(self) -> CellFit:
        return self._fit

    def _add_voxels(self) -> viser.BatchedMeshHandle:
        vertices, faces = meshes.sharp(meshes.UNIT_CUBE)
        return self.scene.add_batched_meshes_simple(
            f"{self.root}/voxels",
            vertices * np.array(self._fit.voxel, np.float32),
            faces,
            batched_wxyzs=np.tile(np.array([1, 0, 0, 0], np.float32), (self._capacity, 1)),
            batched_positions=np.full((self._capacity, 3), -50.0, np.float32),
            batched_scales=np.full(self._capacity, 1e-3, np.float32),
            batched_colors=np.zeros((self._capacity, 3), np.uint8),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )

    def set_cells(self, layer: PoseCellLayer) -> None:
        """Shows voxels and packets, each packet with its id, the winner always in the first colour."""
        self._set_shape(layer)
        self._layer = layer
        owned = np.minimum(layer.owners(), PACKETS - 1)
        self._draw_voxels(layer, owned)
        self._draw_packets(layer)
        self._draw_snap(layer.last_snap)
        if len(layer.cells):
            self._empty.hide()
        else:
            self._empty.show(images.text(NO_ACTIVITY, self.palette.text_2, 64), (0.0, 0.0, 1.0))

    def _set_shape(self, layer: PoseCellLayer) -> None:
        if layer.shape == self._shape:
            return
        self._shape, self._fit = layer.shape, CellFit(layer.shape)
        _, n_y, n_x = layer.shape
        self._box.set_extent(n_x * layer.cell_m, n_y * layer.cell_m)
        self._voxels = self._add_voxels()

    def _draw_voxels(self, layer: PoseCellLayer, owned: np.ndarray) -> None:
        strength = layer.activity / max(float(layer.activity.max(initial=0.0)), 1e-9)
        rows = np.flatnonzero(strength > WEAKEST)[:VOXELS]
        self._shown = len(rows)  # the first of `layer.cells`, since the strongest come first
        rows = rows[np.lexsort(layer.cells[rows].T)]  # in order of place, so that unchanged places are not sent again
        if not self._capacity - VOXEL_SPARE <= len(rows) <= self._capacity:
            self._capacity = VOXEL_STEP * max(1, math.ceil(len(rows) / VOXEL_STEP))
            self._voxels = self._add_voxels()
        positions = np.full((self._capacity, 3), -50.0, np.float32)
        positions[: len(rows)] = self._fit.cells(layer.cells[rows])
        scales = np.full(self._capacity, 1e-3, np.float32)
        scales[: len(rows)] = meshes.stepped(0.4 + 0.6 * np.sqrt(strength[rows]))
        colours = np.zeros((self._capacity, 3), np.uint8)
        shade = 0.72 + 0.28 * np.rint(strength[rows, None] * 64) / 64
        colours[: len(rows)] = self.palette.batched(np.array(self.palette.voxels)[owned[rows]] * shade)
        self._voxels.batched_positions = positions
        self._voxels.batched_scales = scales
        self._voxels.batched_colors = colours

    def _draw_packets(self, layer: PoseCellLayer) -> None:
        packets = [packet for packet in layer.packets[:PACKETS] if packet.mass >= LEAST_SHARE]
        tops = np.array([self._fit.packet(p) for p in packets]).reshape(-1, 3)
        words = [packet_words(packet.id, packet.mass, len(packets) == 1) for packet in packets]
        height = PILL_M * self.palette.letters
        places = pill_places(tops, np.array([pill_width(w, height) for w in words]), self.origin, height)
        for k, pill in enumerate(self._pills):
            self._rings[k].visible = k < len(packets)
            if k >= len(packets):
                pill.hide()
                continue
            x, y, z = places[k].tolist()
            pill.show(words[k], self.palette.on_packet, (x, y, z))
            self._rings[k].position = (float(tops[k, 0]), float(tops[k, 1]), 0.01)
        feet = tops * (1.0, 1.0, 0.0)
        drops = np.full((PACKETS, 2, 3), -50.0, np.float32)
        drops[: len(packets)] = np.stack([feet, tops], 1)
        self._drops.points = drops

    def _draw_snap(self, snap: Snap | None) -> None:
        if snap is None:
            for pill in self._ends:
                pill.hide()
            self._snap.points = meshes.NOWHERE
            self.set_heading("Pose cells", BELIEVES)
            return
        start, end = self._fit.packet(snap.start), self._fit.packet(snap.end)
        self.set_heading("Pose cells", SNAPPED)
        self._snap.points = meshes.some(meshes.dashes(start, end, 0.2, 0.13), DASHES)
        for pill, letter, at in zip(self._ends, "SF", (start, end), strict=True):
            pill.show(letter, self.palette.on_goal, (float(at[0]), float(at[1]), float(at[2])))

    def set_others(self, others: Sequence[Hypothesis], shape: tuple[int, int, int]) -> None:
        """Shows the states of the hypotheses beside the pose estimate."""
        self._others.show(others, CellFit(shape))

    def set_path(self, path: NDArray[np.float32], shape: tuple[int, int, int]) -> None:
        """Shows the winner's path of the last two minutes, (p, 3): x', y' in cells and heading."""
        points = meshes.thinned(CellFit(shape).path(np.asarray(path, np.float64).reshape(-1, 3)), PATH_STEP)
        self._path.points = meshes.some(broken_where_it_wraps(points), PATH_SEGMENTS)

    def set_glow(self, layer: PoseCellLayer, under: images.Pixels) -> None:
        """Shows on the floor, over `under`, the activity projected onto x'y', in the colour of its packet."""
        self._floor.image = images.upright(glow(layer, under, self.palette))

    def set_floor(
        self, shape: tuple[int, int, int], occupancy: OccupancyLayer | None, goal: GoalMemoryLayer | None,
        report: Report | None,
    ) -> None:  # fmt: skip
        """Sets what lies on the floor below the glow; each layer only when it is switched on."""
        self.under = self._ground
        if occupancy is not None:
            self.under = overlays.cells_occupied(self.under, occupancy.cells, self.palette)
        if goal is not None and goal.seconds is not None:
            self.under = overlays.cells_timed(self.under, goal.seconds, self.palette)
        if isinstance(report, ExperienceReport):
            zone = report.cell[:2], report.zone_xy
            self.under = overlays.cells_ringed(self.under, shape, *zone, self.palette.text)
        self._goal.visible = goal is not None and goal.goal is not None
        if goal is not None and goal.goal is not None:
            x, y, _ = CellFit(shape).path(np.array([[*goal.goal, 0.0]]))[0].tolist()
            self._goal.position = (x, y, 0.0)

    def set_inspected(self, report: Report | None, shape: tuple[int, int, int]) -> None:
        self.mark.show(report, shape)

    def column_at(self, origin: np.ndarray, direction: np.ndarray) -> tuple[int, int] | None:
        """The x', y' that a ray (world frame) means: the strongest voxel on it, else the floor; None beside the box."""
        if self._layer is None:
            return None
        _, n_y, n_x = self._fit.shape
        start, ahead = origin - np.array(self.origin), direction / np.linalg.norm(direction)
        shown = self._layer.cells[: self._shown]
        offset = self._fit.cells(shown) - start
        along = offset @ ahead
        beside = np.linalg.norm(offset - along[:, None] * ahead, axis=1)
        hit = np.flatnonzero((beside < max(self._fit.voxel)) & (along > 0))
        if len(hit):
            _, y, x = shown[hit[0]].tolist()
            return x, y
        floor = point_on_plane(origin, direction, self.origin)
        if floor is None or max(abs(floor[0]), abs(floor[1])) >= SIDE / 2:
            return None
        return int((floor[0] / SIDE + 0.5) * n_x), int((floor[1] / SIDE + 0.5) * n_y)

    def set_way(self, layer: PoseCellLayer, goal: GoalMemoryLayer | None) -> None:
        """Shows an arrow at the packet, in the direction in which the times to the goal fall fastest."""
        self._way.visible = goal is not None and goal.direction_rad is not None and bool(layer.packets)
        if goal is None or goal.direction_rad is None or not layer.packets:
            return
        x, y, _ = CellFit(layer.shape).packet(layer.packets[0]).tolist()
        half = goal.direction_rad / 2
        self._way.position, self._way.wxyz = (x, y, 0.0), (math.cos(half), 0.0, 0.0, math.sin(half))


def way_arrow(rim: float) -> meshes.Mesh:
    """An arrow from the packet's ring outwards along x. rim: how much wider it is all around."""
    shaft = np.array([(0.5 - rim, -0.07 - rim), (1.0, -0.07 - rim), (1.0, 0.07 + rim), (0.5 - rim, 0.07 + rim)])
    head = np.array([(1.0 - rim, -0.26 - 1.6 * rim), (1.5 + 2 * rim, 0.0), (1.0 - rim, 0.26 + 1.6 * rim)])
    return meshes.joined(meshes.flat_polygon(shaft, 0.0), meshes.flat_polygon(head, 0.0))


def pill_places(
    tops: np.ndarray, widths: np.ndarray, at: tuple[float, float, float] = ORIGIN, pill_m: float = PILL_M
) -> np.ndarray:
    """(n, 3) places for pills above packets at `tops` (n, 3) on a plate that stands at `at`, so that none covers another in
    the view of all plates."""
    raised = tops + np.array([0.0, 0.0, 0.95])
    seen, larger = seen_by(camera_for("all", 1.6), raised + np.array(at))
    height = pill_m * float(larger.max(initial=1.0))
    shift = (spread(seen, widths * larger, height) - seen) / larger[:, None]
    return raised + np.column_stack([shift[:, 0], shift[:, 1] * math.cos(LEAN_RAD), shift[:, 1] * math.sin(LEAN_RAD)])


def glow(layer: PoseCellLayer, ground: images.Pixels, palette: Palette) -> images.Pixels:
    """`ground` with the light of the cells on it; row 0 of the cells is at its front edge."""
    _, n_y, n_x = layer.shape
    owned = np.minimum(layer.owners(), PACKETS - 1)
    out = ground.astype(np.float32)
    for k in np.unique(owned):
        rows = owned == k
        light = np.zeros((n_y, n_x), np.float32)
        np.add.at(light, (layer.cells[rows, 1], layer.cells[rows, 2]), layer.activity[rows])
        share = float(light.sum()) ** 0.5
        soft = np.asarray(cv2.GaussianBlur(np.pad(light, 8, mode="wrap"), (0, 0), n_x / 32))[8:-8, 8:-8]
        soft = np.ascontiguousarray(soft / max(float(soft.max()), 1e-9), np.float32)
        large = cv2.resize(soft, (FLOOR_PX, FLOOR_PX), interpolation=cv2.INTER_CUBIC)
        weight = np.clip(np.asarray(large)[::-1, :, None], 0, 1) * 0.75 * min(1.0, 0.35 + 0.65 * share)
        out += (np.array(palette.packets[k], np.float32) - out) * weight
    return np.clip(out, 0, 255).astype(np.uint8)


class GlassBox:
    """The box around the cells: tinted far walls, edges, grid, and axes x', y' in metres and theta' in degrees."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, root: str) -> None:
        self._palette = palette
        self._labels: dict[str, Sign] = {}
        self._scene, self._root = scene, root
        corners = np.array([[-HALF, -HALF], [HALF, -HALF], [HALF, HALF], [-HALF, HALF]])
        # four sides and a top, no bottom, seen from inside only, so only the far ones tint
        walls, tint = meshes.extruded(corners, 0.0, HEIGHT), palette.lit(palette.glass, (0.0, -1.0, 0.0))
        add_mesh(scene, f"{root}/glass", walls, tint, opacity=palette.glass_opacity, side="back")
        edges = [meshes.closed_line(corners, z) for z in (0.0, HEIGHT)]
        posts = np.array([[[x, y, 0.0], [x, y, HEIGHT]] for x, y in corners], np.float32)
        scene.add_line_segments(
            f"{root}/edges", np.vstack([*edges, posts]), palette.drawn(palette.glass_edge), thickness=0.035
        )
        faint = palette.drawn(mix(palette.glass_edge, palette.sheet, 0.62))
        scene.add_line_segments(f"{root}/lattice", _lattice(), faint, thickness=0.018)
        axes = (("x", "centre"), ("y", "left"), ("t", "right"))
        for name, anchor in ((f"{axis}{k}", anchor) for axis, anchor in axes for k in range(3)):
            self._labels[name] = Sign(scene, f"{root}/tick_{name}", 0.40 * palette.letters, anchor=anchor, leaning=True)
        for name, anchor in axes:
            self._labels[name] = Sign(scene, f"{root}/axis_{name}", 0.46 * palette.letters, anchor=anchor, leaning=True)

    def set_extent(self, width_m: float, depth_m: float) -> None:
        """Writes the numbers on the axes."""
        ink, faint = self._palette.text, self._palette.text_2
        for k, share in enumerate((0.0, 0.5, 1.0)):
            along = -HALF + share * SIDE
            self._write(f"x{k}", metres_words(share * width_m, k == 2), faint, (along, -HALF - 0.42, 0.1))
            self._write(f"y{k}", metres_words(share * depth_m, k == 2), faint, (HALF + 0.22, along + 0.1, 0.12))
            self._write(f"t{k}", f"{round(share * 360)}°", faint, (-HALF - 0.2, -HALF, 0.16 + share * (HEIGHT - 0.16)))
        self._write("x", "x′", ink, (HALF * 0.5, -HALF - 0.42, 0.14))
        self._write("y", "y′", ink, (HALF + 0.22, HALF * 0.5, 0.16))
        self._write("t", "θ′", ink, (-HALF - 0.2, -HALF, HEIGHT * 0.75))

    def _write(self, name: str, words: str, colour: tuple[int, int, int], at: Place) -> None:
        bold = name in ("x", "y", "t")
        self._labels[name].show(images.text(words, colour, 64, bold), at)


def metres_words(value: float, unit: bool) -> str:
    return f"{value:.3g} m" if unit else f"{value:.3g}"


def _lattice() -> np.ndarray:
    """Lines on the far and the left wall, a quarter turn and a quarter of the width apart."""
    lines: list[list[list[float]]] = []
    for share in (0.25, 0.5, 0.75):
        at, z = -HALF + share * SIDE, share * HEIGHT
        lines += [[[at, HALF, 0], [at, HALF, HEIGHT]], [[-HALF, HALF, z], [HALF, HALF, z]]]
        lines += [[[-HALF, at, 0], [-HALF, at, HEIGHT]], [[-HALF, -HALF, z], [-HALF, HALF, z]]]
    return np.array(lines, np.float32)
