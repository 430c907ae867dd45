"""Robots driven by hand: through an experience map without pose cells or cameras, and along a circle with both."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ratslam_core import (
    Estimate,
    ExperienceMap,
    ExperienceMapParams,
    GoalMemoryParams,
    LocalViewParams,
    Odometry,
    Packet,
    Pose2,
    PoseCellParams,
    RatSlam,
    RatSlamParams,
    Recognition,
)

SHAPE = (36, 64, 64)
CELL_M = 0.25
RADIUS_M = 1.5
STEP_RAD = 0.02  # along the circle in a tick: 0.03 m
LAP = round(2 * math.pi / STEP_RAD)
COLUMN_RAD = math.radians(50) / 12
SONARS = (-0.5, 0.0, 0.5)
# each passage counts 1, and who is carried stays on the map
EXACT = ExperienceMapParams(anchor_sigma=0.0, odometry_drift=0.0, sweeps=0, solve_every=0, submaps=False)


class Robot:
    """Drives exactly as told. Its packet is at its true place, its views are numbers, and it believes every look."""

    def __init__(
        self,
        params: ExperienceMapParams | None = None,
        start: Pose2 | None = None,
    ) -> None:
        believing = replace(params or ExperienceMapParams(), submaps=False)
        self.map = ExperienceMap(SHAPE, CELL_M, believing)
        self.pose = start or Pose2(0.0, 0.0, 0.0)
        self.behaviour = 0

    def packet(self, at: Pose2 | None = None) -> Packet:
        at = at or self.pose
        return Packet((32 + at.x / CELL_M) % 64, (32 + at.y / CELL_M) % 64, at.heading_rad, 1.0)

    def see(
        self, view: int, *, new: bool = False, difference: float = 0.0, facing: float = 0.0, packet: Packet | None = None,
        odometry: Odometry | None = None,
    ) -> bool:  # fmt: skip
        """See a view, without moving unless told how."""
        seen = Recognition(view, new, view, difference, facing)
        return self.map.step(packet or self.packet(), seen, odometry or Odometry(0.0, 0.0, 0.1), self.behaviour)

    def go(self, forwards: float, turn: float, view: int, *, steps: int = 10, **look: object) -> bool:
        """Drive an arc in steps of 0.1 s; there is something to see only at its end."""
        odometry = Odometry(forwards / steps / 0.1, turn / steps / 0.1, 0.1)
        before = self.map.cell_state(self.map.active)[3] if self.map.active >= 0 else view
        for step in range(steps):
            middle = turn / steps / 2
            length = forwards / steps
            self.pose = self.pose.compose(Pose2(length * math.cos(middle), length * math.sin(middle), turn / steps))
            if step < steps - 1:  # until it arrives, it sees the view that it came from
                at = self.map.cell_state(self.map.active)
                still = Packet(at[0], at[1], at[2] * 2 * math.pi / 36, 1.0)
                self.map.step(still, Recognition(before, False, before, 1e6, 0.0), odometry, self.behaviour)
        return self.see(view, odometry=odometry, **look)  # type: ignore[arg-type]


def relative(a: np.ndarray, b: np.ndarray) -> Pose2:
    """The pose b in the frame of a, rows x, y, heading."""
    return Pose2(*map(float, a)).inverse().compose(Pose2(*map(float, b)))


class Circle:
    """A robot that drives a circle of 1.5 m and sees the part of a panorama that lies ahead."""

    def __init__(self, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        columns = round(2 * math.pi / COLUMN_RAD / 3)
        self._coarse = rng.uniform(20, 235, (8, columns))
        self.angle = 0.0

    @property
    def image(self) -> np.ndarray:
        """Columns count to the right, headings to the left."""
        heading = self.angle - np.arange(-5.5, 6.0) * COLUMN_RAD
        at = (heading / (2 * math.pi) % 1.0) * self._coarse.shape[1]
        left = np.floor(at).astype(int)
        right = (left + 1) % self._coarse.shape[1]
        seen = self._coarse[:, left % self._coarse.shape[1]] * (1 - at + left) + self._coarse[:, right] * (at - left)
        return np.round(seen).astype(np.uint8)

    @property
    def truth(self) -> Pose2:
        """The true pose in the frame of the start."""
        a = self.angle
        return Pose2(RADIUS_M * math.sin(a), RADIUS_M * (1 - math.cos(a)), math.remainder(a, 2 * math.pi))

    def advance(self, brain: RatSlam, ticks: int, **senses: Any) -> list[Estimate]:
        estimates = []
        for _ in range(ticks):
            self.angle += STEP_RAD
            odometry = Odometry(RADIUS_M * STEP_RAD / 0.1, STEP_RAD / 0.1, 0.1)
            estimates.append(brain.step(self.image, odometry, **senses))
        return estimates

    def miss_m(self, estimate: Estimate) -> float:
        return math.hypot(estimate.pose_map_robot.x - self.truth.x, estimate.pose_map_robot.y - self.truth.y)


def start(seed: int = 0, params: RatSlamParams | None = None) -> tuple[Circle, RatSlam]:
    """A brain that stands still at the beginning of the circle and has seen its first image."""
    circle, brain = Circle(seed), RatSlam(params)
    first = brain.step(circle.image, Odometry(0.0, 0.0, 0.1))
    seen = 0 if brain.params.local_view.enabled else -1
    assert (first.experience, first.created, first.recognition.view) == (0, True, seen)
    assert first.pose_map_robot == Pose2(0.0, 0.0, 0.0)
    return circle, brain


def drive(circle: Circle, brain: RatSlam, ticks: int) -> None:
    """Along the circle with three sonars."""
    for _ in range(ticks):
        circle.advance(
            brain, 1, ranges_m=np.array([1.0, 2.0, 5.0], np.float32) + np.float32(0.1 * np.sin(circle.angle))
        )


def driven(ticks: int = 420) -> tuple[Circle, RatSlam]:
    """A brain with sonars and parameters of its own, after so many ticks of the circle."""
    params = RatSlamParams(
        PoseCellParams(n_x=32, n_y=24), LocalViewParams(adaptive=True), goal_memory=GoalMemoryParams(rate=0.3)
    )
    circle, brain = Circle(3), RatSlam(params, np.random.default_rng(5), sonar_angles_rad=SONARS)
    drive(circle, brain, ticks)
    return circle, brain
