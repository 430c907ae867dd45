"""A binary heap of nodes by their times: the entry of the least time comes first."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

Whole: TypeAlias = int | np.integer[Any]
Heap: TypeAlias = tuple[NDArray[np.float64], NDArray[np.uint32]]  # times, and the node of each


@njit(cache=True, nogil=True)
def twice(heap: Heap) -> Heap:
    """The heap with twice the room."""
    return np.concatenate((heap[0], heap[0])), np.concatenate((heap[1], heap[1]))


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
