"""Sparse Laplacian systems, solved exactly by eliminating one node of the net after the other (star-mesh transform).

The system is a net of springs or resistors. Eliminating a node links each two of its neighbours directly, with the
product of their weights over the sum of all. This is Gaussian elimination, with sums of positive numbers only. The node
with the fewest neighbours goes first, which keeps nets of chains, as maps are, nearly as sparse as they were. The rest,
in which most nodes have many neighbours, is solved as a dense matrix, by Cholesky's factor.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from ratslam_core.types import Floats, Ints, Uints32

SPARE = 2  # neighbours that a node has room for at first, in addition to its own
DENSE = 8  # the rest is dense when each of its nodes is linked to an eighth of it or more
DENSE_IS_QUICKER = 100  # how many times quicker a product in a dense matrix is than one of two links
BLOCK = 32  # columns of a dense matrix that are eliminated together


def eliminate(n: int, links: Ints, weights: Floats, largest: int = 4000) -> Elimination | None:
    """Eliminate the nodes. links: (m, 2) nodes from 0 to n - 1; weights: (m,), 0 or more; links that repeat add up.

    None when the net is so entangled that a rest of more than `largest` nodes is left.
    """
    order, start, used, other, weight, total, work = _eliminate(n, links, weights, DENSE)
    left = np.ones(n, np.bool_)
    left[0] = left[order] = False
    rest = np.flatnonzero(left)
    if len(rest) > largest:
        return None
    triangle = _matrix(n, rest, start, used, other, weight)
    if not factor(triangle):  # weights differ too much for differences, not for sums
        order, start, used, other, weight, total, work = _eliminate(n, links, weights, 0)
        rest, triangle = rest[:0], np.zeros((0, 0))
    work += len(rest) ** 3 // DENSE_IS_QUICKER
    return Elimination(order, start, used, other, weight, total, rest, triangle, work)


class Elimination(NamedTuple):
    """A net of n nodes, eliminated: `start[v]` to `start[v] + used[v]` are v's neighbours when it was eliminated."""

    order: Ints  # the eliminated nodes, in order; node 0 is fixed and not among them
    start: Ints
    used: Ints
    other: Uints32  # unsigned: compiled code need not test for negative indices
    weight: Floats
    total: Floats  # (n,) sum of the weights, 0 for a node without links
    rest: Ints  # (k,) nodes of the dense rest
    triangle: Floats  # (k, k) Cholesky's factor of their matrix
    work: int  # how many products of weights it took, or what took as long

    def solve(self, asked: Floats) -> Floats:
        """x with sum over the links w (x_i - x_j) = asked_i at each node i but the first, whose x is 0; shape (n,) or (n, k).

        There is no such x for nodes that are not connected to the first by links.
        """
        out = np.array(asked, np.float64).reshape(len(asked), -1)
        _solve(self.order, self.start, self.used, self.other, self.weight, self.total, self.rest, self.triangle, out)
        return out.reshape(asked.shape)


@njit(cache=True, nogil=True)
def _eliminate(n: int, links: Ints, weights: Floats, dense: int) -> tuple[Any, ...]:
    other: Uints32
    start, room, used, other, weight, end = _net(n, links, weights)
    where = np.zeros(n, np.uint32)
    first, after, before = np.full(n + 1, -1), np.full(n, -1), np.full(n, -1)  # nodes by how many neighbours they have
    for v in range(n - 1, 0, -1):
        _put(v, used[v], first, after, before)
    order, total = np.zeros(n - 1, np.int64), np.zeros(n)
    fewest = work = 0
    for step in range(n - 1):
        while first[fewest] < 0:
            fewest += 1
        if fewest * dense >= n - 1 - step and n - 1 - step > dense:
            order = order[:step]
            break
        v: int = first[fewest]
        _take(v, fewest, first, after, before)
        order[step] = v
        mine, count = start[v], used[v]
        for p in range(mine, mine + count):
            total[v] += weight[p]
        work += count * count
        others, parts = other[mine : mine + count], weight[mine : mine + count]
        for p in range(mine, mine + count):
            a: int = other[p]
            if a == 0:
                continue
            had = used[a]
            _leave(a, v, start, used, other, weight)
            if used[a] + count > room[a]:
                room[a] = 2 * (used[a] + count)
                if end + room[a] > len(other):
                    other, weight = np.concatenate((other, np.empty_like(other))), np.concatenate((weight, weight))
                for k in range(used[a]):
                    other[end + k], weight[end + k] = other[start[a] + k], weight[start[a] + k]
                start[a] = end
                end += room[a]
            share = weight[p] / total[v]
            row = slice(start[a], start[a] + room[a])
            used[a] = _meet(a, others, parts, share, other[row], weight[row], used[a], where)
            if used[a] != had:
                _take(a, had, first, after, before)
                _put(a, used[a], first, after, before)
                fewest = min(fewest, used[a])
    return order, start, used, other[:end].copy(), weight[:end].copy(), total, work


@njit(cache=True, nogil=True)
def _net(n: int, links: Ints, weights: Floats) -> tuple[Ints, Ints, Ints, Uints32, Floats, int]:
    """Each node's neighbours in one arena: start, room and use of each block, neighbours, weights; and the arena's end."""
    start, room = np.zeros(n, np.int64), np.full(n, SPARE)
    for row in range(len(links)):
        room[links[row, 0]] += 1
        room[links[row, 1]] += 1
    end = 0
    for v in range(n):
        start[v] = end
        end += room[v]
    other, weight = np.empty(2 * end, np.uint32), np.empty(2 * end)
    used = np.zeros(n, np.int64)
    for row in range(len(links)):
        i, j = links[row, 0], links[row, 1]
        if i != j and weights[row] > 0.0:
            _join(i, j, weights[row], start, used, other, weight)
            _join(j, i, weights[row], start, used, other, weight)
    return start, room, used, other, weight, end


@njit(cache=True, nogil=True)
def _join(i: int, j: int, more: float, start: Ints, used: Ints, other: Uints32, weight: Floats) -> None:
    """Make j a neighbour of i, or add to the weight between them."""
    for q in range(start[i], start[i] + used[i]):
        if other[q] == j:
            weight[q] += more
            return
    other[start[i] + used[i]], weight[start[i] + used[i]] = j, more
    used[i] += 1


@njit(cache=True, nogil=True)
def _leave(i: int, j: int, start: Ints, used: Ints, other: Uints32, weight: Floats) -> None:
    """Remove j from the neighbours of i."""
    q, last = start[i], start[i] + used[i] - 1
    while other[q] != j:
        q += 1
    other[q], weight[q] = other[last], weight[last]
    used[i] = used[i] - 1


@njit(cache=True, nogil=True)
def _meet(
    a: int, others: Uints32, parts: Floats, share: float, own: Uints32, own_weight: Floats, count: int, where: Uints32
) -> int:
    """Make these others neighbours of a, too, with this share of their weights; returns how many neighbours a has now."""
    for q in range(count):
        where[own[q]] = q
    for k in range(len(others)):
        b = others[k]
        if b == a:
            continue
        q = where[b]
        if q < count and own[q] == b:
            own_weight[q] += share * parts[k]
        else:
            own[count], own_weight[count] = b, share * parts[k]
            count += 1
    return count


@njit(cache=True, nogil=True)
def _put(v: int, count: int, first: Ints, after: Ints, before: Ints) -> None:
    """Add v to the list of nodes with this many neighbours."""
    after[v], before[v] = first[count], -1
    if after[v] >= 0:
        before[after[v]] = v
    first[count] = v


@njit(cache=True, nogil=True)
def _take(v: int, count: int, first: Ints, after: Ints, before: Ints) -> None:
    if before[v] >= 0:
        after[before[v]] = after[v]
    else:
        first[count] = after[v]
    if after[v] >= 0:
        before[after[v]] = before[v]


@njit(cache=True, nogil=True)
def _matrix(n: int, rest: Ints, start: Ints, used: Ints, other: Uints32, weight: Floats) -> Floats:
    at = np.full(n, -1)
    for k in range(len(rest)):
        at[rest[k]] = k
    matrix = np.zeros((len(rest), len(rest)))
    for k in range(len(rest)):
        for q in range(start[rest[k]], start[rest[k]] + used[rest[k]]):
            matrix[k, k] += weight[q]
            if other[q] != 0:
                matrix[k, at[other[q]]] -= weight[q]
    return matrix


@njit(cache=True, nogil=True)
def factor(matrix: Floats) -> bool:
    """Cholesky's factor, block by block: the lower triangle becomes L with L L^T = matrix; False when a pivot is not positive.

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
def _factor_columns(matrix: Floats, first: int, end: int) -> bool:
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
def _solve(
    order: Ints, start: Ints, used: Ints, other: Uints32, weight: Floats, total: Floats, rest: Ints, triangle: Floats,
    out: Floats,
) -> None:  # fmt: skip
    for v in order:  # a node's right-hand side goes to the neighbours that it had when it was eliminated
        for q in range(start[v], start[v] + used[v]):
            share = weight[q] / total[v]
            for k in range(out.shape[1]):
                out[other[q], k] += share * out[v, k]
    out[0] = 0.0
    _solve_rows(triangle, rest, out)
    for v in order[::-1]:
        for k in range(out.shape[1]):
            moved = out[v, k] if total[v] > 0.0 else 0.0
            for q in range(start[v], start[v] + used[v]):
                moved += weight[q] * out[other[q], k]
            out[v, k] = moved / total[v] if total[v] > 0.0 else 0.0


@njit(cache=True, nogil=True)
def _solve_rows(triangle: Floats, rows: Ints, out: Floats) -> None:
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
