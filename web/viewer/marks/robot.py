"""The robot with the path that it leaves on the floor, and its ghost that believes the wheels alone."""

from __future__ import annotations

import math

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import Pose
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import GHOST, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette, Rgb, mix, vertex_paint

ENLARGED = 1.25
SMALLEST = 0.19  # plate units: stays visible in large worlds, however small they are drawn


class RobotModel:
    """An orange cylinder with a white turret, a dark camera and two wheels, drawn a quarter larger than it is."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, plain: Rgb | None = None) -> None:
        """plain: one colour for all of it, and then it is hidden at first."""
        self.radius = 0.25
        self.frame = scene.add_frame(name, show_axes=False, visible=plain is None)
        circle = meshes.circle(1.0)
        wheels = [meshes.rounded_rectangle(0.62, 0.2, 0.09, 4, centre=(0.0, side)) for side in (1.0, -1.0)]
        lens = meshes.rounded_rectangle(0.36, 0.5, 0.1, 4, centre=(0.72, 0.0))
        parts = {
            "body": (meshes.extruded(circle, 0.12, 0.95), palette.robot),
            "turret": (meshes.extruded(circle * 0.5, 0.95, 1.3), palette.turret),
            "camera": (meshes.extruded(lens, 0.9, 1.3), palette.tyre),
            "left": (meshes.extruded(wheels[0], 0.0, 0.5), palette.tyre),
            "right": (meshes.extruded(wheels[1], 0.0, 0.5), palette.tyre),
        }
        if plain is not None:
            parts = {"body": (meshes.joined(*(mesh for mesh, _ in parts.values())), plain)}
        self.parts = [
            add_mesh(scene, f"{name}/{part}", mesh, palette.lit(colour), scale=self.radius)
            for part, (mesh, colour) in parts.items()
        ]
        halo = meshes.ring(1.42, 0.2, 0.06)
        self.parts.append(
            add_mesh(scene, f"{name}/halo", halo, palette.lit(palette.robot), opacity=0.35, scale=self.radius)
        )

    def resize(self, drawn_radius: float) -> None:
        """drawn_radius: the robot's radius in plate units, before it is enlarged."""
        self.radius = max(drawn_radius * ENLARGED, SMALLEST)
        for part in self.parts:
            part.scale = self.radius

    def place(self, xy: NDArray[np.float64], heading_rad: float) -> None:
        """xy: in plate units."""
        self.frame.position = (float(xy[0]), float(xy[1]), 0.0)
        self.frame.wxyz = (math.cos(heading_rad / 2), 0.0, 0.0, math.sin(heading_rad / 2))


SEGMENTS, STEP = 240, 0.16  # plate units
RISE = 0.015  # where the path crosses itself, the newer part is on top


class Trail:
    """A path on a floor whose older parts fade into it."""

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


PALE, PATH_PALE, LABEL_PALE = 0.5, 0.25, 0.1
LABEL_M, ABOVE, LABEL_Z = 0.4, 0.45, 0.5
APART_M = 0.5  # nearer to the robot it would only hide it
LONGEST = 1.0  # plate units: a longer step is no driving


class GhostRobot:
    """The estimate by odometry alone: a pale robot with its fading, dashed path and its name."""

    def __init__(
        self, scene: viser.SceneApi, palette: Palette, name: str, half: tuple[float, float], room: LabelRoom,
        radius: float = 0.25,
    ) -> None:  # fmt: skip
        """half: of the floor's width and depth; what leaves it is not drawn."""
        self._palette, self._half = palette, np.array(half)
        self.robot = RobotModel(scene, palette, name, plain=pale(palette, palette.robot))
        self.robot.resize(radius)
        self._trail = Trail(scene, palette, f"{name}_path", pale(palette, palette.robot, PATH_PALE), 0.05, dashed=True)
        fill = pale(palette, palette.robot, LABEL_PALE)
        self._label = Pill(scene, f"{name}_label", LABEL_M, fill, palette, room=room, rank=GHOST)

    def show(self, pose: Pose, off_m: float) -> None:
        """pose: on the plate; off_m: how far from the robot, in metres. Beside the floor only its name is shown, at the edge."""
        if off_m < APART_M:
            self.robot.frame.visible = False
            self._label.hide()
            return
        at = np.array([pose.x, pose.y])
        there = np.clip(at, -self._half, self._half)
        self.robot.frame.visible = bool(np.array_equal(at, there))
        self.robot.place(at, pose.heading_rad)
        x, y = there.tolist()
        below = max(y - self.robot.radius - ABOVE, LABEL_M - float(self._half[1]))  # not over the plate's title
        self._label.show(words_of(off_m), self._palette.sheet, (x, below, LABEL_Z))

    def show_path(self, path: NDArray[np.float64]) -> None:
        """(n, 2) on the plate."""
        self._trail.show(path, LONGEST, (float(self._half[0]), float(self._half[1])))

    def hide(self) -> None:
        self.robot.frame.visible = False
        self._label.hide()
        self._trail.hide()


def pale(palette: Palette, colour: Rgb, share: float = PALE) -> Rgb:
    """A colour as a ghost has it."""
    return mix(colour, palette.floor, share)


def words_of(off_m: float) -> str:
    return "wheels alone" if off_m < 1 else f"wheels alone: {off_m:.0f} m off"
