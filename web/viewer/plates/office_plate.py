"""The office plate: the true world, which the robot cannot know, with the robot and the reach of its sensors."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import KnownPlace, LivingLayer, Movements, Pose, Senses, WorldDrawing
from web.viewer.camera_views import OFFICE_AT
from web.viewer.fits import DEPTH, METRE_HIGH, WIDTH, OfficeFit
from web.viewer.marks.actors import LATE, LivingThings
from web.viewer.marks.movements import MovementArcs
from web.viewer.marks.names import PlaceNames
from web.viewer.marks.robot import GhostRobot, RobotModel, Trail
from web.viewer.plates.plate import FLOOR_Z, Plate
from web.viewer.plates.sight import echoes_at, fan_of_view, inside, solid_runs
from web.viewer.primitives import images, meshes
from web.viewer.primitives.labels import ROBOT, add_mesh, add_picture
from web.viewer.primitives.palette import Palette, Rgb, mix

ORIGIN = (*OFFICE_AT, 0.0)
OFFICE = "Office", "the true world - the robot cannot know this"
TRUE_PATH = "True path", "as the recording tells it - the robot cannot know this"
Array = NDArray[np.float64]


class OfficePlate(Plate):
    def __init__(self, scene: viser.SceneApi, palette: Palette) -> None:
        super().__init__(scene, palette, "office", ORIGIN)
        self._heading = OFFICE
        self.set_heading(*OFFICE)
        self.world: WorldDrawing | None = None
        self.fit = OfficeFit((0.0, 0.0, 10.0, 8.0))
        self._walls = np.zeros((0, 4))
        self.things = LivingThings(scene, palette, self.root)
        self.robot = RobotModel(scene, palette, f"{self.root}/robot")
        self._arcs = MovementArcs(scene, palette, f"{self.root}/movements")
        look = {"opacity": palette.wedge_opacity, "position": tuple(LATE.tolist())}
        self._fan = add_mesh(scene, f"{self.root}/view", meshes.NOTHING, palette.lit(palette.wedge), **look)
        self._fan_edges = scene.add_line_segments(
            f"{self.root}/view_edges", meshes.NOWHERE, palette.drawn(palette.wedge), thickness=0.025
        )
        self._sonar = scene.add_line_segments(
            f"{self.root}/sonar", meshes.NOWHERE, palette.drawn(palette.sonar), thickness=0.022
        )
        self._echoes = scene.add_point_cloud(
            f"{self.root}/echoes", np.full((8, 3), -50.0), palette.sonar,
            point_size=0.11, point_shape="circle", point_shading="flat",
        )  # fmt: skip
        self._trail = Trail(scene, palette, f"{self.root}/trail", palette.true_path, 0.05)
        self.names = PlaceNames(scene, palette, f"{self.root}/name", self.labels)
        self.ghost = GhostRobot(scene, palette, f"{self.root}/ghost", (WIDTH / 2, DEPTH / 2), self.labels)
        ring = meshes.closed_line(meshes.rounded_rectangle(2, 2, 1), 0.0)
        self._room_for = scene.add_line_segments(
            f"{self.root}/room", ring, palette.drawn(palette.sonar), thickness=0.05, visible=False
        )

    def set_world(self, world: WorldDrawing | None) -> None:
        """Draws another office: floor with shadows, walls, furniture, posters. None: there is none, and no plate."""
        if (world is not None) != self.frame.visible:
            self.frame.visible = world is not None
        if world is None:
            self.world = None
            return
        heading = OFFICE if world.is_office else TRUE_PATH
        if heading != self._heading:
            self._heading = heading
            self.set_heading(*heading)
            for part in (self._fan, self._fan_edges, self._sonar, self._echoes):
                part.visible = world.is_office
        self.world, self.fit = world, OfficeFit(world.bounds)
        opaque = [kind != "glass" for kind in world.wall_kind]
        self._walls = np.asarray(world.walls, np.float64)[opaque]
        for robot in (self.robot, self.ghost.robot):
            robot.resize(self.fit.scale * max(world.robot_radius_m, 0.05))
        _add_floor(self.scene, f"{self.root}/floor", self.palette, world, self.fit, FLOOR_Z)
        _add_furniture(self.scene, f"{self.root}/furniture", self.palette, world, self.fit)

    def set_living(self, layer: LivingLayer | None) -> None:
        """Shows doors, boxes, people and lamps where they are now."""
        self.things.show(layer, self.fit)

    def set_movements(self, draw: Callable[[], Movements] | None) -> None:
        """Shows the local movements among which the robot chooses. draw: is called only to show them; None: nothing."""
        if draw is None:
            self._arcs.hide()
        else:
            self._arcs.show(draw(), self.fit, self.robot.radius)

    def set_robot(self, truth: Pose | None, senses: Senses) -> None:
        """Shows the robot at its true pose, with its field of view and the sonars' echoes; without walls the robot alone."""
        if self.world is None or truth is None:
            return
        x, y = self.fit.to_plate(np.array([[truth.x, truth.y]]))[0].tolist()
        self.robot.place(np.array([x, y]), truth.heading_rad)
        self.labels.fix(self, [((x, y, self.robot.radius), 2 * self.robot.radius, 2 * self.robot.radius)], ROBOT)
        if not self.world.is_office:
            return
        self._draw_view(truth, self.world.camera_fov_rad)
        self._draw_sonar(truth, self.world.sonar_angles_rad, senses.ranges_m)

    def _draw_view(self, truth: Pose, fov_rad: float) -> None:
        layer = self.things.layer
        leaves = self._walls[:0] if layer is None else layer.doors.astype(np.float64)
        rim = self.fit.to_plate(fan_of_view(np.vstack([self._walls, leaves]), truth, fov_rad))
        centre = self.fit.to_plate(np.array([[truth.x, truth.y]]))[0]
        vertices, faces = meshes.flat_fan((float(centre[0]), float(centre[1])), rim, 0.03)
        self._fan.vertices, self._fan.faces = vertices - LATE, faces
        edges = meshes.lifted(np.vstack([centre, rim[0], centre, rim[-1]]), 0.035).reshape(2, 2, 3)
        self._fan_edges.points = edges.astype(np.float32)

    def _draw_sonar(self, truth: Pose, angles_rad: NDArray[np.float32], ranges_m: NDArray[np.float32]) -> None:
        tips = meshes.lifted(self.fit.to_plate(echoes_at(truth, angles_rad, ranges_m)), 0.14 * self.fit.relief)
        start = meshes.lifted(self.fit.to_plate(np.array([[truth.x, truth.y]])), 0.14 * self.fit.relief)
        lines = np.stack([np.repeat(start, len(tips), 0), tips], 1).astype(np.float32)
        self._sonar.points = meshes.some(lines, 8)
        echoes = np.full((8, 3), -50.0, np.float32)
        echoes[: len(tips)] = tips[:8]
        self._echoes.points = echoes

    def set_trail(self, trail: NDArray[np.float32]) -> None:
        """Shows the true path of the last two minutes, with older parts fading into the floor."""
        office = self.world is None or self.world.is_office
        path = self.fit.to_plate(np.asarray(trail, np.float64).reshape(-1, 2))
        self._trail.show(path, 1.2 * self.fit.scale if office else np.inf)  # a kidnap leaves no line

    def set_places(self, places: tuple[KnownPlace, ...]) -> None:
        at = self.fit.to_plate(np.array([(place.x, place.y) for place in places]).reshape(-1, 2))
        self.names.show([place.name for place in places], [place.map_xy is not None for place in places], at)

    def show_drop(self, place: tuple[float, float] | None, room: bool, heading_rad: float) -> None:
        """Shows the ring under a dragged robot (office frame): teal where it fits, red where it does not."""
        self._room_for.visible = place is not None
        if place is None:
            return
        x, y = self.fit.to_plate(np.array([place]))[0]
        radius = 1.6 * self.robot.radius
        self._room_for.points = meshes.closed_line(meshes.circle(radius, (float(x), float(y))), 0.05)
        colour = self.palette.sonar if room else mix(self.palette.robot, (255, 0, 0), 0.6)
        self._room_for.colors = np.array(self.palette.drawn(colour), np.uint8)
        self.robot.place(np.array([x, y]), heading_rad)


FLOOR_PX_PER_UNIT = 96


def _add_floor(
    scene: viser.SceneApi, name: str, palette: Palette, world: WorldDrawing, fit: OfficeFit, z: float
) -> None:
    """The floor image: metre grid and contact shadows."""
    px = FLOOR_PX_PER_UNIT * fit.scale
    floor = images.gridded_floor(fit.size_m, px, palette.floor, palette.grid, fit.grid_step_m)
    height = floor.shape[0]

    def pixels(xy: Array) -> Array:
        return np.column_stack([(xy[:, 0] - fit.low[0]) * px, height - (xy[:, 1] - fit.low[1]) * px])

    walls = np.asarray(world.walls, np.float64)
    for corners in world.slow_zones:
        floor = images.tint(floor, pixels(np.asarray(corners, np.float64)), palette.packets[0], 0.22)
    lines = np.hstack([pixels(walls[:, :2]), pixels(walls[:, 2:])]) if len(walls) else walls
    solids = [pixels(outline) for _, outline in solid_runs(world)]
    floor = images.contact_shadow(floor, lines, solids, 0.16 * FLOOR_PX_PER_UNIT * fit.relief, palette.shadow)
    wide, deep = fit.size_m[0] * fit.scale, fit.size_m[1] * fit.scale
    add_picture(scene, name, floor, wide, deep, position=(0.0, 0.0, z), format="jpeg", jpeg_quality=92)


HEIGHTS = {"wall": 0.62, "partition": 0.42, "desk": 0.24}
FRONT = 0.18
PANEL_THICK = 0.11  # how far a panel stands out from its side of the wall
THICK = {"wall": 0.1, "partition": 0.07, "glass": 0.03}
MANY = 3000  # boxes; with more, their narrow ends are too small to be seen and are left out
GLASS_RGB: Rgb = (150, 200, 225)


class Boxes(NamedTuple):
    """Boxes that stand on the plate, in its units, as arrays: even ten thousand walls are only a few arrays."""

    centre: Array  # (n, 3)
    size: Array  # (n, 3)
    turn_rad: Array  # (n,)
    rgb: NDArray[np.uint8]  # (n, 3)

    def of(self, chosen: NDArray[np.bool_]) -> Boxes:
        return Boxes(self.centre[chosen], self.size[chosen], self.turn_rad[chosen], self.rgb[chosen])


def _add_furniture(scene: viser.SceneApi, name: str, palette: Palette, world: WorldDrawing, fit: OfficeFit) -> None:
    """Draws one batch of boxes for walls and panels, and one mesh for the closed outlines."""
    runs = solid_runs(world)
    walls = _wall_boxes(world, fit, palette)
    glass = np.array([kind == "glass" for kind in world.wall_kind], bool)
    _add_glass(scene, f"{name}_glass", walls.of(glass))
    loose = ~glass
    parts = [_panel_boxes(world, fit)]
    middles = (world.panels[:, :2] + world.panels[:, 2:4]) / 2
    for rows, outline in runs:
        loose[rows] = False
        if world.wall_kind[rows[0]] == "desk" and not any(inside(outline, float(x), float(y)) for x, y in middles):
            parts += _screens(fit, outline, palette)
    parts.append(walls.of(loose))
    if not any(len(part.turn_rad) for part in parts):  # viser needs at least one: far below
        rgb = np.array([palette.wall], np.uint8)
        parts.append(Boxes(np.full((1, 3), -50.0), np.ones((1, 3)), np.zeros(1), rgb))
    turn = np.concatenate([part.turn_rad for part in parts])
    scene.add_batched_meshes_simple(
        f"{name}_boxes",
        *meshes.open_cube(ends=len(turn) <= MANY),
        batched_wxyzs=np.column_stack([np.cos(turn / 2), 0 * turn, 0 * turn, np.sin(turn / 2)]).astype(np.float32),
        batched_positions=np.concatenate([part.centre for part in parts]).astype(np.float32),
        batched_scales=np.concatenate([part.size for part in parts]).astype(np.float32),
        batched_colors=palette.batched(np.concatenate([part.rgb for part in parts])),
        lod="off",
        cast_shadow=False,
        receive_shadow=False,
    )
    heights = _heights(world) * fit.relief
    for kind in ("desk", "other"):
        chosen = [
            meshes.extruded(fit.to_plate(outline), 0.0, float(heights[rows[0]]))
            for rows, outline in runs
            if (world.wall_kind[rows[0]] == "desk") == (kind == "desk") and world.wall_kind[rows[0]] != "glass"
        ]
        colour = palette.lit(palette.desk if kind == "desk" else palette.partition)
        add_mesh(scene, f"{name}_{kind}", meshes.joined(*chosen) if chosen else meshes.NOTHING, colour)


def _add_glass(scene: viser.SceneApi, name: str, panes: Boxes) -> None:
    """Draws what one can see through, light blue, as one mesh."""
    solid = [
        meshes.turned_box(tuple(centre), tuple(size), turn)
        for centre, size, turn in zip(panes.centre.tolist(), panes.size.tolist(), panes.turn_rad.tolist(), strict=True)
    ]
    add_mesh(scene, name, meshes.joined(*solid) if solid else meshes.NOTHING, GLASS_RGB, opacity=0.35)


def _heights(world: WorldDrawing) -> Array:
    """(n,) heights of the walls, in units of the plate before its relief."""
    metres = np.asarray(world.wall_height_m, np.float64)
    usual = np.array([HEIGHTS.get(kind, 0.0) for kind in world.wall_kind], np.float64)
    return np.where(usual > 0.0, usual, np.clip(metres * METRE_HIGH, 0.1, 0.62))


def _wall_boxes(world: WorldDrawing, fit: OfficeFit, palette: Palette) -> Boxes:
    """The walls as boxes. Outer walls stand outside the bounds, and the front one is low, so that one can look in."""
    ends = np.asarray(world.walls, np.float64).reshape(-1, 4)
    side = _outer_sides(world, ends)
    front = (side == (0.0, -1.0)).all(axis=1)
    thick = np.array([THICK.get(kind, 0.08) for kind in world.wall_kind], np.float64) * fit.relief
    height = np.where(front, FRONT, _heights(world)) * fit.relief
    a, b = fit.to_plate(ends[:, :2]), fit.to_plate(ends[:, 2:])
    along = b - a
    length = np.hypot(*along.T) + np.where(side[:, 1] != 0.0, 2 * thick, 0.0)
    colours = {"wall": palette.wall, "desk": palette.desk}
    rgb = np.array([colours.get(kind, palette.partition) for kind in world.wall_kind], np.uint8).reshape(-1, 3)
    centre = np.column_stack([(a + b) / 2 + side * thick[:, None] / 2, height / 2])
    return Boxes(centre, np.column_stack([length, thick, height]), np.arctan2(along[:, 1], along[:, 0]), rgb)


def _outer_sides(world: WorldDrawing, ends: Array) -> Array:
    """(n, 2) the outward direction of each wall (n, 4) that lies on the bounds, (0, 0) for the others."""
    low_x, low_y, high_x, high_y = world.bounds
    x1, y1, x2, y2 = ends.T
    upright, level = np.abs(x2 - x1) < 0.06, np.abs(y2 - y1) < 0.06
    on = [upright & (np.abs(x1 - low_x) < 0.06), upright & (np.abs(x1 - high_x) < 0.06)]
    on += [level & (np.abs(y1 - low_y) < 0.06), level & (np.abs(y1 - high_y) < 0.06)]
    sides = np.array([(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.0, 0.0)])
    return sides[np.select(on, [0, 1, 2, 3], 4)]


def _panel_boxes(world: WorldDrawing, fit: OfficeFit) -> Boxes:
    """Posters, doors and windows: thin boxes that stand out from their walls. None on the low front wall."""
    panels = np.asarray(world.panels, np.float64).reshape(-1, 6)
    seen = (_outer_sides(world, panels[:, :4]) != (0.0, -1.0)).any(axis=1)
    panels, rgb = panels[seen], np.asarray(world.panel_rgb, np.uint8)[: len(seen)][seen]
    low = np.maximum(panels[:, 4] * METRE_HIGH, 0.0) * fit.relief
    high = np.minimum(panels[:, 5] * METRE_HIGH, 0.6) * fit.relief
    a, b = fit.to_plate(panels[:, :2]), fit.to_plate(panels[:, 2:4])
    along = b - a
    thick = np.full(len(panels), PANEL_THICK * fit.relief)
    size = np.column_stack([np.hypot(*along.T), thick, np.maximum(high - low, 0.02)])
    return Boxes(np.column_stack([(a + b) / 2, (low + high) / 2]), size, np.arctan2(along[:, 1], along[:, 0]), rgb)


def _screens(fit: OfficeFit, outline: Array, palette: Palette) -> list[Boxes]:
    """A dark screen on each desk, so that it can be told for a desk."""
    corners = fit.to_plate(outline)
    low, high = corners.min(0), corners.max(0)
    if min(high - low) < 0.3:
        return []
    centre = np.array([(*((low + high) / 2), HEIGHTS["desk"] + 0.02)])
    return [Boxes(centre, np.array([(0.34, 0.2, 0.04)]), np.zeros(1), np.array([palette.tyre], np.uint8))]
