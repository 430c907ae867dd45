"""One attractor iteration in its three stages, for people to look at: excitation, inhibition, normalisation. ACRA 2004
eqs. 10-12.

The engine computes all three at once and skips cells that inhibition would silence. This computes the same sum, slowly.
`test_tick_stages.py::test_the_stages_lead_where_the_engine_went` compares the two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ratslam_core import PoseCellParams
from ratslam_core.pose_cells.attractor_kernels import gaussian


@dataclass(frozen=True)
class Activity:
    """Active pose cells: flat indices (n,), ascending, and their activities (n,)."""

    flat: NDArray[np.int64]
    values: NDArray[np.float64]

    @property
    def total(self) -> float:
        return float(self.values.sum())


def excited(activity: Activity, params: PoseCellParams) -> Activity:
    """Every cell excites its neighbours on the torus."""
    return _spread(activity, params, gaussian(params.excite_sigma))


def inhibited(activity: Activity, params: PoseCellParams) -> Activity:
    """The same amount is subtracted from every cell. A cell that falls to 0 or below becomes silent."""
    values = activity.values - params.inhibit
    alive = values > 0
    return Activity(activity.flat[alive], values[alive])


def normalised(activity: Activity) -> Activity:
    return Activity(activity.flat, activity.values / activity.total)


def _spread(activity: Activity, params: PoseCellParams, weights: NDArray[np.float32]) -> Activity:
    """Convolution along theta', then y', then x', over the active cells only."""
    n_theta, n_y, n_x = shape = params.n_theta, params.n_y, params.n_x
    reach = np.arange(len(weights)) - len(weights) // 2
    for axis, size in enumerate((n_theta, n_y, n_x)):
        places = np.stack(np.unravel_index(activity.flat, shape))
        moved = np.repeat(places, len(reach), 1)
        moved[axis] = (moved[axis] + np.tile(reach, len(activity.flat))) % size
        flat, row = np.unique(np.ravel_multi_index(tuple(moved), shape), return_inverse=True)
        parts = (activity.values[:, None] * weights.astype(np.float64)).ravel()
        activity = Activity(flat, np.asarray(np.bincount(row.ravel(), parts, len(flat)), np.float64))
    return activity
