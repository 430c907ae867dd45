"""Graphs made up: streets on a grid, driven at a metre from place to place."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.back_end.graph import Graph, measured

BLOCK_M = 5  # between crossings
SIDE_M = 40
SEEN_SHARE = 0.6  # of the places that the robot comes back to, those that it recognises
LEAST_TICKS = 20  # between two visits that count as coming back

Cells = list[tuple[int, int]]


def manhattan(poses: int = 3500, seed: int = 1) -> Graph:
    """A random drive through a grid of streets, turning at crossings, as in the Manhattan world of Olson (2006)."""
    rng = np.random.default_rng(seed)
    x = y = SIDE_M // 2
    dx, dy = 1, 0
    cells: Cells = [(x, y)]
    while len(cells) < poses:
        if x % BLOCK_M == 0 and y % BLOCK_M == 0:
            ways = [(dx, dy), (-dy, dx), (dy, -dx)]
            ways = [(a, b) for a, b in ways if 0 <= x + a <= SIDE_M and 0 <= y + b <= SIDE_M]
            dx, dy = ways[rng.integers(len(ways))]
        x, y = x + dx, y + dy
        cells.append((x, y))
    return _driven("Manhattan", cells, rng)


def ring_city(poses: int = 2400, seed: int = 2) -> Graph:
    """Rounds on a ring road with a block of houses at every turn-off: many small loops, and few that hold the ring together."""
    rng = np.random.default_rng(seed)
    cells: Cells = [(0, 0)]
    side, step = 100, 10
    corners = [(0, 0), (side, 0), (side, side), (0, side)]
    while len(cells) < poses:
        for k, (x, y) in enumerate(corners):
            to_x, to_y = corners[(k + 1) % 4]
            dx, dy = (to_x - x) // side, (to_y - y) // side
            for _ in range(side // step):
                if rng.random() < 0.35:  # once round the block outside of the ring
                    for a, b, n in ((dy, -dx, step), (dx, dy, step), (-dy, dx, step), (-dx, -dy, step)):
                        _go(cells, a, b, n)
                _go(cells, dx, dy, step)
    return _driven("ring city", cells[:poses], rng)


def _go(cells: Cells, dx: int, dy: int, steps: int) -> None:
    for _ in range(steps):
        cells.append((cells[-1][0] + dx, cells[-1][1] + dy))


def _driven(name: str, cells: Cells, rng: np.random.Generator) -> Graph:
    """The graph of a drive over these places. What is recognised is the last visit to the same place."""
    places = np.array(cells, np.float64)
    ahead = np.diff(places, axis=0, append=places[-1:] + (places[-1:] - places[-2:-1]))
    truth = np.column_stack([places, [math.atan2(y, x) for x, y in ahead]])
    last: dict[tuple[int, int], int] = {}
    ends: list[tuple[int, int]] = []
    for k, cell in enumerate(cells):
        before = last.get(cell, k)
        if k - before > LEAST_TICKS and rng.random() < SEEN_SHARE:
            ends.append((before, k))
        last[cell] = k
    closures: NDArray[np.int64] = np.array(ends, np.int64).reshape(-1, 2)
    return measured(name, truth, closures, rng)
