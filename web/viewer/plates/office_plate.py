"""The office plate: the true world, which the robot cannot know, with the robot and the reach of its sensors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import KnownPlace, LivingLayer, Movements, Pose, Senses, WorldDrawing
from web.viewer.fits.office_fit import DEPTH, WIDTH, OfficeFit
from web.viewer.marks.actors import LivingThings
from web.viewer.marks.ghost import GhostRobot
from web.viewer.marks.movements import MovementArcs
from web.viewer.marks.place_names import PlaceNames
from web.viewer.marks.robot_model import RobotModel
from web.viewer.marks.trail import Trail
from web.viewer.plates.furniture import add_floor, add_furniture
from web.viewer.plates.plate import FLOOR_Z, Plate
from web.viewer.plates.sight import fan_of_view
from web.viewer.primitives import meshes
from web.viewer.primitives.label_room import ROBOT
from web.viewer.primitives.labels import add_mesh
from web.viewer.primitives.palette import Palette, mix

ORIGIN = (-5.85, -2.2, 0.0)
SHEET = (11.0, 10.0, -0.5, 0.45)
OFFICE = "Office", "the true world - the robot cannot know this"
TRUE_PATH = "True path", "as the recording tells it - the robot cannot know this"
LATE = (
    0.0,
    -20.0,
    16.0,
)  # transparent meshes are drawn by the distance of their origin: the nearest to the eye last


class OfficePlate(Plate):
    def __init__(self, scene: viser.SceneApi, palette: Palette) -> None:
        super().__init__(scene, palette, "office", ORIGIN, SHEET)
        self._heading = OFFICE
        self.set_heading(*OFFICE)
        self.world: WorldDrawing | None = None
        self.fit = OfficeFit((0.0, 0.0, 10.0, 8.0))
        self._walls = np.zeros((0, 4))
        self.things = LivingThings(scene, palette, self.root)
        self.robot = RobotModel(scene, palette, f"{self.root}/robot")
        self._arcs = MovementArcs(scene, palette, f"{self.root}/movements")
        self._fan = add_mesh(
            scene,
            f"{self.root}/view",
            meshes.NOTHING,
            palette.lit(palette.wedge),
            opacity=palette.wedge_opacity,
            position=LATE,
        )
        self._fan_edges = scene.add_line_segments(
            f"{self.root}/view_edges",
            meshes.NOWHERE,
            palette.drawn(palette.wedge),
            thickness=0.025,
        )
        self._sonar = scene.add_line_segments(
            f"{self.root}/sonar",
            meshes.NOWHERE,
            palette.drawn(palette.sonar),
            thickness=0.022,
        )
        self._echoes = scene.add_point_cloud(
            f"{self.root}/echoes",
            np.full((8, 3), -50.0),
            palette.sonar,
            point_size=0.11,
            point_shape="circle",
            point_shading="flat",
        )
        self._trail = Trail(scene, palette, f"{self.root}/trail", palette.true_path, 0.05)
        self.names = PlaceNames(scene, palette, f"{self.root}/name", self.labels)
        self.ghost = GhostRobot(scene, palette, f"{self.root}/ghost", (WIDTH / 2, DEPTH / 2), self.labels)
        self._room_for = scene.add_line_segments(
            f"{self.root}/room",
            meshes.closed_line(meshes.rounded_rectangle(2, 2, 1), 0.0),
            palette.drawn(palette.sonar),
            thickness=0.05,
            visible=False,
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
        add_floor(self.scene, f"{self.root}/floor", self.palette, world, self.fit, FLOOR_Z)
        add_furniture(self.scene, f"{self.root}/furniture", self.palette, world, self.fit)

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
        self._fan.vertices, self._fan.faces = vertices - np.array(LATE, np.float32), faces
        edges = meshes.lifted(np.vstack([centre, rim[0], centre, rim[-1]]), 0.035).reshape(2, 2, 3)
        self._fan_edges.points = edges.astype(np.float32)

    def _draw_sonar(self, truth: Pose, angles_rad: NDArray[np.float32], ranges_m: NDArray[np.float32]) -> None:
        heard = np.isfinite(ranges_m)
        angles, reach = truth.heading_rad + angles_rad[heard], ranges_m[heard]
        ends = np.column_stack([truth.x + reach * np.cos(angles), truth.y + reach * np.sin(angles)])
        tips = meshes.lifted(self.fit.to_plate(ends), 0.14 * self.fit.relief)
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
        self._room_for.colors = np.array(
            self.palette.drawn(self.palette.sonar if room else mix(self.palette.robot, (255, 0, 0), 0.6)), np.uint8
        )
        self.robot.place(np.array([x, y]), heading_rad)
