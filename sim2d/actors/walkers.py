"""People who walk from point to point, wait, stop for what is in the way, and turn back if that takes too long."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from sim2d.geometry.wall_index import squared_distance
from sim2d.world.world import Person

PERSON_SIDES = 8
COMES_BACK_M = 0.01  # margin beyond the robot's reach at which a person comes back
_BANK = 64

_Array = NDArray[np.float64]


@kind("walkers/1")
class Walkers:
    """All people of a world, as arrays. xy: (n, 2) m; heading: (n,) rad; present: (n,) whether each is there."""

    CACHES = ("_people", "radius", "_speed", "_loop", "_first", "_path", "_wait_s", "_ring")

    def __init__(self, people: tuple[Person, ...], rng: np.random.Generator, tick_s: float, patience_s: float) -> None:
        """patience_s: how long each stands before an obstacle the first time."""
        n = len(people)
        self.tick_s = tick_s
        self.settle(people)
        self._chance = rng.random((n, _BANK))  # drawn in advance: each person has a stream of their own
        self._drawn = np.zeros(n, np.int64)
        self.xy = self._path[self._first[:-1]].copy()
        self.heading = np.zeros(n)
        self._towards = np.zeros(n, np.int64)  # index of the path's point that each walks to; people begin at the first
        self._way = np.ones(n, np.int64)
        self._waits = np.zeros(n)
        self._patience = np.full(n, patience_s)
        self.present = np.ones(n, bool)

    def settle(self, people: tuple[Person, ...]) -> None:
        """Compute the caches from the people's data."""
        self._people = people
        self.radius = np.array([p.radius for p in people])
        self._speed = np.array([p.speed for p in people])
        self._loop = np.array([p.loop for p in people], bool)
        self._first = np.cumsum([0, *(len(p.path) for p in people)])
        self._path = np.array([point for p in people for point in p.path], np.float64).reshape(-1, 2)
        self._wait_s = np.array([s for p in people for s in p.wait_s], np.float64)
        turn = 2 * math.pi * (np.arange(PERSON_SIDES) + 0.5) / PERSON_SIDES
        self._ring = np.column_stack([np.cos(turn), np.sin(turn)])

    def step(
        self, robot: tuple[float, float], reach: float, walking: bool, obstacles: _Array, present: NDArray[np.bool_],
        patience_s: tuple[float, float],
    ) -> None:  # fmt: skip
        """One tick. reach: the robot's radius plus its way in a tick. obstacles: (m, 4) leaves and box sides.

        patience_s: least and most time that a person stands before an obstacle before turning back.
        """
        if len(self._people):
            _walk(
                self.xy, self.heading, self._towards, self._way, self._waits, self._patience, self.present, self._drawn,
                self._chance, self.radius, self._speed, self._loop, self._first, self._path, self._wait_s,
                robot[0], robot[1], reach, walking, obstacles, present, *patience_s, self.tick_s,
            )  # fmt: skip

    def make_way(self, robot: tuple[float, float], radius: float) -> None:
        """People too near to a robot that has just been put down disappear until it leaves."""
        self.present &= np.hypot(*(self.xy - robot).T) > self.radius + radius + COMES_BACK_M

    def sides(self) -> _Array:
        """(n * PERSON_SIDES, 4): each person's outline, a polygon inside the radius."""
        turned = np.empty((len(self._people), PERSON_SIDES, 2))
        c, s = np.cos(self.heading)[:, None], np.sin(self.heading)[:, None]
        turned[..., 0] = self._ring[:, 0] * c - self._ring[:, 1] * s
        turned[..., 1] = self._ring[:, 0] * s + self._ring[:, 1] * c
        corners = self.xy[:, None] + self.radius[:, None, None] * turned
        return np.concatenate([np.roll(corners, 1, axis=1), corners], axis=2).reshape(-1, 4)

    def touch(self, x: float, y: float, reach: float) -> bool:
        """Whether any person, taken as a disc, is within `reach` metres of (x, y)."""
        if not len(self._people):
            return False
        away = np.hypot(self.xy[:, 0] - x, self.xy[:, 1] - y)
        return bool((self.present & (away < self.radius + reach)).any())

    def discs(self) -> list[tuple[float, float, float]]:
        """x, y, radius of everybody present."""
        return [(*self.xy[i].tolist(), float(self.radius[i])) for i in np.flatnonzero(self.present)]

    def standing(self) -> tuple[tuple[str, float, float, float], ...]:
        """Name, x, y, radius of everybody present."""
        names = (self._people[i].name for i in np.flatnonzero(self.present))
        return tuple((name, *disc) for name, disc in zip(names, self.discs(), strict=True))

    def adopt(self, old: Walkers) -> None:
        """After an edit: people whose data are unchanged go on from where they are."""
        was = {person: i for i, person in enumerate(old._people)}
        for i, person in enumerate(self._people):
            k = was.get(person)
            if k is None:
                continue
            for mine, theirs in zip(self._state_arrays(), old._state_arrays(), strict=True):
                mine[i] = theirs[k]

    def _state_arrays(self) -> tuple[NDArray[Any], ...]:
        return (
            self.xy, self.heading, self._towards, self._way, self._waits, self._patience, self.present, self._drawn,
            self._chance,
        )  # fmt: skip


@njit(cache=True, nogil=True)
def _walk(
    xy: _Array,
    heading: _Array,
    towards: NDArray[np.int64],
    way: NDArray[np.int64],
    waits: _Array,
    patience: _Array,
    present: NDArray[np.bool_],
    drawn: NDArray[np.int64],
    chance: _Array,
    radius: _Array,
    speed: _Array,
    loop: NDArray[np.bool_],
    first: NDArray[np.int64],
    path: _Array,
    wait_s: _Array,
    robot_x: float,
    robot_y: float,
    reach: float,
    walking: bool,
    obstacles: _Array,
    standing: NDArray[np.bool_],
    least_s: float,
    most_s: float,
    dt: float,
) -> None:
    for i in range(xy.shape[0]):
        away = math.hypot(xy[i, 0] - robot_x, xy[i, 1] - robot_y)
        if not walking:
            present[i] = False
            continue
        if not present[i]:
            present[i] = away > radius[i] + reach + COMES_BACK_M
            if not present[i]:
                continue
        n = first[i + 1] - first[i]
        if waits[i] > 0.0:
            waits[i] -= dt
            continue
        goal = first[i] + towards[i]
        dx, dy = path[goal, 0] - xy[i, 0], path[goal, 1] - xy[i, 1]
        left = math.hypot(dx, dy)
        step = min(speed[i] * dt, left)
        x, y = xy[i, 0], xy[i, 1]
        if left > 0.0:
            x, y = x + step * dx / left, y + step * dy / left
            heading[i] = math.atan2(dy, dx)
        near = math.hypot(x - robot_x, y - robot_y)
        blocked = near < radius[i] + reach and near < away
        if not blocked:
            blocked = _blocked(obstacles, standing, xy[i, 0], xy[i, 1], x, y, radius[i])
        if blocked:
            patience[i] = min(patience[i], most_s) - dt
            if patience[i] <= 0.0:
                way[i] = -way[i]
                towards[i] = (towards[i] + way[i]) % n
                patience[i] = _draw(chance, drawn, i, least_s, most_s)
            continue
        xy[i, 0], xy[i, 1] = x, y
        patience[i] = max(patience[i], least_s)
        if step == left:
            waits[i] = wait_s[goal] * _draw(chance, drawn, i, 0.5, 1.5)
            if not loop[i] and n > 1 and not 0 <= towards[i] + way[i] < n:
                way[i] = -way[i]
            towards[i] = (towards[i] + way[i]) % n


@njit(cache=True, nogil=True)
def _blocked(
    obstacles: _Array, standing: NDArray[np.bool_], x0: float, y0: float, x: float, y: float, radius: float
) -> bool:
    """Whether a step leads nearer to an obstacle that is then within the radius."""
    for k in range(obstacles.shape[0]):
        if standing[k]:
            after = squared_distance(obstacles, k, x, y)
            if after < radius * radius and after < squared_distance(obstacles, k, x0, y0):
                return True
    return False


@njit(cache=True, nogil=True)
def _draw(chance: _Array, drawn: NDArray[np.int64], i: int, low: float, high: float) -> float:
    """The next random number of person i, between low and high."""
    value = chance[i, drawn[i] % chance.shape[1]]
    drawn[i] += 1
    return low + value * (high - low)
