"""What is true of the goal memory, of the pictures of occupancy and of the last scan between two steps."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import math

import numpy as np

from ratslam_core.goal_links import FREE, misplaced
from ratslam_core.goal_memory import GoalMemory, _Iteration
from ratslam_core.laws.measures import FAR_M, array, number, true, whole, within
from ratslam_core.occupancy_grid import BOUND, KEPT, MapGrid, OccupancyGrid

MOST_LIT = 16_384  # cells of the plane above a share of the strongest: many packets, each as wide as its window
MOST_SONARS = 1024


def goal_memory(memory: GoalMemory, now_s: float) -> None:
    """ValueError names the first law that does not hold. now_s: for how long the robot has been under way."""
    plane = memory.shape[1] * memory.shape[2]
    place = array("the plane", memory._place, np.int32, (plane,))
    true(not place.any(), "the plane must be empty between two steps")
    keys = array("keys", memory._keys, np.int64, (None,))
    times = array("times", memory._times, np.float32, keys.shape)
    true(keys.size & (keys.size - 1) == 0, f"the table must have a power of two of places, got {keys.size}")
    used = keys != FREE
    links = whole("the number of links", memory._used, 0, keys.size // 2)
    true(links == np.count_nonzero(used), f"there must be as many keys as links, {links}")
    within("a key", keys[used], 0, plane * plane - 1)
    true((keys[used] // plane < keys[used] % plane).all(), "a key must name two cells, the smaller first")
    true(misplaced(keys) < 0, "each key must lie where it is looked for")
    within("a time", times[used], 0.0, float(np.finfo(np.float32).max))
    if memory._last is not None:
        _iteration(memory._last, memory.shape, now_s)


def _iteration(last: _Iteration, shape: tuple[int, int, int], now_s: float) -> None:
    true(isinstance(last, _Iteration), "the last iteration must be one")
    flats = array("what was active", last.flats, np.int64, (None,))
    true(len(np.unique(flats)) == len(flats) <= MOST_LIT, f"at most {MOST_LIT} cells were active, each once")
    within("what was active", flats, 0, shape[1] * shape[2] - 1)
    activity = array("its activity", last.activity, np.float64, flats.shape)
    within("its activity", activity, float(np.finfo(np.float32).tiny), 1e6)
    number("its x", last.x, 0.0, shape[2])
    number("its y", last.y, 0.0, shape[1])
    number("its time", last.time_s, 0.0, number("its latest time", last.latest_s, 0.0, now_s))


def occupancy(grid: OccupancyGrid, shape: tuple[int, int, int]) -> int:
    """Returns how many sonars it is made of. shape: of the pose cells."""
    angles = array("sonar angles", grid._angles, np.float64, (None,))
    true(angles.size <= MOST_SONARS, f"there are {angles.size} sonars; at most {MOST_SONARS}")
    within("a sonar's angle", angles, -100.0, 100.0)
    within("log odds", array("log odds", grid._log_odds, np.float32, shape[1:]), -BOUND, BOUND)
    return angles.size


def map_grid(grid: MapGrid, experiences: int, sonars: int) -> None:
    within("a sonar's angle", array("sonar angles", grid._angles, np.float64, (sonars,)), -100.0, 100.0)
    count = array("counts of scans", grid._count, np.int64, (None,))
    scans = array("scans", grid._scans, np.float32, (len(count), KEPT, 3 + sonars))
    known = whole("experiences with scans", grid._known, 0, min(len(count), experiences))
    within("a count of scans", count, 0, 2**53)
    true(not count[known:].any(), f"only the first {known} experiences may have scans")
    real = scans[:known][np.arange(KEPT) < count[:known, None]]
    within("where a scan was made", real[:, :3], -FAR_M, FAR_M)
    within("a range", real[:, 3:], 0.0, math.inf)
