"""The local movements among which the robot chose: every arc that it tried, which were free, and what each would cost.

ACRA 2006 4.3, figure 4. For people who look; the robot itself needs only the best (`LocalMovement.towards`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.pilot import local_movement as arcs
from app.pilot.local_movement import Choice


@dataclass(frozen=True, slots=True)
class Candidates:
    """n arcs in the frame of the robot that tried them, in the order in which it did."""

    paths: NDArray[
        np.float64
    ]  # (n, steps + 1, 2): m, from the robot's middle to where the arc ends; one point if it only turns
    turned_rad: NDArray[np.float64]  # (n,) between beginning and end
    length_m: NDArray[np.float64]  # (n,) of each path
    speed: NDArray[np.float64]  # (n,) m/s; 0 for a turn on the spot
    yaw_rate: NDArray[np.float64]  # (n,) rad/s
    cost: NDArray[np.float64]  # (n,) m; inf where an echo is too close

    @property
    def chosen(self) -> int:
        """The first of the cheapest, as the robot chooses."""
        return int(np.argmin(self.cost))


def candidates(echoes: NDArray[np.float64], x: float, y: float, p: Choice) -> Candidates:
    """All that `LocalMovement.towards` tries on the way to (x, y), with the same numbers.

    echoes: (n, 2) m, robot's frame. test_candidates.py::test_the_cheapest_candidate_is_the_one_that_was_chosen.
    """
    near, facing = arcs.within(echoes, p.speed * p.arc_s + p.clearance + 2 * p.narrow_m, p), arcs.facing_of(p)
    rows: list[tuple[float, float, float, float]] = []
    paths: list[NDArray[np.float64]] = []
    for share in (1.0, p.medium, p.slow, 0.0):
        v = p.speed * share
        for wi in range(-p.arcs, p.arcs + 1):
            if v == 0.0 and abs(wi) < p.spot * p.arcs:
                continue
            w, step = p.turn_rate * wi / p.arcs, v * (p.arc_s / p.steps)
            px, py, nearest, free = 0.0, 0.0, np.inf, True
            if v > 0.0:
                px, py, nearest, free = arcs.along(near, step, facing[wi + p.arcs], p)
            turned = w * (p.arc_s if v > 0.0 else p.spot_s)
            rows.append((turned, v, w, arcs.cost_of(x, y, px, py, turned, nearest, p) if free else np.inf))
            paths.append(np.vstack([np.zeros((1, 2)), np.cumsum(step * facing[wi + p.arcs], axis=0)]))
    turned_rad, speed, yaw_rate, cost = np.array(rows).T
    return Candidates(np.array(paths), turned_rad, speed * p.arc_s, speed, yaw_rate, cost)
