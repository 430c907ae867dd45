"""Map correction: moves experiences until links and map agree. ACRA 2005 equations 12-14, ACRA 2006 section 3.3."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.pose_graph.pose_graph import PoseGraph, disagreement, wrapped
from ratslam_core.pose_graph.transitions import Adjacency
from ratslam_core.solvers.laplacian import eliminate
from ratslam_core.types import Flags, Floats, Ints, Uints32

DIVERGED = 10.0  # times the length of all links together: where no map that fits them puts an experience
LARGEST = 4000  # experiences in a densely linked core; a map with more is left to the sweeps: 4,000 take 2 s and 250 MB
WORK_AN_EXPERIENCE = 90.0  # that each adds to an exact correction
ENTANGLED_WORK = 1e9  # that an attempt at too large a map counts as, so that the next one comes late
ROUNDS = 2  # how often headings are solved, so that their wrapping settles
LEAST_STRENGTH = 1e-9  # below it, only rounding tells a bias from a bend in the way


@kind("relaxation/2")
class Relaxation:
    """The papers' way: a fixed number of sweeps in every step."""

    def correct(self, graph: PoseGraph) -> None:
        """One step of map correction. test_relaxation_sweep.py::test_a_sweep_never_raises_the_residual."""
        t, p, poses = graph.transitions, graph.params, graph.poses
        ends, moves = t.ends[: t.count], t.move[: t.count]
        for _ in range(p.sweeps):
            if p.sweep == "by link":
                sweep_by_link(poses, t.graph, ends, moves, t.travelled, p.correction)
            elif p.sweep == "all at once":
                ways = t.travelled[: t.count]
                sweep_all_at_once(poses, ends[ways], moves[ways], p.correction)
            else:
                sweep(poses, t.graph, moves, t.believed, p.correction)


def sweep(poses: Floats, graph: Adjacency, moves: Floats, weights: Floats, alpha: float) -> None:
    """One sweep, in place: each experience but the first is moved by 2 alpha times the weighted mean residual of its links.

    Experiences are moved one after the other (Gauss-Seidel), place and heading together; places use the headings from
    before the sweep. Only rows that are in `graph` count.
    """
    _sweep(poses, graph.start, graph.used, graph.half, graph.other, moves, weights, 2 * alpha)


@njit(cache=True, nogil=True)
def _sweep(
    poses: Floats,
    start: Uints32,
    used: Uints32,
    halves: Uints32,
    others: Uints32,
    moves: Floats,
    weights: Floats,
    gain: float,
) -> None:
    """dx_i, dy_i, dth_i = gain times the weighted sum of the links' residuals over the sum of the weights. B eqs. 12-14."""
    n, one = np.uint64(poses.shape[0]), np.uint64(1)
    c, s = _facings(poses)
    for i in range(one, n):
        x, y, heading = poses[i, 0], poses[i, 1], poses[i, 2]
        dx = dy = turn = total = 0.0
        block = np.uint64(start[i])
        for at in range(block, block + np.uint64(used[i])):
            half, other = np.uint64(halves[at]), np.uint64(others[at])
            row, ends_here = half >> one, half & one
            sign, begin = (1.0, other) if ends_here else (-1.0, i)
            ahead, aside = moves[row, 0], moves[row, 1]
            w = weights[row]
            dx += w * (poses[other, 0] + (sign * (c[begin] * ahead - s[begin] * aside) - x))
            dy += w * (poses[other, 1] + (sign * (s[begin] * ahead + c[begin] * aside) - y))
            turn += w * wrapped(poses[other, 2] + (sign * moves[row, 2] - heading))
            total += w
        if total > 0.0:
            share = gain / total
            poses[i, 0] = x + share * dx
            poses[i, 1] = y + share * dy
            poses[i, 2] = wrapped(heading + share * turn)


def sweep_by_link(poses: Floats, graph: Adjacency, links: Ints, moves: Floats, travelled: Flags, alpha: float) -> None:
    """One sweep, in place: each experience but the first is moved by alpha times the residual of each of its links in turn.

    ACRA 2005 eqs. 12-14 may also be read as all links at once: `sweep_all_at_once`. Places use the headings from before
    the sweep.
    test_papers.py::test_a_biased_loop_is_corrected_as_in_the_twin.
    """
    ends = links.view(np.uint64)[: len(moves)]
    _sweep_by_link(poses, graph.start, graph.used, graph.half, graph.other, ends, moves, travelled, alpha)


@njit(cache=True, nogil=True)
def _sweep_by_link(
    poses: Floats, start: Uints32, used: Uints32, halves: Uints32, others: Uints32, ends: NDArray[np.uint64], moves: Floats,
    travelled: Flags, alpha: float,
) -> None:  # fmt: skip
    turned = _turned(poses, ends, moves)
    for i in range(1, poses.shape[0]):
        block = np.uint64(start[i])
        for at in range(block, block + np.uint64(used[i])):
            half, other = np.uint64(halves[at]), np.uint64(others[at])
            row = half >> np.uint64(1)
            if travelled[row]:
                sign = 1.0 if half & np.uint64(1) else -1.0
                poses[i, 0] += alpha * (poses[other, 0] + sign * turned[row, 0] - poses[i, 0])
                poses[i, 1] += alpha * (poses[other, 1] + sign * turned[row, 1] - poses[i, 1])
                turn = wrapped(poses[other, 2] + sign * moves[row, 2] - poses[i, 2])
                poses[i, 2] = wrapped(poses[i, 2] + alpha * turn)


def sweep_all_at_once(poses: Floats, links: Ints, moves: Floats, alpha: float) -> None:
    """One sweep as ACRA 2005 eqs. 12-14 print it, in place: all experiences but the first are moved at once, each by alpha
    times the sum of the residuals of its links.

    It diverges where alpha times the largest eigenvalue of the graph's Laplacian is above 2; with 0.5, mostly where more than two
    links meet. [ours] A map that has diverged is left as it is unless the sweep brings it together, so that all numbers
    stay finite. test_sweep_all_at_once.py.
    """
    n = len(poses)
    off = np.ascontiguousarray(disagreement(poses, links, moves).T)
    swept = poses.copy()
    swept[1:] += alpha * np.stack([_asked(n, links, errors) for errors in off], axis=1)[1:]
    if not has_diverged(poses, moves) or _reach(swept) < _reach(poses):
        swept[:, 2] -= 2 * math.pi * np.round(swept[:, 2] / (2 * math.pi))
        poses[:] = swept


def has_diverged(poses: Floats, moves: Floats) -> bool:
    """Whether an experience lies farther from the first than DIVERGED times the length of all links together."""
    return _reach(poses) > DIVERGED * float(np.hypot(moves[:, 0], moves[:, 1]).sum())


def _reach(poses: Floats) -> float:
    return float(np.hypot(*(poses[:, :2] - poses[:1, :2]).T).max(initial=0.0))


@njit(cache=True, nogil=True, error_model="numpy")
def _turned(poses: Floats, ends: NDArray[np.uint64], moves: Floats) -> Floats:
    """Moves in the map's frame: (dx, dy) of each row turned by the heading of where it begins."""
    c, s = _facings(poses)
    m = np.uint64(moves.shape[0])
    turned = np.empty((m, 2))
    for row in range(m):
        i = ends[row, 0]
        turned[row, 0] = c[i] * moves[row, 0] - s[i] * moves[row, 1]
        turned[row, 1] = s[i] * moves[row, 0] + c[i] * moves[row, 1]
    return turned


@njit(cache=True, nogil=True, error_model="numpy")
def _facings(poses: Floats) -> tuple[Floats, Floats]:
    """Cosine and sine of every heading."""
    n = np.uint64(poses.shape[0])
    c, s = np.empty(n), np.empty(n)
    for i in range(n):
        c[i] = poses[i, 2]
    for i in range(n):  # a loop of its own, so that the compiler computes four at a time
        c[i], s[i] = _facing(c[i])
    return c, s


@njit(cache=True, nogil=True, inline="always")
def _facing(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle in [-pi, pi] to 1e-14: Taylor series of a quarter of it, doubled twice."""
    q = angle * 0.25
    z = q * q
    s = 1 - z * (1 / 110) * (1 - z * (1 / 156) * (1 - z * (1 / 210)))
    s = 1 - z * (1 / 6) * (1 - z * (1 / 20) * (1 - z * (1 / 42) * (1 - z * (1 / 72) * s)))
    c = 1 - z * (1 / 90) * (1 - z * (1 / 132) * (1 - z * (1 / 182)))
    c = 1 - z * (1 / 2) * (1 - z * (1 / 12) * (1 - z * (1 / 30) * (1 - z * (1 / 56) * c)))
    s *= q
    s, c = 2 * s * c, 1 - 2 * s * s
    return 1 - 2 * s * s, 2 * s * c


class Solution(NamedTuple):
    """The outcome of an exact correction."""

    bias: float  # of the yaw rate, rad/s, that the loops show beyond the bias that is known
    work: float  # how much was computed; 100,000 take about half a millisecond


def solve(
    poses: Floats,
    links: Ints,
    moves: Floats,
    weights: Floats,
    turning_s: Floats | None = None,
    known: float = 0.0,
    doubt: float = 0.0,
    *,
    rounds: int = ROUNDS,
    largest: int = LARGEST,
) -> Solution:
    """The fixed point of the sweeps, in place: headings, then positions, each a sparse Laplacian with the first node fixed.

    known: the bias (rad/s) that the moves are already without; doubt: how strongly it is expected to be 0 in all, as a
    weight times s^2. One short loop tells little of the bias, many long ones much. A map that is too entangled is left
    to the sweeps. Every experience must be connected to the first by links. Headings are a linear problem once their
    residuals are wrapped; `rounds` solutions let the wrapping settle.
    """
    n = len(poses)
    if n < 2 or len(links) == 0:
        return Solution(0.0, 0.0)
    i, j = links[:, 0], links[:, 1]
    net = eliminate(n, links, weights, largest)
    if net is None:
        return Solution(0.0, ENTANGLED_WORK)
    seconds = np.zeros(len(links)) if turning_s is None else turning_s
    drift = net.solve(_asked(n, links, weights * seconds))  # how a bias of 1 rad/s would bend the headings
    unexplained = seconds - drift[j] + drift[i]
    strength = float(np.sum(weights * seconds * unexplained))
    bias = 0.0
    for _ in range(rounds):
        error: Floats = poses[i, 2] + moves[:, 2] - bias * seconds - poses[j, 2]
        error -= 2 * math.pi * np.round(error / (2 * math.pi))
        shown = float(np.sum(weights * unexplained * error)) - doubt * (known + bias)
        more = shown / (strength + doubt) if strength > LEAST_STRENGTH else 0.0
        bias += more
        poses[:, 2] += net.solve(_asked(n, links, weights * (error - more * seconds)))
    poses[:, 2] -= 2 * math.pi * np.round(poses[:, 2] / (2 * math.pi))
    off = weights[:, None] * disagreement(poses, links, moves)[:, :2]
    across, up = np.ascontiguousarray(off.T)
    poses[:, :2] += net.solve(np.stack([_asked(n, links, across), _asked(n, links, up)], axis=1))
    return Solution(bias, net.work + WORK_AN_EXPERIENCE * n)


@njit(cache=True, nogil=True)
def _asked(n: int, links: Ints, errors: Floats) -> Floats:
    """How far the links ask each experience to move, in sum: each moves its end by its error, its beginning by minus that."""
    asked = np.zeros(n)
    for row in range(len(links)):
        asked[links[row, 0]] -= errors[row]
        asked[links[row, 1]] += errors[row]
    return asked
