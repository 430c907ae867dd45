"""Rooms for robots and maps made by hand."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ratslam_core import ExperienceMapParams, Pose2, TemporalMap
from ratslam_core.extensions.evidence import Evidence
from ratslam_core.params import EvidenceParams
from ratslam_core.pose_graph.transitions import Transitions
from sim2d import Drive, SimParams, Simulator, Start, Wall, World

GREY = (160, 160, 160)
EXACT = SimParams(odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.0, sonar_noise_m=0.0, image_noise=0.0)


def room(*inner: tuple[float, float, float, float], side: float = 4.0, start: tuple[float, float, float]) -> World:
    """A square room from (0, 0) with walls inside it, and where the robot starts: x, y, heading."""
    corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
    outer = [Wall(*corners[i], *corners[(i + 1) % 4], "wall", 2.6, GREY, outer=True) for i in range(4)]
    walls = [Wall(*ends, "partition", 1.4, GREY) for ends in inner]
    return World("room", "A room", "test", (*outer, *walls), (Start("home", *start),), ())


class HandMadeMap:
    """The part of an experience map that the pilot reads: nodes at places, links with times, and a robot that knows
    where it is. Map frame = office frame."""

    patience = 10**9  # failures of a link before it is deleted

    def __init__(self, places: list[tuple[float, float]], links: list[tuple[int, int]], speed: float = 0.3) -> None:
        self.poses = np.array([(x, y, 0.0) for x, y in places])
        self.links = np.array(links, np.int64).reshape(-1, 2)
        lengths = [math.dist(places[i], places[j]) for i, j in links]
        self.link_times = np.array(lengths) / speed
        self.robot = Pose2(*places[0], 0.0)
        self.params = ExperienceMapParams()
        self.pace = 0.0  # links take as long as `link_times` says, whatever their length
        self.trials: list[tuple[int, int, bool]] = []
        self.lost = self.carried = self.suspects_kidnap = False
        self.evidence = Evidence(EvidenceParams(), 0.25)
        self.dropped_links: list[tuple[int, int]] = []
        self.landed = 10**9  # experiences from this one on lie on a submap of their own

    def tried(self, i: int, j: int, reached: bool) -> bool:
        self.trials.append((i, j, reached))
        keep = [{i, j} != {int(a), int(b)} for a, b in self.links]
        if reached or all(keep) or sum({i, j} == {a, b} and not well for a, b, well in self.trials) < self.patience:
            return False
        self.links, self.link_times = self.links[keep], self.link_times[keep]
        self.dropped_links.append((i, j))
        return True

    def make(self, x: float, y: float, heading_rad: float) -> None:
        """One more node, linked to the last."""
        n, last = len(self), self.poses[-1]
        self.poses = np.concatenate([self.poses, [(x, y, heading_rad)]])
        self.links = np.concatenate([self.links, [(n - 1, n)]])
        self.link_times = np.append(self.link_times, math.dist((x, y), last[:2]) / 0.3)

    def __len__(self) -> int:
        return len(self.poses)

    @property
    def submap_of(self) -> NDArray[np.int32]:
        return np.where(np.arange(len(self)) < self.landed, 0, 1).astype(np.int32)

    @property
    def transitions(self) -> Transitions:
        made = Transitions()
        for _ in self.poses:
            made.graph.add_node()
        for (i, j), time_s in zip(self.links.tolist(), self.link_times, strict=True):
            made.take_time(made.add(i, j, travelled=True), time_s, 0.0)
        return made

    @property
    def temporal_map(self) -> TemporalMap:
        return TemporalMap(self)  # type: ignore[arg-type]

    @property
    def active(self) -> int:
        return int(np.argmin(np.hypot(self.poses[:, 0] - self.robot.x, self.poses[:, 1] - self.robot.y)))

    def pose(self, experience: int) -> Pose2:
        return Pose2(*map(float, self.poses[experience]))

    def know(self, simulator: Simulator) -> None:
        truth = simulator.truth
        self.robot = Pose2(truth.x, truth.y, truth.heading_rad)


def chain(*stops: tuple[float, float], every: float = 0.25) -> tuple[list[tuple[float, float]], list[tuple[int, int]]]:
    """Places along straight lines between the stops, each linked to the next."""
    places = [stops[0]]
    for a, b in pairwise(stops):
        n = math.ceil(math.dist(a, b) / every)
        places += [(a[0] + (b[0] - a[0]) * k / n, a[1] + (b[1] - a[1]) * k / n) for k in range(1, n + 1)]
    return places, [(k, k + 1) for k in range(len(places) - 1)]


STOP = Drive(0.0, 0.0)
