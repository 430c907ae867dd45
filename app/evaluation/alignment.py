"""The rigid alignment of an estimate with the truth, and the error that remains."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ratslam_core import Pose2


def alignment(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> Pose2:
    """The pose of the estimate's frame in the true frame that fits (n, 2) points best. Umeyama 1991, in SE(2)."""
    mean_e, mean_t = estimate.mean(axis=0), truth.mean(axis=0)
    e, t = estimate - mean_e, truth - mean_t
    angle = math.atan2(float(np.sum(e[:, 0] * t[:, 1] - e[:, 1] * t[:, 0])), float(np.sum(e * t)))
    turned = Pose2(0.0, 0.0, angle).compose(Pose2(float(mean_e[0]), float(mean_e[1]), 0.0))
    return Pose2(float(mean_t[0]) - turned.x, float(mean_t[1]) - turned.y, angle)


def align(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.float64]:
    """`estimate` (n, 2), rotated and translated (not scaled) to fit `truth` best."""
    frame = alignment(estimate, truth)
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return estimate @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


def rmse(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """Root mean square distance (m) of two paths, (n, 2) each, after alignment; 0 for fewer than two points."""
    if len(estimate) < 2:
        return 0.0
    off: NDArray[np.float64] = align(estimate, truth) - truth
    squares: NDArray[np.float64] = np.square(off).sum(axis=1)
    return float(np.sqrt(np.mean(squares)))
