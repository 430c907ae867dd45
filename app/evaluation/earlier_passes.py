"""Consistency over time, as in ACRA 2004, 6.5: the estimate here against the estimates of earlier passes through here."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ratslam_core import Pose2

AWAY_M = 2.0  # an earlier pass ended when the robot was this far away
HERE_M, HERE_RAD = 0.5, 0.6  # a pass that came this near, facing the same way, went through here
EVERY = 5  # rows; at 10 Hz and 0.3 m/s, one in 0.15 m


def off_earlier_passes(
    true: NDArray[np.float64], estimated: NDArray[np.float64], here: Pose2, estimate: Pose2
) -> tuple[float, float]:
    """How far (m, rad) the estimate is from those of half of the earlier passes, at least. NaN where there was none.

    true, estimated: the robot's poses so far, thinned, (n, 3) each, m and rad, of which each is the other's at the same time.
    The estimates need not be Cartesian: only the short way from where an earlier pass was counts as straight. Half, since
    among many passes one agrees by chance, and a place may have two representations.
    """
    apart = np.hypot(true[:, 0] - here.x, true[:, 1] - here.y)
    away = np.flatnonzero(apart > AWAY_M)
    passed = slice(0, away[-1] if len(away) else 0)
    turned = np.abs(np.remainder(true[passed, 2] - here.heading_rad + np.pi, 2 * np.pi) - np.pi)
    passes = np.flatnonzero((apart[passed] < HERE_M) & (turned < HERE_RAD))
    if not len(passes):
        return math.nan, math.nan
    then = true[passes]
    turn = estimated[passes, 2] - then[:, 2]
    dx, dy = here.x - then[:, 0], here.y - then[:, 1]
    x = estimated[passes, 0] + np.cos(turn) * dx - np.sin(turn) * dy
    y = estimated[passes, 1] + np.sin(turn) * dx + np.cos(turn) * dy
    off = np.hypot(x - estimate.x, y - estimate.y)
    half = int(np.argsort(off, kind="stable")[(len(off) - 1) // 2])
    facing = estimate.heading_rad - here.heading_rad - float(turn[half])
    return float(off[half]), abs(math.remainder(facing, math.tau))


def off_same_estimate(
    true: NDArray[np.float64], estimated: NDArray[np.float64], here: Pose2, estimate: Pose2
) -> tuple[float, float]:
    """How far (m, rad) the robot is from the place that its estimate stands for: where it truly was when its estimate was
    nearest to what it is now. NaN where it never was near.

    true, estimated: as for `off_earlier_passes`.
    """
    apart = np.hypot(estimated[:, 0] - estimate.x, estimated[:, 1] - estimate.y)
    turned = np.abs(np.remainder(estimated[:, 2] - estimate.heading_rad + np.pi, 2 * np.pi) - np.pi)
    alike = np.flatnonzero((apart < HERE_M) & (turned < HERE_RAD))
    if not len(alike):
        return math.nan, math.nan
    then = alike[np.argmin(apart[alike])]
    moved = Pose2(*estimated[then].tolist()).inverse().compose(estimate)
    stands_for = Pose2(*true[then].tolist()).compose(moved)
    turn = abs(math.remainder(stands_for.heading_rad - here.heading_rad, math.tau))
    return math.hypot(stands_for.x - here.x, stands_for.y - here.y), turn
