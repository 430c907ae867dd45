"""Which links meet at each experience, laid out for kernels that walk over the whole map."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind

ROOM = 4  # half-edges that a new node has room for


@kind("adjacency/1")
class Adjacency:
    """Each node owns a block of half-edges in one arena: `half[start[node]:][:used[node]]`, in the order of creation.

    A link from i to j that is row r elsewhere appears twice: at i as half 2 r, with `other` j, and at j as half 2 r +
    1, with `other` i. A full block moves to the end of the arena with twice the room, so that a walk over all nodes
    reads memory nearly in order. Row numbers need not be consecutive, and a removed one may be used again. All arrays
    are uint32, since compiled code need not test whether an unsigned index counts from the end; they are longer than
    what is in use.
    """

    def __init__(self) -> None:
        self.start = np.zeros(1024, np.uint32)
        self.used = np.zeros(1024, np.uint32)
        self.half = np.zeros(4096, np.uint32)
        self.other = np.zeros(4096, np.uint32)
        self._room = np.zeros(1024, np.uint32)
        self._nodes = self._end = 0
        self.changes = 0  # how often a node or a link was added or removed

    def add_node(self) -> None:
        if self._nodes == len(self.start):
            self.start, self.used, self._room = _double(self.start), _double(self.used), _double(self._room)
        self.start[self._nodes], self._room[self._nodes] = self._reserve(ROOM), ROOM
        self._nodes += 1
        self.changes += 1

    def add_link(self, i: int, j: int, row: int) -> None:
        """Row `row` links node i to node j."""
        for node in (i, j):
            if not 0 <= node < self._nodes:
                raise ValueError(f"a link must join nodes from 0 to {self._nodes - 1}, got {node!r}")
        self._append(i, 2 * row, j)
        self._append(j, 2 * row + 1, i)
        self.changes += 1

    def remove_link(self, i: int, j: int, row: int) -> None:
        """Remove a link; the others keep their order. O(links at i and j)."""
        at = self._find(i, 2 * row), self._find(j, 2 * row + 1)
        if min(at) < 0:
            raise ValueError(f"row {row!r} must link {i!r} to {j!r} to be removed, but it does not")
        self._take(i, at[0])
        self._take(j, self._find(j, 2 * row + 1))
        self.changes += 1

    def degree(self, node: int) -> int:
        """How many half-edges there are at a node."""
        return int(self.used[node])

    def at(self, node: int) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Half-edges at a node and the nodes at their other ends, in the order of creation. Views."""
        block = slice(int(self.start[node]), int(self.start[node]) + int(self.used[node]))
        return self.half[block], self.other[block]

    def _append(self, node: int, half: int, other: int) -> None:
        start, used = int(self.start[node]), int(self.used[node])
        if used == self._room[node]:
            self._room[node] *= 2
            new = self._reserve(2 * used)
            for array in (self.half, self.other):
                array[new : new + used] = array[start : start + used]
            self.start[node] = start = new
        self.half[start + used], self.other[start + used] = half, other
        self.used[node] = used + 1

    def _reserve(self, room: int) -> int:
        """Reserve room at the end of the arena; returns where it begins."""
        while self._end + room > len(self.half):
            self.half, self.other = _double(self.half), _double(self.other)
        self._end += room
        return self._end - room

    def _find(self, node: int, half: int) -> int:
        """Place of a half-edge in its block, -1 when it is not there."""
        if not 0 <= node < self._nodes:
            return -1
        found = np.flatnonzero(self.at(node)[0] == half)
        return int(found[0]) if len(found) else -1

    def _take(self, node: int, place: int) -> None:
        for block in self.at(node):
            block[place:-1] = block[place + 1 :].copy()
        self.used[node] -= 1


def _double(array: NDArray[np.uint32]) -> NDArray[np.uint32]:
    return np.concatenate([array, np.zeros_like(array)])
