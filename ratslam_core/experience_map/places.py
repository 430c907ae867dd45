"""Which experiences belong to one place, and where pose cells and places do not correspond. ACRA 2005 3.6, 3.7.

Pose cells wrap and snap. One place may therefore have several states of the pose cells (multiple representations), and
one state may stand for several places (a hash collision). The corrected map shows which: it brings the
experiences of the former together and keeps those of the latter apart. [ours] The method; the paper shows both by eye.
test_places.py::test_places_are_those_of_a_loop_over_all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from ratslam_core.pose_graph.pose_graph import PoseGraph
from ratslam_core.types import Flags, Floats, Ints


@dataclass(frozen=True, slots=True)
class MultipleRepresentation:
    """One place that several states of the pose cells stand for, with the robot facing the same way."""

    place: int
    experiences: tuple[int, ...]  # the first of each state


@dataclass(frozen=True, slots=True)
class HashCollision:
    """One state of the pose cells that stands for several places."""

    x: float  # cells
    y: float
    theta: float  # layers
    experiences: tuple[int, ...]  # the first at each place


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """The experiences of a map by place. A place is named by its first experience; those within the radius belong to it."""

    radius_m: float
    first: Ints  # (k,): the first experience of each place
    place_of: Ints  # (n,): the place of each experience, a row of `first`
    multiple_representations: tuple[MultipleRepresentation, ...]
    hash_collisions: tuple[HashCollision, ...]


def find_places(map_: PoseGraph, radius_m: float = 0.5) -> Places:
    """Group the experiences of a map, whichever way they face, and find multiple representations and hash collisions.

    radius_m: how far (m) an experience may be from the first of its place. Two states of the pose cells are the same
    when they are no farther apart than the width of a place plus the radius of a zone of influence. Two places of one
    state are distinct when they are farther apart than the widths of a place and of a zone. ValueError for a radius
    that is not positive.
    """
    if not (math.isfinite(radius_m) and radius_m > 0):
        raise ValueError(f"radius_m must be a positive number of metres, got {radius_m!r}")
    poses, states, (n_theta, n_y, n_x) = map_.poses, map_.cell_states, map_.shape
    zone_xy, zone_theta = map_.params.zone_xy, map_.params.zone_theta
    leader = _first_near(np.column_stack([poses[:, :2], np.zeros(len(poses))]), 0.0, 0.0, 1.0, radius_m, 1.0)
    first, place_of = np.unique(leader, return_inverse=True)

    ring = (float(n_x), float(n_y), float(n_theta))
    facing = zone_theta * 2 * math.pi / n_theta
    same_xy, same_theta = 2 * radius_m / map_.cell_m + zone_xy, 2 * zone_theta
    rival = _rivals(leader, poses[:, 2], states, ring, facing, same_xy, same_theta)
    multiple = [MultipleRepresentation(int(place_of[group[0]]), tuple(group)) for group in _groups(leader, rival)]

    state = _first_near(states, ring[0], ring[1], ring[2], zone_xy, zone_theta)
    apart = _apart_in_map(state, poses, 2 * radius_m + 2 * zone_xy * map_.cell_m)
    collisions = [_collision(states[state[group[0]]], group) for group in _groups(state, apart)]
    return Places(radius_m, first, place_of.astype(np.int64), tuple(multiple), tuple(collisions))


def _collision(state: Floats, group: list[int]) -> HashCollision:
    x, y, theta = map(float, state)
    return HashCollision(x, y, theta, tuple(group))


def _groups(owner: Ints, chosen: Flags) -> list[list[int]]:
    """The chosen experiences of each owner that has two or more, by owner."""
    several = np.bincount(owner[chosen], minlength=len(owner)) > 1
    members = np.flatnonzero(chosen & several[owner])
    members = members[np.argsort(owner[members], kind="stable")]
    cuts = np.flatnonzero(np.diff(owner[members])) + 1
    return [group.tolist() for group in np.split(members, cuts) if len(group)]


@njit(cache=True, nogil=True, inline="always")
def _between(a: float, b: float, ring: float) -> float:
    """How far apart two coordinates are, on a ring of this size, or on a line when the size is 0."""
    d = abs(a - b)
    return min(d, ring - d) if ring > 0.0 else d


@njit(cache=True, nogil=True)
def _first_near(at: Floats, ring_x: float, ring_y: float, ring_t: float, reach: float, reach_t: float) -> Ints:
    """(n,): the earliest leader within reach of each row. A row that has none becomes a leader, its own.

    at: (n, 3). Leaders are kept in hashed buckets as wide as the reach, so only a row's own bucket and those beside it
    count.
    """
    n = at.shape[0]
    mask = 1
    while mask < 2 * n:
        mask *= 2
    mask -= 1
    newest = np.full(mask + 1, -1, np.int64)
    before = np.full(n, -1, np.int64)
    leader = np.empty(n, np.int64)
    around = np.empty((3, 3), np.int64)  # for each coordinate, what its own bucket and those beside it add to the hash
    for i in range(n):
        count_x = _buckets(around[0], at[i, 0], ring_x, reach, 73856093)
        count_y = _buckets(around[1], at[i, 1], ring_y, reach, 19349663)
        count_t = _buckets(around[2], at[i, 2], ring_t, reach_t, 83492791)
        best = i
        for a in range(count_x):
            for b in range(count_y):
                for c in range(count_t):
                    j = newest[(around[0, a] ^ around[1, b] ^ around[2, c]) & mask]
                    while j >= 0:
                        if j < best and _between(at[i, 2], at[j, 2], ring_t) <= reach_t:
                            dx, dy = _between(at[i, 0], at[j, 0], ring_x), _between(at[i, 1], at[j, 1], ring_y)
                            if dx * dx + dy * dy <= reach * reach:
                                best = j
                        j = before[j]
        leader[i] = best
        if best == i:
            key = (around[0, 0] ^ around[1, 0] ^ around[2, 0]) & mask
            before[i] = newest[key]
            newest[key] = i
    return leader


@njit(cache=True, nogil=True, inline="always")
def _buckets(around: Ints, value: float, ring: float, reach: float, prime: int) -> int:
    """Write the coordinate's own bucket, then its neighbours, each once and times a prime; returns how many.

    Buckets are a little wider than the reach, so that rounding never hides a row that is just within it.
    """
    width = reach * (1.0 + 1e-9)
    if ring == 0.0:
        own = math.floor(value / width)
        around[0], around[1], around[2] = own * prime, (own - 1) * prime, (own + 1) * prime
        return 3
    count = max(1, int(ring / width))
    own = min(int(value / ring * count), count - 1)
    around[0], around[1], around[2] = own * prime, (own + 1) % count * prime, (own - 1) % count * prime
    return min(count, 3)


@njit(cache=True, nogil=True)
def _rivals(
    place: Ints, facing: Floats, states: Floats, ring: tuple[float, float, float], reach_facing: float, reach: float,
    reach_t: float,
) -> Flags:  # fmt: skip
    """(n,): the first experiences of states that share place and facing with another state.

    place: (n,) the first experience of each one's place.
    """
    n = place.shape[0]
    newest = np.full(n, -1, np.int64)  # state of a place
    before = np.full(n, -1, np.int64)
    rival = np.zeros(n, np.bool_)
    for i in range(n):
        known = False
        own: int = place[i]
        j: int = newest[own]
        while j >= 0 and not known:
            dx, dy = _between(states[i, 0], states[j, 0], ring[0]), _between(states[i, 1], states[j, 1], ring[1])
            same = dx * dx + dy * dy <= reach * reach and _between(states[i, 2], states[j, 2], ring[2]) <= reach_t
            known = same and _turned(facing[i], facing[j]) <= reach_facing
            j = before[j]
        if known:
            continue
        j = newest[own]
        while j >= 0:
            if _turned(facing[i], facing[j]) <= reach_facing:
                rival[i] = rival[j] = True
            j = before[j]
        before[i] = newest[own]
        newest[own] = i
    return rival


@njit(cache=True, nogil=True, inline="always")
def _turned(a: float, b: float) -> float:
    d = abs(a - b) % (2.0 * math.pi)
    return min(d, 2.0 * math.pi - d)


@njit(cache=True, nogil=True)
def _apart_in_map(state: Ints, poses: Floats, far: float) -> Flags:
    """(n,): whether an experience is the first of its state at its place; places are more than `far` (m) apart.

    state: (n,) the first experience of each one's state.
    """
    n = state.shape[0]
    newest = np.full(n, -1, np.int64)
    before = np.full(n, -1, np.int64)
    first = np.zeros(n, np.bool_)
    for i in range(n):
        j = newest[state[i]]
        known = False
        while j >= 0 and not known:
            known = math.hypot(poses[i, 0] - poses[j, 0], poses[i, 1] - poses[j, 1]) <= far
            j = before[j]
        if not known:
            first[i] = True
            before[i] = newest[state[i]]
            newest[state[i]] = i
    return first
