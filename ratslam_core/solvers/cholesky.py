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
        for j in range(first, end):
            if not matrix[j, j] > 0.0:
                return False
            root = math.sqrt(matrix[j, j])
            for i in range(j, n):  # loops: an operation on whole arrays would take two seconds more to compile
                matrix[i, j] /= root
            for i in range(j + 1, n):
                for k in range(j + 1, min(end, i + 1)):
                    matrix[i, k] -= matrix[i, j] * matrix[k, j]
        columns = np.empty((end - first, n - end))
        for k in range(end - first):
            for i in range(end, n):
                columns[k, i - end] = matrix[i, first + k]
        for i in range(end, n):
            row = matrix[i, end : i + 1]
            for k in range(end - first):
                share, column = matrix[i, first + k], columns[k]
                for c in range(len(row)):
                    row[c] -= share * column[c]
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
