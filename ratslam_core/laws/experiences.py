"""What is true of experiences and of the links between them between two steps."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ratslam_core.laws.measures import FAR_M, MOST, TURN, apart, array, true, whole, within
from ratslam_core.laws.views import places
from ratslam_core.pose_graph.adjacency import Adjacency
from ratslam_core.pose_graph.experiences import BUCKET, Experiences
from ratslam_core.pose_graph.transitions import BEHAVIOURS, Transitions

LARGEST = 1e12  # of weights and seconds


def experiences(known: Experiences, views: int) -> None:
    """ValueError names the first law that does not hold. views: how many local view cells there are."""
    room = len(array("poses", known.pose, np.float64, (None, 3)))
    array("states", known.at, np.float64, (room, 3))
    array("the experiences' views", known.view, np.int64, (room,))
    n = whole("the number of experiences", known.count, 0, room)
    within("an island", array("islands", known.island, np.int32, (room,))[:n], 0, MOST)
    within("a place in the map", known.pose[:n, :2], -FAR_M, FAR_M)
    within("a heading in the map", known.pose[:n, 2], -TURN, TURN)
    for axis in range(3):
        within("a state", known.at[:n, axis], 0.0, known.shape[2 - axis])
    within("an experience's view", known.view[:n], -1, views - 1)
    _chains(known, n, room)


def _chains(known: Experiences, n: int, room: int) -> None:
    """Each experience names the one before it of its view and of its bucket. The chains end, since the numbers fall."""
    before = array("before of the view", known._before_of_view, np.int64, (room,))
    expected, newest = _before(known.view[:n])
    true(np.array_equal(before[:n], expected), "each experience must know the one before it of its view")
    true(known._newest_of_view == newest, "each view must know its newest experience")
    buckets = tuple(-(-size // BUCKET) for size in known.shape)
    heads = array("the newest of each bucket", known._newest_in, np.int64, buckets)
    x, y, theta = known.at[:n].astype(np.int64).T
    n_theta, n_y, n_x = known.shape
    own = (theta % n_theta // BUCKET, y % n_y // BUCKET, x % n_x // BUCKET)
    key = np.asarray(np.ravel_multi_index(own, buckets), np.int64)
    expected, newest = _before(key)
    before = array("before in the bucket", known._before_in, np.int64, (room,))
    true(np.array_equal(before[:n], expected), "each experience must know the one before it of its bucket")
    wanted = np.full(math.prod(buckets), -1, np.int64)
    wanted[list(newest)] = list(newest.values())
    true(np.array_equal(heads.ravel(), wanted), "each bucket must know its newest experience")


def _before(keys: NDArray[np.int64]) -> tuple[NDArray[np.int64], dict[int, int]]:
    """For each row the last before it with the same key, -1 for none; and the last row of each key."""
    order = np.argsort(keys, kind="stable")
    before = np.full(len(keys), -1, np.int64)
    same = keys[order][1:] == keys[order][:-1]
    before[order[1:][same]] = order[:-1][same]
    last = order[np.append(~same, True)] if len(keys) else order
    return before, dict(zip(keys[last].tolist(), last.tolist(), strict=True))


def adjacency(graph: Adjacency, nodes: int) -> None:
    room = len(array("start", graph.start, np.uint32, (None,)))
    used, rooms = (array(name, a, np.uint32, (room,)) for name, a in (("used", graph.used), ("room", graph._room)))
    size = len(array("half-edges", graph.half, np.uint32, (None,)))
    other = array("other ends", graph.other, np.uint32, (size,))
    true(whole("the number of nodes", graph._nodes, 0, room) == nodes, f"there must be {nodes} nodes")
    apart("blocks of half-edges", graph.start[:nodes], rooms[:nodes], whole("their end", graph._end, 0, size), size)
    true((rooms[:nodes] > 0).all(), "a block of half-edges must have room to double")
    true((used[:nodes] <= rooms[:nodes]).all(), "a block of half-edges must have room for those in use")
    at = places(graph.start[:nodes].astype(np.int64), used[:nodes].astype(np.int64))
    if nodes:
        within("an other end", other[at], 0, nodes - 1)
    whole("changes", graph.changes)


def transitions(t: Transitions, nodes: int) -> None:
    """nodes: how many experiences there are."""
    adjacency(t.graph, nodes)
    room = len(array("ends", t.ends, np.int64, (None, 2)))
    n = whole("the number of transitions", t.count, 0, room)
    array("moves", t.move, np.float64, (room, 3))
    within("an end", t.ends[:n], 0, nodes - 1)
    within("a move", t.move[:n], -FAR_M, FAR_M)
    for name, high in (("weight", LARGEST), ("believed", LARGEST), ("turning_s", LARGEST), ("time_s", LARGEST),
                       ("confidence", 1.0)):  # fmt: skip
        within(name, array(name, getattr(t, name), np.float64, (room,))[:n], 0.0, high)
    for name in ("passages", "trials"):
        within(name, array(name, getattr(t, name), np.int64, (room,))[:n], 0, MOST)
    within("behaviour", array("behaviour", t.behaviour, np.int8, (room,))[:n], 0, BEHAVIOURS - 1)
    travelled = array("travelled", t.travelled, np.bool_, (room,))[:n]
    array("chain", t.chain, np.bool_, (room,))
    rows = np.flatnonzero(travelled)
    ways = {(i, j): row for (i, j), row in zip(t.ends[rows].tolist(), rows.tolist(), strict=True)}
    true(t.row_of == ways, "the rows of links must be those that were travelled")
    for row in t.free:
        whole("an empty row", row, 0, n - 1)
        empty = not travelled[row] and t.weight[row] == 0 == t.believed[row]
        true(empty, "a row that is used again must be no way and of no weight")
    true(len(set(t.free)) == len(t.free), "a row must be empty only once")
    for ends in t.dropped:
        true(isinstance(ends, tuple) and len(ends) == 2, "a dropped link must have two ends")
        for end in ends:
            whole("the end of a dropped link", end, 0, nodes - 1)
    _halves(t, n, nodes)


def _halves(t: Transitions, n: int, nodes: int) -> None:
    """Every row appears twice, at its beginning and at its end, and each of the two names the other."""
    graph, used = t.graph, t.graph.used[:nodes].astype(np.int64)
    at = places(graph.start[:nodes].astype(np.int64), used)
    half, other = graph.half[at].astype(np.int64), graph.other[at].astype(np.int64)
    node = np.repeat(np.arange(nodes), used)
    true(np.array_equal(np.sort(half), np.arange(2 * n)), "each transition must have its two half-edges")
    row, end = half >> 1, half & 1
    right = (t.ends[row, end] == node) & (t.ends[row, 1 - end] == other)
    true(right.all(), "a half-edge must name the ends of its transition")
