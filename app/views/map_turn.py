"""By how much the map has to be turned to lie as the office does: for whoever looks at both. The robot never learns it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.evaluation import Evaluation, alignment
from ratslam_core import ExperienceMap
from sim2d import Truth

SPREAD_M = 1.0  # of the way, root mean square around its middle: a shorter one hardly has a direction
CALM_RAD = math.radians(3.0)  # what lies more askew is turned again: a map that breathes does not make the plate swing


def map_turn(shown_rad: float | None, evaluation: Evaluation, experiences: ExperienceMap, truth: Truth) -> float:
    """The angle (rad) of the map's frame in the office's. `shown_rad`, what it was, for as long as that will do."""
    true, mapped, _ = evaluation.trajectories(experiences)
    if min(_spread(true), _spread(mapped)) >= SPREAD_M:
        return calm(shown_rad, alignment(mapped, true).heading_rad)
    made = evaluation.heading_at(0)
    if made is None:  # the brain came with its map: nobody saw where it began
        return calm(shown_rad, truth.heading_rad - experiences.robot.heading_rad)
    return calm(shown_rad, made - float(experiences.poses[0, 2]))


def calm(shown_rad: float | None, wanted_rad: float) -> float:
    """`shown_rad` itself while it is as good as `wanted_rad`."""
    if shown_rad is not None and abs(math.remainder(shown_rad - wanted_rad, math.tau)) <= CALM_RAD:
        return shown_rad
    return math.remainder(wanted_rad, math.tau)


def _spread(points: NDArray[np.float64]) -> float:
    return float(np.sqrt(points.var(axis=0).sum())) if len(points) else 0.0
