"""Goal memory: travel times between places, learnt on the pose cells' plane, and the way to a goal. IROS 2005 section III.

G_xy is the activity of the pose cells at a place, summed over all headings. A link tau_ij says how long the way from
cell i to cell j takes. Times to a goal are summed along the links; the robot moves towards the lowest time in reach.

Links are sparse: a hash table of pairs (i < j) with room for twice as many as there are, 12 bytes each.
"""

# SciPy has no types, and callers may not be type-checked.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.params import GoalMemoryParams
from ratslam_core.pose_cells.activity_kernels import Cells, Shape, Values, X, Y, offset
from ratslam_core.types import Floats, Ints, Ints32, Packet, Singles, require_finite

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

ARRIVED = 1.0  # cells from the goal within which the robot has arrived, III.B
REACH = 3  # cells around the packet in which the way is searched, III.B
WIDER = 3  # the largest multiple of that which is searched when there is no way nearer
CENTRE = 3  # cells to either side of the strongest among which the packet's centre is computed
ROOM = 4096  # links there is room for at first; doubles when half full
MOST_CELLS = 2**20  # in the plane, so that keys stay below 2^40 and their hash below 2^63
FREE = -1  # key of an empty place in the table


@kind("goal memory/1")
class GoalMemory:
    """tau_ij between the cells of the (x', y') plane. `learn` in every iteration, `times_to` once a goal is chosen."""

    CACHES = ("_graph",)  # left out of snapshots

    def __init__(self, params: GoalMemoryParams | None, shape: tuple[int, int, int], cell_m: float) -> None:
        """shape: (n_theta, n_y, n_x) of the pose cells; cell_m: side of one cell, m."""
        if len(shape) != 3 or min(shape) < 1:
            raise ValueError(f"shape must be (n_theta, n_y, n_x), each at least 1 cell, got {shape!r}")
        if shape[1] * shape[2] > MOST_CELLS:
            raise ValueError(f"shape must have at most {MOST_CELLS} cells in the plane, got {shape!r}")
        if not (math.isfinite(cell_m) and cell_m > 0):
            raise ValueError(f"cell_m must be a positive number of metres, got {cell_m!r}")
        self.params = params or GoalMemoryParams()
        self.shape, self.cell_m = shape, cell_m
        self._place = np.zeros(shape[1] * shape[2], np.int32)
        self._keys = np.full(ROOM, FREE, np.int64)
        self._times = np.zeros(ROOM, np.float32)
        self._used = 0
        self._last: _Iteration | None = None
        self._graph: csr_matrix | None = None

    def __len__(self) -> int:
        """How many links there are, each good for both ways."""
        return self._used

    @property
    def memory_bytes(self) -> int:
        """Memory of the links and of the plane."""
        return self._keys.nbytes + self._times.nbytes + self._place.nbytes

    @property
    def links(self) -> tuple[Ints, Singles]:
        """Pairs of cells y * n_x + x, shape (m, 2), the smaller first, and tau in s, shape (m,). In no order; copies."""
        used = self._keys != FREE
        keys = self._keys[used]
        return np.stack([keys // self._place.size, keys % self._place.size], axis=1), self._times[used]

    def times_to(self, x: int, y: int) -> Floats:
        """The temporal map T: s from every cell to this one, shape (n_y, n_x); 0 there, inf where no way is known.

        T_i <- min(T_i, min_j (T_j + tau_ji)) until nothing decreases, IROS 2005 eq. 6. That ends at the shortest times,
        which Dijkstra's algorithm finds at once. test_goal_memory.py::test_it_is_the_equations.
        """
        n_y, n_x = self.shape[1:]
        for name, value, size in (("x", x, n_x), ("y", y, n_y)):
            if not isinstance(value, int | np.integer) or not 0 <= value < size:
                raise ValueError(f"{name} must be a whole cell from 0 to {size - 1}, got {value!r}")
        from scipy.sparse import csr_matrix  # slow to import, and no first step needs it
        from scipy.sparse.csgraph import dijkstra

        if self._graph is None:
            pairs, times = self.links
            size = self._place.size
            self._graph = csr_matrix((times.astype(np.float64), (pairs[:, 0], pairs[:, 1])), (size, size))
        times = np.asarray(dijkstra(self._graph, directed=False, indices=int(y) * n_x + int(x)))
        return times.reshape(n_y, n_x)

    def direction(self, T: Floats, packet: Packet) -> float | None:
        """Where to go: rad in the pose cells' frame, towards the lowest T in reach of the packet. IROS 2005 section III.B.

        T: from `times_to`. None within one cell of the goal, and when no way is known from here.

        [ours] Only those cells in reach count that are linked to the packet's own cell. To these the robot has driven,
        while another near cell may lie behind a wall. Links may be longer than REACH, so when no cell in reach is
        lower, up to WIDER times the reach is tried. The next cell of the quickest way is linked and lower, so there
        are no local minima, except at places that only a jump of the packet leads away from: then there is no direction
        to drive. test_goal_memory.py::test_it_does_not_point_through_a_wall, ::test_there_are_no_local_minima.
        """
        n_y, n_x = self.shape[1:]
        if T.shape != (n_y, n_x):
            raise ValueError(f"T must have shape {(n_y, n_x)}, as times_to gives it, got {T.shape}")
        x, y = require_finite("packet.x", packet.x), require_finite("packet.y", packet.y)
        goal = int(np.argmin(T))
        if self._apart(x, y, goal % n_x, goal // n_x) <= ARRIVED:
            return None
        for wider in range(1, WIDER + 1):
            best = lowest(T, round(x) % n_x, round(y) % n_y, wider * REACH, self._keys)
            if best >= 0:
                return math.atan2(offset(best // n_x, y, n_y), offset(best % n_x, x, n_x))
        return None

    def learn(self, cells: Ints32, activity: Singles, time_s: float) -> None:
        """Link what is active now with what was active in the iteration before. IROS 2005 eqs. 1-5.

        cells, activity: the active set of the pose cells (`PoseCells.active`); time_s: the time, increasing. A clock
        that stands still while the robot waits keeps the waiting out of the link times.

        [ours] Only cells above `share` of the strongest are linked: at most (cells of a packet above it)^2 links a
        call. [ours] The iteration before is one from which the packet has moved `stride_m`. At 10 Hz a packet is wider
        than its movement in a tick, so every cell in it would be linked to every other with the same 0.1 s, however
        slow the robot is, and the times would not depend on speed.
        test_goal_memory.py::test_the_faster_way_wins_over_the_shorter_one.
        """
        time_s = require_finite("time_s", time_s)
        last = self._last
        if last is not None and time_s <= last.latest_s:
            raise ValueError(f"time_s must be later than the time before, {last.latest_s!r}, got {time_s!r}")
        now = self._project(cells, activity, time_s)
        if last is None:
            self._last = now
            return
        last.latest_s = time_s
        if self._apart(now.x, now.y, last.x, last.y) < self.params.stride_m / self.cell_m:
            return
        self._make_room(last.flats.size * now.flats.size)
        p = self.params
        self._used = _learn(
            last.flats, last.activity, now.flats, now.activity, self._keys, self._times, self._used, self.shape,
            time_s - last.time_s, p.time_weight, p.activity_weight, p.distance_weight, p.rate,
        )  # fmt: skip
        self._last, self._graph = now, None

    def interrupt(self) -> None:
        """The next iteration is linked to none before it: the packet was not driven to where it is."""
        self._last = None

    def _project(self, cells: Ints32, activity: Singles, time_s: float) -> _Iteration:
        if cells.ndim != 2 or cells.shape[1] != 4 or activity.shape != cells.shape[:1]:
            raise ValueError(f"cells must have shape (n, 4) and activity (n,), got {cells.shape} and {activity.shape}")
        n_y, n_x = self.shape[1:]
        flats, values, wrong = _projected(cells, activity, self.shape, self.params.share, self._place)
        if wrong >= 0:
            raise ValueError(f"cells must lie in 0..{n_x - 1}, 0..{n_y - 1}, got {cells[wrong, :2].tolist()}")
        if flats.size == 0:
            raise ValueError(f"activity must be positive somewhere, got {activity!r}")
        return _Iteration(flats, values, *centre(flats, values, self.shape, CENTRE), time_s, time_s)

    def _apart(self, x1: float, y1: float, x2: float, y2: float) -> float:
        """Cells between two places, the shorter way round."""
        return math.hypot(offset(x1, x2, self.shape[2]), offset(y1, y2, self.shape[1]))

    def _make_room(self, more: int) -> None:
        size = self._keys.size
        while 2 * (self._used + more) > size:
            size *= 2
        if size > self._keys.size:
            keys, times = np.full(size, FREE, np.int64), np.zeros(size, np.float32)
            _move(self._keys, self._times, keys, times)
            self._keys, self._times = keys, times


@kind("iteration/1")
@dataclass(slots=True)
class _Iteration:
    """Which cells of the plane were active, and when."""

    flats: Ints  # cells of the plane, y * n_x + x
    activity: Floats  # G of each
    x: float  # centre of the packet, cells
    y: float
    time_s: float
    latest_s: float  # time of the latest iteration since


@njit(cache=True, nogil=True)
def _projected(cells: Cells, activity: Values, shape: Shape, share: float, place: Ints32) -> tuple[Ints, Floats, int]:
    """G_xy = sum over theta of P, where it is above share * G_max. IROS 2005 eq. 1.

    Returns the cells of the plane, their G, and the first row that lies outside of it (-1: none). place: scratch, all 0.
    """
    n_y, n_x = shape[1], shape[2]
    flats = np.empty(len(cells), np.int64)
    values = np.empty(len(cells), np.float64)
    n = 0
    wrong = -1
    for i in range(len(cells)):
        x, y = cells[i, X], cells[i, Y]
        if not (0 <= x < n_x and 0 <= y < n_y):
            wrong = i
            break
        flat = y * n_x + x
        at = place[flat]
        if at == 0:
            flats[n] = flat
            values[n] = activity[i]
            n += 1
            place[flat] = n
        else:
            values[at - 1] += activity[i]
    most = 0.0
    for i in range(n):
        place[flats[i]] = 0
        most = max(most, values[i])
    kept = 0
    for i in range(n):
        if values[i] > share * most:
            flats[kept] = flats[i]
            values[kept] = values[i]
            kept += 1
    return flats[:kept], values[:kept], wrong


@njit(cache=True, nogil=True)
def centre(flats: Ints, values: Floats, shape: Shape, near: int) -> tuple[float, float]:
    """Centre of the activity within `near` cells of the strongest, in cells."""
    n_y, n_x = shape[1], shape[2]
    best = np.argmax(values)
    peak_x, peak_y = flats[best] % n_x, flats[best] // n_x
    mass = sx = sy = 0.0
    for i in range(flats.size):
        dx, dy = offset(flats[i] % n_x, peak_x, n_x), offset(flats[i] // n_x, peak_y, n_y)
        if abs(dx) <= near and abs(dy) <= near:
            mass += values[i]
            sx += values[i] * dx
            sy += values[i] * dy
    return (peak_x + sx / mass) % n_x, (peak_y + sy / mass) % n_y


@njit(cache=True, nogil=True)
def _learn(
    flats_i: Ints, G_i: Floats, flats_j: Ints, G_j: Floats, keys: Ints, times: Singles, used: int, shape: Shape,
    elapsed: float, time_weight: float, activity_weight: float, distance_weight: float, rate: float,
) -> int:  # fmt: skip
    """tau_ij = tau_ji <- moving average of a dt + b (1 - G_i G_j / G_max^2) + g |i - j|. IROS 2005 eqs. 2-5.

    i: active in the iteration before; j: active now. The first value replaces the large one that a link starts with.
    Returns how many links there are.
    """
    n_y, n_x = shape[1], shape[2]
    size = n_y * n_x
    most = max(np.max(G_i), np.max(G_j))
    sigma = time_weight * elapsed
    for a in range(flats_i.size):
        i = flats_i[a]
        xi, yi = i % n_x, i // n_x
        for b in range(flats_j.size):
            j = flats_j[b]
            if i == j:
                continue
            mu = activity_weight * (1.0 - G_i[a] * G_j[b] / (most * most))
            dx, dy = offset(j % n_x, xi, n_x), offset(j // n_x, yi, n_y)
            tau = sigma + mu + distance_weight * np.sqrt(dx * dx + dy * dy)
            key = min(i, j) * size + max(i, j)
            at = _find(key, keys)
            if keys[at] == FREE:
                keys[at] = key
                times[at] = tau
                used += 1
            else:
                times[at] += rate * (tau - times[at])
    return used


@njit(cache=True, nogil=True)
def _move(keys: Ints, times: Singles, new_keys: Ints, new_times: Singles) -> None:
    """Copy all links into a larger table."""
    for k in range(keys.size):
        if keys[k] != FREE:
            at = _find(keys[k], new_keys)
            new_keys[at] = keys[k]
            new_times[at] = times[k]


@njit(cache=True, nogil=True)
def lowest(T: Floats, x: int, y: int, reach: int, keys: Ints) -> int:
    """The cell with the lowest T below that of (x, y), among those within `reach` that it is linked to; -1 when there is none.

    Where nothing has been learnt yet (T is inf), any known cell in reach will do.
    """
    n_y, n_x = T.shape
    here = y * n_x + x
    best, lowest = -1, T[y, x]
    unknown = not np.isfinite(lowest)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            if dx * dx + dy * dy > reach * reach:
                continue
            there_x, there_y = (x + dx) % n_x, (y + dy) % n_y
            if T[there_y, there_x] < lowest:
                there = there_y * n_x + there_x
                key = min(here, there) * (n_y * n_x) + max(here, there)
                if unknown or keys[_find(key, keys)] == key:
                    best, lowest = there, T[there_y, there_x]
    return best


@njit(cache=True, nogil=True)
def _find(key: int, keys: Ints) -> int:
    """Where a key is in the table, or the free place where it belongs. The table is never full."""
    mask = keys.size - 1
    mixed = key * 5_872_781
    at = (mixed ^ (mixed >> 21)) & mask
    while keys[at] != key and keys[at] != FREE:
        at = (at + 1) & mask
    return at


@njit(cache=True, nogil=True)
def misplaced(keys: Ints) -> int:
    """The first place whose key would be looked for elsewhere, -1 when there is none."""
    for at in range(keys.size):
        if keys[at] != FREE and _find(keys[at], keys) != at:
            return at
    return -1


def lead_s(memory: GoalMemory, T: Floats, apart_m: float = 2.0) -> Floats:
    """By how many seconds the quickest way from each cell leads over the quickest other way, shape (n_y, n_x).

    T: s, from `GoalMemory.times_to`; inf where there is one way only. Another way begins with a link to a cell with a lower
    T, too, and comes at least `apart_m` away from the first. test_goal_plateau.py.

    Near 0 is a plateau: two ways to the goal, in opposite directions, take the same time. IROS 2005 V.D, point C: "it is
    possible for the goal memory movement vectors to be split evenly between taking the upper and lower paths. The choice of
    the robot as to which path to take in this condition is arbitrary". It is the watershed of the times: where they are
    highest along a loop, since times grow from the goal on both ways round until they meet. That is a maximum, so the robot
    always leaves it, and no local minimum.
    """
    n_y, n_x = memory.shape[1:]
    if T.shape != (n_y, n_x):
        raise ValueError(f"T must have shape {(n_y, n_x)}, as times_to gives it, got {T.shape}")
    pairs, tau = memory.links
    t = T.ravel()
    here, there = np.concatenate([pairs, pairs[:, ::-1]]).T
    via = t[there] + np.concatenate([tau, tau])
    down = np.isfinite(via) & (t[there] < t[here])
    here, there, via = here[down], there[down], via[down]
    order = np.lexsort((via, here))
    cells, first = np.unique(here[order], return_index=True)
    following = np.full(t.size, -1)
    following[cells] = there[order][first]
    quickest = np.full(t.size, np.inf)
    quickest[cells] = via[order][first]
    lead = np.full(t.size, np.inf)
    ways: dict[int, Ints] = {}
    for row in order:
        i, j = int(here[row]), int(there[row])
        if lead[i] == np.inf and j != following[i]:  # the quickest links come first
            best, other = (ways.setdefault(k, _way(k, following)) for k in (int(following[i]), j))
            if memory.cell_m * _parting(best, other, n_x, n_y) >= apart_m:
                lead[i] = via[row] - quickest[i]
    return lead.reshape(n_y, n_x)


def _way(cell: int, following: Ints) -> Ints:
    """The cells from this one to the goal."""
    way = [cell]
    while following[way[-1]] >= 0:
        way.append(int(following[way[-1]]))
    return np.array(way)


def _parting(a: Ints, b: Ints, n_x: int, n_y: int) -> float:
    """The largest distance (cells) of a cell of either way from the other way."""
    dx, dy = _offset(a[:, None] % n_x, b[None] % n_x, n_x), _offset(a[:, None] // n_x, b[None] // n_x, n_y)
    apart = np.hypot(dx, dy)
    return float(max(apart.min(0).max(), apart.min(1).max()))


def _offset(a: Ints, b: Ints, size: int) -> Floats:
    """Cells from a to b, the shorter way round."""
    return ((b - a + size / 2) % size - size / 2).astype(np.float64)
