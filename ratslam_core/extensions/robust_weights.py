"""[ours] Robust weights: links that the map contradicts weigh less in its exact correction (`experience_map.robust`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
