"""The robot that believes its wheels alone, as a pale robot with its fading, dashed path and its name."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import Pose
from web.viewer.marks.robot_model import RobotModel
from web.viewer.marks.trail import Trail
from web.viewer.primitives.label_room import GHOST, LabelRoom
from web.viewer.primitives.labels import Pill
from web.viewer.primitives.palette import Palette, Rgb, mix

PALE, PATH_PALE, LABEL_PALE = 0.5, 0.25, 0.1
LABEL_M, ABOVE, LABEL_Z = 0.4, 0.45, 0.5
APART_M = 0.5  # nearer to the robot it would only hide it
LONGEST = 1.0  # plate units: a longer step is no driving


def pale(palette: Palette, colour: Rgb, share: float = PALE) -> Rgb:
    """A colour as a ghost has it."""
    return mix(colour, palette.floor, share)


class GhostRobot:
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
        self._label.show(words_of(off_m), self._palette.sheet, (x, y - self.robot.radius - ABOVE, LABEL_Z))

    def show_path(self, path: NDArray[np.float64]) -> None:
        """(n, 2) on the plate."""
        self._trail.show(path, LONGEST, (float(self._half[0]), float(self._half[1])))

    def hide(self) -> None:
        self.robot.frame.visible = False
        self._label.hide()
        self._trail.hide()


def words_of(off_m: float) -> str:
    return "wheels alone" if off_m < 1 else f"wheels alone: {off_m:.0f} m off"
