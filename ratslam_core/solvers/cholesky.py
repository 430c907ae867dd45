"""Symmetric dense systems: Cholesky's factor, block by block, and solving with it."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

BLOCK = 32  # columns that are eliminated together


@njit(cache=True, nogil=True)
def factor(matrix: NDArray[np.float64]) -> bool:
    """The lower triangle becomes L with L L^T = matrix; False when a pivot is not positive.

    A library's factor would be twice as quick, but its last digits depend on how many cores there are.
    """
    n = len(matrix)
    for first in range(0, n, BLOCK):
        end = min(first + BLOCK, n)
        if not _factor_columns(matrix, first, end):
            return False
        columns = np.empty((end - first, n - end))
        for k in range(end - first):
            for i in range(end, n):
                columns[k, i - end] = matrix[i, first + k]
        for i in range(end, n):  # a block is whole where rows are left below it, so its columns come in fours
            row, shares = matrix[i, end : i + 1], matrix[i, first:end]
            for k in range(0, len(shares), 4):
                s0, s1, s2, s3 = shares[k], shares[k + 1], shares[k + 2], shares[k + 3]
                c0, c1, c2, c3 = columns[k], columns[k + 1], columns[k + 2], columns[k + 3]
                for c in range(len(row)):
                    row[c] = row[c] - s0 * c0[c] - s1 * c1[c] - s2 * c2[c] - s3 * c3[c]
    return True


@njit(cache=True, nogil=True)
def _factor_columns(matrix: NDArray[np.float64], first: int, end: int) -> bool:
    """Columns `first` to `end` of L, row by row, since a row lies together in memory and a column does not."""
    roots, across = np.empty(BLOCK), np.empty((BLOCK, BLOCK))  # of the block on the diagonal; across: its transpose
    for i in range(first, len(matrix)):
        row = matrix[i, first : min(end, i + 1)]
        for j in range(len(row)):
            if first + j == i:
                if not row[j] > 0.0:
                    return False
                roots[j] = math.sqrt(row[j])
            row[j] /= roots[j]
            share, column = row[j], across[j]
            if i < end:
                column[i - first] = share
            for k in range(j + 1, len(row)):
                row[k] -= share * column[k]
    return True


@njit(cache=True, nogil=True)
def solve_rows(triangle: NDArray[np.float64], rows: NDArray[np.int64], out: NDArray[np.float64]) -> None:
    """Solve L L^T x = b in place: each column of b is in these rows of `out`, and x takes its place.

    triangle: (k, k), L; rows: (k,).
    """
    x = np.empty(len(rows))
    for k in range(out.shape[1]):
        for i in range(len(rows)):
            x[i] = out[rows[i], k]
        for i in range(len(rows)):
            for j in range(i):
                x[i] -= triangle[i, j] * x[j]
            x[i] /= triangle[i, i]
        for i in range(len(rows) - 1, -1, -1):
            x[i] /= triangle[i, i]
            for j in range(i):
                x[j] -= triangle[i, j] * x[i]
        for i in range(len(rows)):
            out[rows[i], k] = x[i]
