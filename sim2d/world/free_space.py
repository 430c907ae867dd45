"""Where the robot fits between the walls, and the shortest way between two places. For placing and judging it.

The one authority on where the robot fits: for kidnaps, starts, edits and the ring under a dragged robot.
"""

# SciPy has no type annotations.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from sim2d.geometry.grid_cells import connected, spread
from sim2d.geometry.segments import differing, free_cells, inside_ring, nearest_segment
from sim2d.world.world import Box, Door, World

CELL_M = 0.05
MOST_CELLS = 4_000_000  # a larger floor is given larger cells
LEANS_M = 0.01  # how far the robot may overlap with something that it leans on
_MOST_CHANGES = 64  # if more walls differ, the whole floor is measured anew
# Eight neighbours and eight knight's moves; of each pair of opposite moves one is listed.
_MOVES = ((1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2))
_BOTH_WAYS = np.concatenate([np.array(_MOVES)[:, ::-1], -np.array(_MOVES)[:, ::-1]])  # rows, columns
_PIECE = 32  # so many cells of a path are spread from at once


class FreeSpace:
    """The floor on which a disc of `radius` metres can stand and that it can reach from one of the world's starts."""

    def __init__(
        self, world: World, radius: float, cell_m: float | None = None, before: FreeSpace | None = None
    ) -> None:
        """before: of a world that may differ in a few walls; only the floor around these is measured anew."""
        x0, y0, x1, y1 = world.bounds
        if cell_m is None:
            cell_m = max(CELL_M, math.sqrt((x1 - x0) * (y1 - y0) / MOST_CELLS))
        self.world = world
        self.radius = radius
        self._cell = cell_m
        self._segments = world.segments()[list(world.obstacles)]
        self._ring = world.outline
        self._xs = np.arange(x0 + 0.5 * cell_m, x1, cell_m)
        self._ys = np.arange(y0 + 0.5 * cell_m, y1, cell_m)
        self._free = self._measured(before)
        cells = [self._open_cell(self._free, start.x, start.y) for start in world.starts]
        seeds = np.array([cell for cell in cells if cell is not None], np.int64).reshape(-1, 2)
        self._reachable = connected(self._free, seeds)

    def _measured(self, before: FreeSpace | None) -> NDArray[np.bool_]:
        """(n_y, n_x): cells on which the robot can stand."""
        if before is not None and (before.radius, before._cell) != (self.radius, self._cell):
            before = None
        if before is None or not np.array_equal(before._ring, self._ring):
            return free_cells(self._segments, self._ring, self._xs, self._ys, self.radius)
        changes = differing(before._segments, self._segments)
        if len(changes) > _MOST_CHANGES:
            return free_cells(self._segments, self._ring, self._xs, self._ys, self.radius)
        free = before._free.copy()
        for x1, y1, x2, y2 in changes:
            left, right = self._around(self._xs, x1, x2)
            low, high = self._around(self._ys, y1, y2)
            xs, ys, far = self._xs[left:right], self._ys[low:high], self.radius + self._cell
            a, b = self._segments[:, :2], self._segments[:, 2:]
            ahead = np.maximum(a, b) >= (xs[0] - far, ys[0] - far)
            behind = np.minimum(a, b) <= (xs[-1] + far, ys[-1] + far)
            near = self._segments[(ahead & behind).all(axis=1)]
            free[low:high, left:right] = free_cells(near, self._ring, xs, ys, self.radius)
        return free

    def _around(self, centres: NDArray[np.float64], a: float, b: float) -> tuple[int, int]:
        """The range of cells, first and one past the last, that a wall from a to b along this axis may affect."""
        low, high = ((p - centres[0]) / self._cell for p in (min(a, b) - self.radius, max(a, b) + self.radius))
        return min(max(int(low) - 1, 0), len(centres) - 1), min(max(int(high) + 3, 1), len(centres))

    def holds(self, world: World, radius: float) -> bool:
        """Whether this free space is also that of another world and radius."""
        mine, its = ((each.name, each.starts, each.walls) for each in (self.world, world))
        return radius == self.radius and mine == its

    def is_free(self, x: float, y: float) -> bool:
        """Whether the robot can stand there and could have driven there."""
        return self.refusal(x, y) is None

    def refusal(self, x: float, y: float) -> str | None:
        """Why the walls leave no room for the robot at (x, y), or None. `RobotFit` adds doors, boxes, people."""
        if not (math.isfinite(x) and math.isfinite(y)):
            return f"({x}, {y}) is not a place; both must be finite"
        if not inside_ring(self._ring, x, y):
            x0, y0, x1, y1 = self.world.bounds
            return f"({x:g}, {y:g}) is outside of {self.world.name}, which spans {x0:g} to {x1:g} by {y0:g} to {y1:g} m"
        distance, wall = self.nearest_wall(x, y)
        if distance < self.radius:
            return f"({x:g}, {y:g}) is {distance:.3f} m from {wall}; the robot needs {self.radius:g} m"
        if self._open_cell(self._reachable, x, y) is None:
            return f"({x:g}, {y:g}) is closed in: no way leads there from {self.world.starts[0].name}"
        return None

    def nearest_wall(self, x: float, y: float) -> tuple[float, str]:
        """Distance (m) from (x, y) to the nearest wall that stands on the floor, and which wall it is, in words."""
        nearest, distance = nearest_segment(self._segments, x, y)
        number = self.world.obstacles[nearest]
        return distance, f"walls[{number}] ({self.world.walls[number].kind})"

    def clearance(self, x: float, y: float) -> float:
        """Distance (m) from (x, y) to the nearest wall that stands on the floor."""
        return self.nearest_wall(x, y)[0]

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A random free place: the centre of a cell, all cells being equally likely."""
        rows, columns = self._open
        k = int(rng.integers(rows.size))
        return float(self._xs[columns[k]]), float(self._ys[rows[k]])

    def shortest_m(self, a: tuple[float, float], b: tuple[float, float]) -> float:
        """The length (m) of the shortest way that the robot can drive from a to b; inf if there is none.

        Since a way on the grid has only 16 directions, the result is up to 2.7 % too long, plus a cell at each end.
        """
        if not (self._touches_free(*a) and self._touches_free(*b)):
            return math.inf
        straight = math.dist(a, b)
        if straight <= self.clearance(*a) - self.radius:  # b lies on the free disc around a
            return straight
        start, goal = self._open_cell(self._reachable, *a), self._open_cell(self._reachable, *b)
        nodes, graph = self._graph
        metres = dijkstra(graph, directed=False, indices=nodes[start])[nodes[goal]]
        return max(straight, float(metres))

    def cover(self, covered: NDArray[np.bool_], places: NDArray[np.float64], metres: float) -> int:
        """Mark in `covered`, (n_y, n_x), from where the robot can drive to one of `places`, (n, 2), in at most so many
        metres; how many cells are new. `floor_cells` says how many there are."""
        columns, rows = np.floor((places - self.world.bounds[:2]) / self._cell).astype(np.int64).T
        inside = (columns >= 0) & (rows >= 0) & (columns < len(self._xs)) & (rows < len(self._ys))
        cells = np.stack([rows[inside], columns[inside]], axis=1)
        if not len(cells):
            return 0
        cells = cells[np.append(True, np.any(cells[1:] != cells[:-1], axis=1))]  # it stays in a cell for a while
        pieces = (cells[k : k + _PIECE] for k in range(0, len(cells), _PIECE))
        return sum(int(spread(self._reachable, covered, piece, metres / self._cell, _BOTH_WAYS)) for piece in pieces)

    @property
    def grid(self) -> tuple[int, int]:
        """The rows and columns of cells."""
        return len(self._ys), len(self._xs)

    @cached_property
    def floor_cells(self) -> int:
        """How many cells can be reached."""
        return int(np.count_nonzero(self._reachable))

    def coarse(self, cell_m: float) -> NDArray[np.bool_]:
        """(n_y, n_x): larger cells, about so wide, of which more than half can be reached."""
        n = max(1, round(cell_m / self._cell))
        rows, columns = (size // n for size in self._reachable.shape)
        parts = self._reachable[: rows * n, : columns * n].reshape(rows, n, columns, n)
        most: NDArray[np.bool_] = parts.mean(axis=(1, 3)) > 0.5
        return most

    def islands(self, least_m2: float) -> NDArray[np.float64]:
        """A point in each part of the world that this floor surrounds and that is no smaller than this, (n, 2).

        Such a part is walls, what they enclose, and the rim round them that is too narrow for the robot.
        """
        padded: NDArray[np.int32] = np.zeros(np.add(self._reachable.shape, 2), np.int32)
        label(np.pad(~self._reachable, 1, constant_values=True), output=padded)
        outside, parts = padded[0, 0], padded[1:-1, 1:-1]
        sizes = np.bincount(parts.ravel()) * self._cell**2
        points: list[tuple[float, float]] = []
        for part in np.flatnonzero(sizes >= least_m2):
            if part in (0, outside):  # 0 is the floor itself
                continue
            rows, columns = np.nonzero(parts == part)
            k = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
            points.append((float(self._xs[columns[k]]), float(self._ys[rows[k]])))
        return np.array(points).reshape(-1, 2)

    def _touches_free(self, x: float, y: float) -> bool:
        """Whether (x, y) is free, or at most a cell too near to a wall, as when the robot leans on it."""
        if self.is_free(x, y):
            return True
        leans = inside_ring(self._ring, x, y) and self.radius > self.clearance(x, y) >= self.radius - self._cell
        return leans and self._open_cell(self._reachable, x, y) is not None

    @cached_property
    def _open(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        rows, columns = np.nonzero(self._reachable)
        return rows, columns

    @cached_property
    def _graph(self) -> tuple[NDArray[np.int32], csr_matrix]:
        """The number of each cell's node, (n_y, n_x), -1 where unreachable; and the lengths between neighbours (m)."""
        nodes = np.full(self._reachable.shape, -1, np.int32)
        count = self._open[0].size
        nodes[self._open] = np.arange(count)
        heads, tails, lengths = list[NDArray[np.int32]](), list[NDArray[np.int32]](), list[NDArray[np.float64]]()
        for dx, dy in _MOVES:
            here, there = _shifted(nodes, dx, dy)
            both = (here >= 0) & (there >= 0)
            heads.append(here[both])
            tails.append(there[both])
            lengths.append(np.full(heads[-1].size, math.hypot(dx, dy) * self._cell))
        data, ends = np.concatenate(lengths), (np.concatenate(heads), np.concatenate(tails))
        return nodes, csr_matrix((data, ends), shape=(count, count))

    def _open_cell(self, is_open: NDArray[np.bool_], x: float, y: float) -> tuple[int, int] | None:
        """Row and column of the open cell nearest to (x, y), among the cell that contains it and its neighbours."""
        x0, y0 = self.world.bounds[:2]
        i, j = int((x - x0) / self._cell), int((y - y0) / self._cell)
        left, low = max(i - 1, 0), max(j - 1, 0)
        rows, columns = np.nonzero(is_open[low : j + 2, left : i + 2])
        if rows.size == 0:
            return None
        rows, columns = rows + low, columns + left
        k = int(np.argmin((self._xs[columns] - x) ** 2 + (self._ys[rows] - y) ** 2))
        return int(rows[k]), int(columns[k])


def _shifted(nodes: NDArray[np.int32], dx: int, dy: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Two parts of the grid of the same size, the second shifted by (dx, dy) cells; dx >= 0."""
    n_y, n_x = nodes.shape
    low, high = max(0, -dy), min(n_y, n_y - dy)
    return nodes[low:high, : n_x - dx], nodes[low + dy : high + dy, dx:]


@dataclass(frozen=True, slots=True)
class Standing:
    """What stands on the floor besides walls: doors with their opening, boxes, people (name, x, y, radius)."""

    doors: tuple[tuple[Door, float], ...] = ()
    boxes: tuple[Box, ...] = ()
    people: tuple[tuple[str, float, float, float], ...] = ()

    @classmethod
    def at_first(cls, world: World) -> Standing:
        """What stands there as a world begins. People are left out, since they make way for the robot."""
        doors = tuple((door, float(door.open)) for door in world.doors)
        return cls(doors, tuple(box for box in world.boxes if box.present))

    def distances(self, x: float, y: float) -> Iterator[tuple[float, str]]:
        """The distance (m) from (x, y) to each of them, 0 inside it, and its name."""
        for i, (door, opening) in enumerate(self.doors):
            yield nearest_segment(door.leaf(opening)[None], x, y)[1], f"doors[{i}] ({door.name})"
        for box in self.boxes:
            yield box.distance(x, y), f"box {box.name!r}"
        for name, px, py, radius in self.people:
            yield max(math.hypot(px - x, py - y) - radius, 0.0), f"person {name!r}"


@dataclass(frozen=True, slots=True, eq=False)
class RobotFit:
    """Where a robot fits at one moment. It is immutable, so it may be used from any thread."""

    floor: FreeSpace  # what the walls leave free for a robot of this size
    standing: Standing = Standing()

    def refusal(self, x: float, y: float) -> str | None:
        """Why the robot cannot be put at (x, y), or None."""
        refusal = self.floor.refusal(x, y)
        if refusal is not None:
            return refusal
        for distance, what in self.standing.distances(x, y):
            if distance < self.floor.radius:
                return f"({x:g}, {y:g}) is {distance:.3f} m from {what}; the robot needs {self.floor.radius:g} m"
        return None

    def covering(self, x: float, y: float) -> str | None:
        """Why a robot that is at (x, y) cannot stay there, or None. It may lean on things and need not be reachable."""
        at, radius = f"the robot at ({x:.2f}, {y:.2f})", self.floor.radius - LEANS_M
        if not inside_ring(self.floor.world.outline, x, y):
            return f"{at} would be outside of the outer walls; leave it inside"
        for distance, what in (self.floor.nearest_wall(x, y), *self.standing.distances(x, y)):
            if distance < radius:
                return f"{what} would cover {at}; keep {radius:.2f} m away from it"
        return None
