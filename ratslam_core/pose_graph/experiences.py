"""The experiences: which state of the pose cells and which scene each stands for, and which fits best. ACRA 2005 4.1."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.params import ExperienceMapParams
from ratslam_core.types import Floats, Ints, Ints32, Packet, Pose2, grown

# x', y', theta' of a state of the pose cells; layers, cells along y' and x'; how far a zone reaches, in cells and layers
Zone: TypeAlias = tuple[float, float, float, int, int, int, float, float]


@kind("experiences/5")
class Experiences:
    """States, scenes and map poses, row by row. Arrays have room to spare; `count` rows are used."""

    def __init__(self, shape: tuple[int, int, int]) -> None:
        """shape: layers, cells along y' and x' of the pose cells."""
        self.shape = shape
        self.count = 0
        self.pose = np.zeros((1024, 3))  # x, y, heading in the map
        self.at = np.zeros((1024, 3))  # x', y', theta' in cells and layers
        self.view = np.zeros(1024, np.int64)
        self.submap = np.zeros(1024, np.int32)  # the map that it is part of: extensions/submaps.py

    def add(self, packet: Packet, view: int, pose: Pose2, submap: int = 0) -> int:
        """One more experience; returns its number."""
        if self.count == len(self.pose):
            for name in ("pose", "at", "view", "submap"):
                setattr(self, name, grown(getattr(self, name)))
        i = self.count
        self.pose[i] = pose.x, pose.y, pose.heading_rad
        self.at[i], self.view[i], self.submap[i] = self._state(packet), view, submap
        self.count += 1
        return i

    def forget_view(self, view: int) -> None:
        """The view is no more. Its experiences stay in the map as places where there is nothing to see."""
        self.view[self.of_view(view)] = -1

    def of_view(self, view: int) -> Ints:
        """The experiences of a view, the oldest first."""
        return np.flatnonzero(self.view[: self.count] == view)

    def _state(self, packet: Packet) -> tuple[float, float, float]:
        """x', y' in cells and theta' in layers, from 0 to below the size of the network."""
        n_theta, n_y, n_x = self.shape
        return packet.x % n_x, packet.y % n_y, (packet.heading_rad * n_theta / (2 * math.pi)) % n_theta

    def _zone(self, packet: Packet, p: ExperienceMapParams) -> Zone:
        return *self._state(packet), *self.shape, p.zone_xy, p.zone_theta

    def cells_from(self, experience: int, packet: Packet) -> tuple[float, float, float]:
        """The packet relative to an experience's state: cells and layers, the shorter way round."""
        n_theta, n_y, n_x = self.shape
        x, y, theta = self._state(packet)
        own_x, own_y, own_theta = self.at[experience]
        return (
            math.remainder(x - own_x, n_x),
            math.remainder(y - own_y, n_y),
            math.remainder(theta - own_theta, n_theta),
        )

    def energy(self, experience: int, packet: Packet, view: int, p: ExperienceMapParams) -> float:
        """E = 0 if r > 1 or q > 1 or V != V_i, else 2 - r - q. ACRA 2006 eqs. 1-4, ACRA 2005 eqs. 4-9, whose zone is *the value
        range within each of the 4 state variables when this experience is activated*.
        """
        if p.match_view and view != self.view[experience]:
            return 0.0
        return float(_energy(self._zone(packet, p), self.at, experience))

    def most_energetic(
        self, packet: Packet, view: int, p: ExperienceMapParams, robot: Pose2, blind_m: float, gate_m: float = math.inf,
        submap: int = 0,
    ) -> int:  # fmt: skip
        """The experience with the most energy above the threshold, the oldest of equals; -1 for none.

        Where views tell experiences apart (`match_view`), only those count that are on this submap and within `gate_m` of the
        robot in the map, the validation gate.

        [ours] When there is nothing to see, only the pose cells tell places apart, and they may use the same cells for
        places far apart. The experience must then be within `blind_m` of the robot in the map, too.
        test_experience_map.py::test_seeing_nothing_closes_no_loop.
        """
        zone, n, gate_m = self._zone(packet, p), self.count, min(blind_m, gate_m) if view < 0 else gate_m
        if not p.match_view:
            return _best(zone, self.at[:n], p.threshold)
        near = (self.view[:n], view, self.submap, submap, self.pose, robot.x, robot.y, gate_m)
        return _best_of_view(zone, self.at, p.threshold, *near)


@njit(cache=True, nogil=True, inline="always")
def _apart(a: float, b: float, n: int) -> float:
    """How far two coordinates from 0 to n are apart on a ring."""
    d = abs(a - b)
    return min(d, n - d)


@njit(cache=True, nogil=True, inline="always")
def _energy(zone: Zone, at: Floats, i: int) -> float:
    x, y, theta, n_theta, n_y, n_x, reach_xy, reach_theta = zone
    r = math.sqrt(_apart(x, at[i, 0], n_x) ** 2 + _apart(y, at[i, 1], n_y) ** 2) / reach_xy
    q = _apart(theta, at[i, 2], n_theta) / reach_theta
    return 0.0 if r > 1.0 or q > 1.0 else 2.0 - r - q


@njit(cache=True, nogil=True)
def _best(zone: Zone, at: Floats, most: float) -> int:
    best = -1
    for i in range(len(at)):
        energy = _energy(zone, at, i)
        if energy > most:
            best, most = i, energy
    return best


@njit(cache=True, nogil=True)
def _best_of_view(
    zone: Zone, at: Floats, most: float, views: Ints, view: int, submaps: Ints32, submap: int, pose: Floats, x: float,
    y: float, near_m: float,
) -> int:  # fmt: skip
    best = -1
    for i in range(len(views)):
        if views[i] != view or submaps[i] != submap:
            continue
        if near_m == np.inf or math.hypot(pose[i, 0] - x, pose[i, 1] - y) <= near_m:
            energy = _energy(zone, at, i)
            if energy > most:
                best, most = i, energy
    return best
