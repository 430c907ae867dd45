"""Shortest times to the nearest of some nodes, the goals, along links and, when there is a reach, by shortcuts to nodes
that are close in the map.

Dijkstra's algorithm on a binary heap. A node whose time fell stands in it twice, and the older entry is skipped. A time
is that of the next node on the way plus that of the link, rounded. Such sums only grow, so the least of them do not
depend on the order in which they are found. Starting afresh and mending an older tree therefore end at the same bits:
test_temporal_map.py::test_a_map_that_was_mended_is_as_good_as_new.
"""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from numba import njit

from ratslam_core.types import Floats, Ints, Ints32, Uints32

# start, used, half, other of an `Adjacency`, and the seconds of each row, inf for no way
Links: TypeAlias = tuple[Uints32, Uints32, Uints32, Uints32, Floats]
# poses, reach (m, 0 = no shortcuts), pace (s/m), and the grid of `buckets`
Near: TypeAlias = tuple[Floats, float, float, Ints32, Ints32]
Heap: TypeAlias = tuple[Floats, Uints32]  # times, the least first, and the node of each
Whole: TypeAlias = int | np.integer[Any]
LEAST_S = 1e-3  # no link takes less, so that no way leads round in circles


@njit(cache=True, nogil=True)
def fresh(goals: Ints, times: Floats, parent: Ints32, links: Links, near: Near) -> None:
    """Write the seconds from every node to its nearest goal to `times`, inf for no way, and the next node or -1 to
    `parent`. All goals are in the heap from the start, so that many cost as much as one."""
    times[:] = np.inf
    parent[:] = -1
    times[goals] = 0.0
    heap = np.zeros(64 + len(goals)), np.zeros(64 + len(goals), np.uint32)
    for k in range(len(goals)):  # equal times are a heap in any order
        heap[1][k] = goals[k]
    _settle(np.int64(len(goals)), heap, times, parent, links, near)


@njit(cache=True, nogil=True)
def mend(goals: Ints, times: Floats, parent: Ints32, links: Links, near: Near) -> None:
    """The same, beginning with an older tree in `parent`, however links and times have changed since.

    First come the times along what is left of the old tree: none is too short. Then every shorter way is followed up.
    """
    n = len(times)
    stack = np.empty(n, np.int32)
    times[:] = -1.0
    times[goals] = 0.0
    for first in range(n):
        depth = 0
        node: int = first
        while times[node] < 0:
            stack[depth] = node
            depth += 1
            if parent[node] < 0:
                break
            node = parent[node]
        while depth > 0:
            depth -= 1
            node = stack[depth]
            ahead = parent[node]
            times[node] = np.inf if ahead < 0 else times[ahead] + _between(node, ahead, links, near)
            if times[node] == np.inf:
                parent[node] = -1
    size, heap = 0, (np.empty(n), np.empty(n, np.uint32))
    for node in range(n):
        if times[node] < np.inf and _offers(node, times, links, near):
            push(size, heap, times[node], node)
            size += 1
    _settle(size, heap, times, parent, links, near)


@njit(cache=True, nogil=True, inline="always")
def _offers(node: Whole, times: Floats, links: Links, near: Near) -> bool:
    """Whether a neighbour would be nearer by way of this node."""
    start, used, halves, others, seconds = links
    begin = np.uint64(start[node])
    for at in range(begin, begin + np.uint64(used[node])):
        if times[node] + seconds[np.uint64(halves[at] >> np.uint32(1))] < times[np.uint64(others[at])]:
            return True
    poses, reach, _, heads, following = near
    if reach > 0:
        for k in range(9):
            other: int = heads[_bucket(poses[node, 0], poses[node, 1], reach, k, len(heads))]
            while other >= 0:
                if times[node] + _between(node, other, links, near) < times[other]:
                    return True
                other = following[other]
    return False


@njit(cache=True, nogil=True)
def _settle(size: Whole, heap: Heap, times: Floats, parent: Ints32, links: Links, near: Near) -> None:
    """t_j <- min(t_j, t_i + t_ij) for all neighbours j of the nearest node i, until none is left. ACRA 2006 eqs. 10-12."""
    start, used, halves, others, seconds = links
    poses, reach, _, heads, following = near
    while size > 0:
        now, node = heap[0][0], np.uint64(heap[1][0])
        size -= 1
        pop(size, heap)
        if now > times[node]:
            continue
        begin = np.uint64(start[node])
        while size + used[node] > len(heap[0]):
            heap = twice(heap)
        for at in range(begin, begin + np.uint64(used[node])):
            other, time = np.uint64(others[at]), now + seconds[np.uint64(halves[at] >> np.uint32(1))]
            if time < times[other]:
                times[other], parent[other] = time, node
                push(size, heap, time, other)
                size += 1
        if reach > 0:
            for k in range(9):
                near_by: int = heads[_bucket(poses[node, 0], poses[node, 1], reach, k, len(heads))]
                while near_by >= 0:
                    time = now + _between(node, near_by, links, near)
                    if time < times[near_by]:
                        times[near_by], parent[near_by] = time, node
                        if size == len(heap[0]):
                            heap = twice(heap)
                        push(size, heap, time, near_by)
                        size += 1
                    near_by = following[near_by]


@njit(cache=True, nogil=True)
def trace(start: int, times: Floats, links: Links, near: Near) -> Ints:
    """Nodes of the quickest way to a goal, where the time is 0; among equal ways, the one whose next node has the lowest
    number."""
    path: list[Whole] = [start]
    node: Whole = start
    other: Whole
    while times[node] > 0:
        best: Whole = len(times)
        begin, used, _, others, _ = links
        for at in range(begin[node], begin[node] + used[node]):
            other = np.int64(others[at])
            if other < best and times[other] + _between(node, other, links, near) == times[node]:
                best = other
        poses, reach, _, heads, following = near
        if reach > 0:
            for k in range(9):
                other = heads[_bucket(poses[node, 0], poses[node, 1], reach, k, len(heads))]
                while other >= 0:
                    if other < best and times[other] + _between(node, other, links, near) == times[node]:
                        best = other
                    other = following[other]
        node = best
        path.append(node)
    return np.array(path)


@njit(cache=True, nogil=True, inline="always")
def _between(a: Whole, b: Whole, links: Links, near: Near) -> float:
    """Seconds between two nodes: of the quickest link, else of the shortcut; inf when there is neither."""
    start, used, halves, others, seconds = links
    least = np.inf
    begin = np.uint64(start[a])
    for at in range(begin, begin + np.uint64(used[a])):
        if others[at] == np.uint32(b):
            least = min(least, seconds[np.uint64(halves[at] >> np.uint32(1))])
    poses, reach, pace, _, _ = near
    if reach > 0 and least == np.inf:
        apart = math.hypot(poses[a, 0] - poses[b, 0], poses[a, 1] - poses[b, 1])
        if apart < reach:
            least = max(LEAST_S, pace * apart)
    return least


@njit(cache=True, nogil=True)
def buckets(poses: Floats, reach: float) -> tuple[Ints32, Ints32]:
    """A grid of cells as wide as the reach, hashed: the first node of each bucket, and the one after each node."""
    size = 16
    while size < len(poses):
        size *= 2
    heads, following = np.full(size, -1, np.int32), np.full(len(poses), -1, np.int32)
    for node in range(len(poses) - 1, -1, -1):
        bucket = _bucket(poses[node, 0], poses[node, 1], reach, 4, size)
        following[node] = heads[bucket]
        heads[bucket] = node
    return heads, following


@njit(cache=True, nogil=True, inline="always")
def _bucket(x: float, y: float, reach: float, k: int, size: Whole) -> Whole:
    """Bucket of the k-th of the nine cells around a place; number 4 is its own. `size` is a power of two."""
    column, row = np.int64(math.floor(x / reach)) + k % 3 - 1, np.int64(math.floor(y / reach)) + k // 3 - 1
    return (column * 73856093 ^ row * 19349663) & (size - 1)


@njit(cache=True, nogil=True, inline="always")
def push(size: Whole, heap: Heap, time: float, node: Whole) -> None:
    """Add an entry to the `size` that there are; there must be room."""
    key, name = heap
    one, at = np.uint64(1), np.uint64(size)
    while at:
        above = (at - one) >> one
        if key[above] <= time:
            break
        key[at], name[at] = key[above], name[above]
        at = above
    key[at], name[at] = time, node


@njit(cache=True, nogil=True, inline="always")
def pop(size: Whole, heap: Heap) -> None:
    """Remove the entry of the least time; `size` entries are left."""
    key, name = heap
    one, at, end = np.uint64(1), np.uint64(0), np.uint64(size)
    last, node = key[end], name[end]
    while True:
        below = (at << one) + one
        if below >= end:
            break
        if below + one < end and key[below + one] < key[below]:
            below += one
        if last <= key[below]:
            break
        key[at], name[at] = key[below], name[below]
        at = below
    key[at], name[at] = last, node


@njit(cache=True, nogil=True)
def twice(heap: Heap) -> Heap:
    """The heap with twice the room."""
    return np.concatenate((heap[0], heap[0])), np.concatenate((heap[1], heap[1]))
