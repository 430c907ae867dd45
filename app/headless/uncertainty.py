"""How sure the robot is of its place, and whether it is right to be."""

from __future__ import annotations

import math
from array import array
from typing import Any

import numpy as np

from app.session import Session

EVERY = 10  # ticks


class Uncertainty:
    """Call `note` after each tick."""

    def __init__(self) -> None:
        self._sigma_m, self._off_m = array("d"), array("d")
        self._ticks = self._lost = 0

    def note(self, session: Session) -> None:
        self._ticks += 1
        self._lost += session.brain.lost
        sigma_m = session.brain.experience_map.off_m
        if not math.isfinite(sigma_m) or session.brain.carried or session.tick_count % EVERY:
            return
        self._sigma_m.append(sigma_m)
        self._off_m.append(session.evaluation.belief_off(session.simulator.truth, session.brain.experience_map)[0])

    def report(self) -> dict[str, Any]:
        """The robot's own sigma (m) while it was not lost, and the share of the time in which it was right to two
        sigma; None without a belief that has one. And the share of the ticks in which it held itself to be lost."""
        sigma, off = np.array(self._sigma_m), np.array(self._off_m)
        judged = np.isfinite(off)
        right = float(np.mean(off[judged] <= 2 * sigma[judged])) if judged.any() else math.nan
        return {
            "median_m": _rounded(float(np.median(sigma))) if sigma.size else None,
            "most_m": _rounded(float(sigma.max())) if sigma.size else None,
            "within_two_sigma": _rounded(right),
            "lost_share": _rounded(self._lost / max(self._ticks, 1)),
        }


def _rounded(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None
