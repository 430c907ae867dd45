"""Robots that drive through experience maps by hand, without pose cells or cameras."""

from __future__ import annotations

import math

import numpy as np

from ratslam_core import ExperienceMap, ExperienceMapParams, Odometry, Packet, Pose2, Recognition

SHAPE = (36, 64, 64)
CELL_M = 0.25


class Robot:
    """Drives exactly as told; its packet is where it is, its views are numbers."""

    def __init__(self, params: ExperienceMapParams | None = None, start: Pose2 | None = None) -> None:
        self.map = ExperienceMap(SHAPE, CELL_M, params)
        self.pose = start or Pose2(0.0, 0.0, 0.0)
        self.behaviour = 0

    def packet(self, at: Pose2 | None = None) -> Packet:
        at = at or self.pose
        return Packet((32 + at.x / CELL_M) % 64, (32 + at.y / CELL_M) % 64, at.heading_rad, 1.0)

    def see(
        self, view: int, *, new: bool = False, difference: float = 0.0, facing: float = 0.0, packet: Packet | None = None,
        odometry: Odometry | None = None,
    ) -> bool:  # fmt: skip
        """Look at a view without moving, unless told how."""
        seen = Recognition(view, new, view, difference, facing)
        return self.map.step(packet or self.packet(), seen, odometry or Odometry(0.0, 0.0, 0.1), self.behaviour)

    def go(self, forwards: float, turn: float, view: int, *, steps: int = 10, **look: object) -> bool:
        """Drive an arc in so many steps of 0.1 s; only at its end there is something to see."""
        odometry = Odometry(forwards / steps / 0.1, turn / steps / 0.1, 0.1)
        before = self.map.cell_state(self.map.active)[3] if self.map.active >= 0 else view
        for step in range(steps):
            middle = turn / steps / 2
            length = forwards / steps
            self.pose = self.pose.compose(Pose2(length * math.cos(middle), length * math.sin(middle), turn / steps))
            if step < steps - 1:  # what it came from fills its view until it is there
                at = self.map.cell_state(self.map.active)
                still = Packet(at[0], at[1], at[2] * 2 * math.pi / 36, 1.0)
                self.map.step(still, Recognition(before, False, before, 1e6, 0.0), odometry, self.behaviour)
        return self.see(view, odometry=odometry, **look)  # type: ignore[arg-type]


def relative(a: np.ndarray, b: np.ndarray) -> Pose2:
    """The pose b in the frame of a, rows x, y, heading."""
    return Pose2(*map(float, a)).inverse().compose(Pose2(*map(float, b)))
