"""The experiences themselves: which state of the pose cells and which scene each stands for, and which fits best. ACRA 2005 4.1.

The experiences of one view form a chain, and so do those of one bucket of pose cells, which keeps the search quick.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.params import ExperienceMapParams
from ratslam_core.types import Floats, Ints, Ints32, Packet, Pose2

BUCKET = 4  # cells and layers along a side


@kind("experiences/4")
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
        self._newest_of_view: dict[int, int] = {}
        self._before_of_view = np.full(1024, -1, np.int64)  # the experience before it of the same view, -1 for none
        self._newest_in = np.full([-(-n // BUCKET) for n in shape], -1, np.int64)
        self._before_in = np.full(1024, -1, np.int64)

    def add(self, packet: Packet, view: int, pose: Pose2, submap: int = 0) -> int:
        """One more experience; returns its number."""
        if self.count == len(self.pose):
            for name in ("pose", "at", "view", "submap", "_before_of_view", "_before_in"):
                array = getattr(self, name)
                setattr(self, name, np.concatenate([array, np.zeros_like(array)]))
        i = self.count
        n_theta, n_y, n_x = self.shape
        x, y, theta = self._state(packet)
        self.pose[i] = pose.x, pose.y, pose.heading_rad
        self.at[i], self.view[i], self.submap[i] = (x, y, theta), view, submap
        bucket = int(theta) % n_theta // BUCKET, int(y) % n_y // BUCKET, int(x) % n_x // BUCKET
        self._before_of_view[i] = self._newest_of_view.get(view, -1)
        self._newest_of_view[view] = i
        self._before_in[i] = self._newest_in[bucket]
        self._newest_in[bucket] = i
        self.count += 1
        return i

    def forget_view(self, view: int) -> None:
        """The view is no more. Its experiences stay in the map as places where there is nothing to see."""
        i = self._newest_of_view.pop(view, -1)
        while i >= 0:
            before = int(self._before_of_view[i])
            self.view[i] = -1
            self._insert_blind(i)
            i = before

    def _insert_blind(self, i: int) -> None:
        after, j = -1, self._newest_of_view.get(-1, -1)
        while j > i:
            after, j = j, int(self._before_of_view[j])
        self._before_of_view[i] = j
        if after < 0:
            self._newest_of_view[-1] = i
        else:
            self._before_of_view[after] = i

    def _state(self, packet: Packet) -> tuple[float, float, float]:
        """x', y' in cells and theta' in layers, from 0 to below the size of the network."""
        n_theta, n_y, n_x = self.shape
        return packet.x % n_x, packet.y % n_y, (packet.heading_rad * n_theta / (2 * math.pi)) % n_theta

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

    def of_view(self, view: int) -> Ints:
        """The experiences of a view, the newest first."""
        return _chain(self._newest_of_view.get(view, -1), self._before_of_view)

    def energy(self, experience: int, packet: Packet, view: int, p: ExperienceMapParams) -> float:
        """ACRA 2006 eqs. 1-4: E = 0 if r > 1 or q > 1 or V != V_i, else 2 - r - q; ACRA 2005 eqs. 4-9: V ((1-r)+ + (1-q)+)."""
        if p.match_view and view != self.view[experience]:
            return 0.0
        zone = p.zone_xy, p.zone_theta, p.energy == "2005"
        return float(_energy(*self._state(packet), self.at, experience, *self.shape, *zone))

    def most_energetic(
        self,
        packet: Packet,
        view: int,
        p: ExperienceMapParams,
        robot: Pose2,
        blind_m: float,
        gate_m: float = math.inf,
        submap: int = 0,
    ) -> int:
        """The experience with the most energy above the threshold, the oldest of equals; -1 for none.

        Where views tell experiences apart (`match_view`), only those count that are on this submap and within `gate_m` of the
        robot in the map, the validation gate.

        [ours] When there is nothing to see, only the pose cells tell places apart, and they may use the same cells for
        places far apart. The experience must then be within `blind_m` of the robot in the map, too.
        test_experience_map.py::test_seeing_nothing_closes_no_loop.
        """
        old = p.energy == "2005"
        state = (*self._state(packet), *self.shape, p.zone_xy, p.zone_theta)
        if p.match_view:
            newest = self._newest_of_view.get(view, -1)
            near = min(blind_m, gate_m) if view < 0 else gate_m
            return _best_in_chain(
                newest, self._before_of_view, self.at, *state, old, -1, p.threshold, self.pose, robot.x, robot.y, near,
                self.submap, submap,
            )[0]  # fmt: skip
        if old:
            return _best_of_all(self.at[: self.count], *state, p.threshold)
        return _best_in_buckets(self._newest_in, self._before_in, self.at, *state, p.threshold, self.pose, self.submap)


@njit(cache=True, nogil=True, inline="always")
def _apart(a: float, b: float, n: int) -> float:
    """How far two coordinates from 0 to n are apart on a ring."""
    d = abs(a - b)
    return min(d, n - d)


@njit(cache=True, nogil=True, inline="always")
def _energy(
    x: float,
    y: float,
    theta: float,
    at: Floats,
    i: int,
    n_theta: int,
    n_y: int,
    n_x: int,
    zone_xy: float,
    zone_theta: float,
    old: bool,
) -> float:
    r = math.sqrt(_apart(x, at[i, 0], n_x) ** 2 + _apart(y, at[i, 1], n_y) ** 2) / zone_xy
    q = _apart(theta, at[i, 2], n_theta) / zone_theta
    if old:
        return max(1.0 - r, 0.0) + max(1.0 - q, 0.0)
    return 0.0 if r > 1.0 or q > 1.0 else 2.0 - r - q


@njit(cache=True, nogil=True)
def _chain(newest: int, before: Ints) -> Ints:
    """All members of a chain, the newest first."""
    count, i = 0, newest
    while i >= 0:
        count, i = count + 1, before[i]
    found = np.empty(count, np.int64)
    i = newest
    for k in range(count):
        found[k] = i
        i = before[i]
    return found


@njit(cache=True, nogil=True)
def _best_in_chain(
    newest: int,
    before: Ints,
    at: Floats,
    x: float,
    y: float,
    theta: float,
    n_theta: int,
    n_y: int,
    n_x: int,
    zone_xy: float,
    zone_theta: float,
    old: bool,
    best: int,
    most: float,
    pose: Floats,
    near_x: float,
    near_y: float,
    near: float,
    submaps: Ints32,
    submap: int,
) -> tuple[int, float]:
    i = newest
    while i >= 0:
        counts = submap < 0 or submaps[i] == submap
        if counts and (near == np.inf or math.hypot(pose[i, 0] - near_x, pose[i, 1] - near_y) <= near):
            energy = _energy(x, y, theta, at, i, n_theta, n_y, n_x, zone_xy, zone_theta, old)
            if energy > most or (energy == most and i < best):
                best, most = i, energy
        i = before[i]
    return best, most


@njit(cache=True, nogil=True)
def _best_in_buckets(
    newest: Ints,
    before: Ints,
    at: Floats,
    x: float,
    y: float,
    theta: float,
    n_theta: int,
    n_y: int,
    n_x: int,
    zone_xy: float,
    zone_theta: float,
    most: float,
    pose: Floats,
    submaps: Ints32,
) -> int:
    """The best experience in the buckets that the zone touches."""
    best = -1
    first_t, count_t = _buckets(theta, zone_theta, n_theta, newest.shape[0])
    first_y, count_y = _buckets(y, zone_xy, n_y, newest.shape[1])
    first_x, count_x = _buckets(x, zone_xy, n_x, newest.shape[2])
    for t in range(count_t):
        for b in range(count_y):
            for a in range(count_x):
                bucket: tuple[int, int, int] = (
                    (first_t + t) % newest.shape[0], (first_y + b) % newest.shape[1], (first_x + a) % newest.shape[2],
                )  # fmt: skip
                head = newest[bucket]
                best, most = _best_in_chain(
                    head, before, at, x, y, theta, n_theta, n_y, n_x, zone_xy, zone_theta, False, best, most,
                    pose, 0.0, 0.0, np.inf, submaps, -1,
                )  # fmt: skip
    return best


@njit(cache=True, nogil=True, inline="always")
def _buckets(middle: float, reach: float, n: int, buckets: int) -> tuple[int, int]:
    """The first bucket, and how many from there, round the ring, cover [middle - reach, middle + reach]."""
    reach += 1e-9  # so that rounding leaves no experience out
    if 2 * reach + BUCKET >= n:
        return 0, buckets
    first = int((middle - reach) % n) % n // BUCKET
    last = int((middle + reach) % n) % n // BUCKET
    return first, (last - first) % buckets + 1


@njit(cache=True, nogil=True)
def _best_of_all(
    at: Floats,
    x: float,
    y: float,
    theta: float,
    n_theta: int,
    n_y: int,
    n_x: int,
    zone_xy: float,
    zone_theta: float,
    most: float,
) -> int:
    """The energy of 2005 reaches every experience of the same heading, and any heading at the same place."""
    best = -1
    for i in range(at.shape[0]):
        faces = 1.0 - _apart(theta, at[i, 2], n_theta) / zone_theta > most
        if faces or (_apart(x, at[i, 0], n_x) < zone_xy and _apart(y, at[i, 1], n_y) < zone_xy):
            energy = _energy(x, y, theta, at, i, n_theta, n_y, n_x, zone_xy, zone_theta, True)
            if energy > most:
                best, most = i, energy
    return best
