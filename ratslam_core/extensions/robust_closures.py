"""[ours] Robust weights: links that the map contradicts weigh less in its exact correction (`experience_map.robust`).

[ours] Closures that no map can bring together with the others are given up, by graduated non-convexity.

Odometry between experiences made one after the other is sure; every other row rests on a look and may be false. At first
all of them count. Then, round by round, those that the map contradicts count less, in the beginning gently, in the end
wholly or not at all (truncated least squares). So many false closures are found out together; and since each solution
asks all of them anew, one that was believed for a while is let go when others contradict it, and one that was given up
counts again when they agree. Yang, Antonante, Tzoumas and Carlone, RA-L 2020, eqs. 12-14.
test_graduated_trust.py::test_false_closures_are_found_out. With `experience_map.robust` off nothing is given up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ratslam_core.pose_graph import relaxation
from ratslam_core.pose_graph.pose_graph import STEP_SIGMA, TURN_CELLS, disagreement

ODOMETRY_GIVES = 5.0  # sigma of disagreement at which odometry counts half
LOOK_GIVES = 1.0  # from so many on a look pulls no harder


def trust(
    poses: NDArray[np.float64],
    links: NDArray[np.int64],
    moves: NDArray[np.float64],
    weights: NDArray[np.float64],
    chain: NDArray[np.bool_],
    cell_m: float,
) -> NDArray[np.float64]:
    """[ours] How far each link is believed, 0 to 1, given how well the map fits it.

    weights: STEP_SIGMA^2 / variance; cell_m: side of a cell of the pose cells; chain: rows of odometry, the others are
    looks. The pull of a look stops growing with its error (Huber). Odometry cannot be far off, so its pull even falls
    (Cauchy). Many looks that agree thus tear the one link along which the robot was carried, and a single look does not.
    test_relaxation_trust.py::test_many_looks_tear_the_link_of_a_kidnap.
    """
    ex, ey, turn = disagreement(poses, links, moves).T
    rad_per_m, sigma_m = TURN_CELLS / cell_m, STEP_SIGMA * cell_m
    chi: NDArray[np.float64] = np.sqrt(weights * (ex**2 + ey**2 + (turn / rad_per_m) ** 2)) / sigma_m
    return np.where(
        chain, 1 / (1 + (chi / ODOMETRY_GIVES) ** 2), np.minimum(1, LOOK_GIVES / np.maximum(chi, LOOK_GIVES))
    )


SIGMA = 0.6  # cells: least error that a closure is taken to have
BAR = 9.0  # sigma squared; a closure that is farther off is given up
GROWTH = 1.4  # how much more strictly each round judges than the one before
MOST_ROUNDS = 100
DECIDED = 0.01  # a share this near to 0 or 1 no longer changes


def kept(
    poses: NDArray[np.float64],
    ends: NDArray[np.int64],
    moves: NDArray[np.float64],
    weights: NDArray[np.float64],
    sure: NDArray[np.bool_],
    cell_m: float,
) -> tuple[NDArray[np.float64], float]:
    """How far each row is kept, 0 to 1, and the work. `poses` are changed in place, and fit the rows that are kept.

    weights: STEP_SIGMA^2 / variance; cell_m: side of a cell of the pose cells; sure: rows that are never doubted.
    """
    rows = np.flatnonzero(~sure & (weights > 0.0))
    share = np.ones(len(weights))
    work = relaxation.solve(poses, ends, moves, weights, None).work
    chi = contradiction(poses, ends, moves, weights, rows, cell_m)
    mu = 1.0 / max(2.0 * chi.max(initial=0.0) - 1.0, 1e-9)
    for _ in range(MOST_ROUNDS):
        share[rows] = np.clip(np.sqrt(mu * (mu + 1.0) / np.maximum(chi, 1e-12)) - mu, 0.0, 1.0)
        work += relaxation.solve(poses, ends, moves, weights * share, None).work
        chi = contradiction(poses, ends, moves, weights, rows, cell_m)
        if not ((share[rows] > DECIDED) & (share[rows] < 1.0 - DECIDED)).any():
            break
        mu *= GROWTH
    return share, work


def contradiction(
    poses: NDArray[np.float64],
    ends: NDArray[np.int64],
    moves: NDArray[np.float64],
    weights: NDArray[np.float64],
    rows: NDArray[np.intp],
    cell_m: float,
) -> NDArray[np.float64]:
    """How far the map contradicts each of these rows, as a share of the bar: a row above 1 is one to give up."""
    ex, ey, turn = disagreement(poses, ends[rows], moves[rows]).T
    variance = (STEP_SIGMA * cell_m) ** 2 / weights[rows] + (SIGMA * cell_m) ** 2
    return (ex**2 + ey**2 + (turn * cell_m / TURN_CELLS) ** 2) / variance / BAR
