"""Truth against estimate: alignment, errors, consistency, kidnaps, goals. For judging and drawing; the robot never sees it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ratslam_core import ExperienceMap, Odometry, Pose2
from sim2d import Truth

REVISIT_AGE_S = 20.0  # an experience this old that is active again counts as revisited
NEAR_M = 1.0
STAY_S = 2.0


def alignment(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> Pose2:
    """The pose of the estimate's frame in the true one that fits (n, 2) points best in least squares. Umeyama 1991, SE(2)."""
    mean_e, mean_t = estimate.mean(axis=0), truth.mean(axis=0)
    e, t = estimate - mean_e, truth - mean_t
    angle = math.atan2(float(np.sum(e[:, 0] * t[:, 1] - e[:, 1] * t[:, 0])), float(np.sum(e * t)))
    turned = Pose2(0.0, 0.0, angle).compose(Pose2(float(mean_e[0]), float(mean_e[1]), 0.0))
    return Pose2(float(mean_t[0]) - turned.x, float(mean_t[1]) - turned.y, angle)


def align(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.float64]:
    """`estimate` (n, 2) turned and moved (no scale) to fit `truth` best."""
    frame = alignment(estimate, truth)
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return estimate @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


def rmse(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """Root mean square distance (m) after alignment, (n, 2) each; 0 for fewer than two points."""
    if len(estimate) < 2:
        return 0.0
    return float(np.sqrt(np.mean(np.sum((align(estimate, truth) - truth) ** 2, axis=1))))


@dataclass(slots=True)
class Kidnapping:
    """One kidnap and, later, how long and how far it took until the robot knew again where it was.

    It knows when its place in the map, aligned to the office as it was before the kidnap, stays within 1 m of the truth.
    """

    at_s: float
    map_in_office: Pose2
    after_s: float | None = None
    after_m: float | None = None
    _way_m: float = 0.0
    _right_since_s: float | None = None
    _right_since_m: float = 0.0


class Evaluation:
    """Keeps, tick by tick, what is needed to compare the map with the truth."""

    def __init__(self, known: int = 0) -> None:
        """known: experiences that a brain brought with it; where they were made nobody here has seen."""
        self._rows = np.zeros((4096, 8))  # truth x y heading, local pose x y heading, odometry alone x y
        self._experience = np.zeros(4096, np.int64)
        self._count = 0
        self._made_at = np.full(
            (max(1024, known), 4), np.nan
        )  # truth x y heading and time when each experience was made
        self._odometry = Pose2(0.0, 0.0, 0.0)
        self._revisits = self._consistent = 0
        self.path_m = 0.0
        self.kidnaps: list[Kidnapping] = []

    def record(
        self, time_s: float, truth: Truth, experiences: ExperienceMap, created: bool, odometry: Odometry
    ) -> None:
        """One tick."""
        if self._count == len(self._rows):
            self._rows = np.concatenate([self._rows, np.zeros_like(self._rows)])
            self._experience = np.concatenate([self._experience, np.zeros_like(self._experience)])
        step, turn = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        self._odometry = self._odometry.compose(Pose2(step * math.cos(turn / 2), step * math.sin(turn / 2), turn))
        local = experiences.local_pose
        self._rows[self._count] = (
            truth.x, truth.y, truth.heading_rad, local.x, local.y, local.heading_rad, self._odometry.x, self._odometry.y,
        )  # fmt: skip
        self._experience[self._count] = experiences.active
        self._count += 1
        self.path_m += abs(truth.speed) * odometry.dt
        if created:
            if experiences.active >= len(self._made_at):
                self._made_at = np.concatenate([self._made_at, np.full_like(self._made_at, np.nan)])
            self._made_at[experiences.active] = truth.x, truth.y, truth.heading_rad, time_s
        self._judge(time_s, truth, experiences, local, abs(truth.speed) * odometry.dt)

    def kidnapped(self, time_s: float, experiences: ExperienceMap) -> None:
        truth, mapped, _ = self.trajectories(experiences)
        self.kidnaps.append(Kidnapping(time_s, alignment(mapped, truth)))

    def made_at(self, experience: int, experiences: ExperienceMap) -> tuple[float, float]:
        """Where the robot truly was when it made this experience, office frame; of one that its brain brought with it, where
        the map says, laid over the office as it fits the robot's path best."""
        x, y = (float(v) for v in self._made_at[experience, :2])
        if math.isfinite(x):
            return x, y
        truth, mapped, _ = self.trajectories(experiences)
        place = alignment(mapped, truth).compose(experiences.pose(experience))
        return place.x, place.y

    @property
    def revisit_consistency(self) -> float | None:
        """Share of the time on old experiences during which the robot truly was within 0.5 m of where it believed to be."""
        return self._consistent / self._revisits if self._revisits else None

    def trajectories(self, experiences: ExperienceMap, every: int = 1) -> tuple[NDArray, NDArray, NDArray]:
        """True path, the path through the map as it is now, and odometry alone, (n, 2) each, not aligned."""
        rows, at = self._rows[: self._count : every], self._experience[: self._count : every]
        pose = experiences.poses[at]
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        x = pose[:, 0] + c * rows[:, 3] - s * rows[:, 4]
        y = pose[:, 1] + s * rows[:, 3] + c * rows[:, 4]
        return rows[:, :2], np.stack([x, y], axis=1), rows[:, 6:8]

    def errors(self, experiences: ExperienceMap, every: int = 1) -> tuple[float, float]:
        """RMSE (m) after SE(2) alignment of the path through the map, and of odometry alone."""
        truth, mapped, odometry = self.trajectories(experiences, every)
        return rmse(mapped, truth), rmse(odometry, truth)

    def _judge(self, time_s: float, truth: Truth, experiences: ExperienceMap, local: Pose2, way_m: float) -> None:
        made = self._made_at[experiences.active].tolist()
        c, s = math.cos(made[2]), math.sin(made[2])
        believed = made[0] + c * local.x - s * local.y, made[1] + s * local.x + c * local.y
        off = math.hypot(believed[0] - truth.x, believed[1] - truth.y)
        if time_s - made[3] > REVISIT_AGE_S:
            self._revisits += 1
            self._consistent += off <= 0.5
        for kidnap in self.kidnaps[-1:]:
            if kidnap.after_s is not None:
                break
            kidnap._way_m += way_m
            robot = kidnap.map_in_office.compose(experiences.robot)
            if math.hypot(robot.x - truth.x, robot.y - truth.y) > NEAR_M:
                kidnap._right_since_s = None
            elif kidnap._right_since_s is None:
                kidnap._right_since_s, kidnap._right_since_m = time_s, kidnap._way_m
            elif time_s - kidnap._right_since_s >= STAY_S:
                kidnap.after_s, kidnap.after_m = kidnap._right_since_s - kidnap.at_s, kidnap._right_since_m
