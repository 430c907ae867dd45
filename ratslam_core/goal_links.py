"""Compiled array functions of the goal memory: the table of links, what is learnt, and the lowest time in reach."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.pose_cells.activity_kernels import Cells, Shape, Values, X, Y, offset

FREE = -1  # key of an empty place in the table


@njit(cache=True, nogil=True)
def project(
    cells: Cells, activity: Values, shape: Shape, share: float, place: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.float64], int]:
    """G_xy = sum over theta of P, where it is above share * G_max. IROS 2005 eq. 1.

    Returns the cells of the plane, their G, and the first row that lies outside of it (-1: none). `place`: scratch, all
    0.
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
def centre(flats: NDArray[np.int64], values: NDArray[np.float64], shape: Shape, near: int) -> tuple[float, float]:
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
def find(key: int, keys: NDArray[np.int64]) -> int:
    """Where a key is in the table, or the free place where it belongs. The table is never full."""
    mask = keys.size - 1
    mixed = key * 5_872_781
    at = (mixed ^ (mixed >> 21)) & mask
    while keys[at] != key and keys[at] != FREE:
        at = (at + 1) & mask
    return at


@njit(cache=True, nogil=True)
def misplaced(keys: NDArray[np.int64]) -> int:
    """The first place whose key would be looked for elsewhere, -1 when there is none."""
    for at in range(keys.size):
        if keys[at] != FREE and find(keys[at], keys) != at:
            return at
    return -1


@njit(cache=True, nogil=True)
def learn(
    flats_i: NDArray[np.int64],
    G_i: NDArray[np.float64],
    flats_j: NDArray[np.int64],
    G_j: NDArray[np.float64],
    keys: NDArray[np.int64],
    times: NDArray[np.float32],
    used: int,
    shape: Shape,
    elapsed: float,
    time_weight: float,
    activity_weight: float,
    distance_weight: float,
    rate: float,
) -> int:
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
            at = find(key, keys)
            if keys[at] == FREE:
                keys[at] = key
                times[at] = tau
                used += 1
            else:
                times[at] += rate * (tau - times[at])
    return used


@njit(cache=True, nogil=True)
def move(
    keys: NDArray[np.int64], times: NDArray[np.float32], new_keys: NDArray[np.int64], new_times: NDArray[np.float32]
) -> None:
    """Copy all links into a larger table."""
    for k in range(keys.size):
        if keys[k] != FREE:
            at = find(keys[k], new_keys)
            new_keys[at] = keys[k]
            new_times[at] = times[k]


@njit(cache=True, nogil=True)
def lowest(T: NDArray[np.float64], x: int, y: int, reach: int, keys: NDArray[np.int64]) -> int:
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
                if unknown or keys[find(key, keys)] == key:
                    best, lowest = there, T[there_y, there_x]
    return best
