"""How near to the route the chosen local movement ends, beside those that were free and not chosen. D 4.3, figure 4."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from app.trials.course import Course


class Arbitration:
    """Looks once a second while the robot follows a route: how far from the route's next point each movement ends, m."""

    EVERY_S = 1.0

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._due_s = 0.0
        self._chosen_m: list[float] = []
        self._others_m: list[float] = []

    def note(self) -> None:
        session = self._session
        state = session.pilot.goal_state
        if state is None or state[1] != "tracking" or session.time_s < self._due_s:
            return
        self._due_s = session.time_s + self.EVERY_S
        look, aim = session.pilot.look_at_choice(), session.pilot.aim
        if look is None or aim is None:
            return
        tried = look()
        ends = tried.paths[:, -1]
        away = np.hypot(ends[:, 0] - aim[0], ends[:, 1] - aim[1])
        free = np.isfinite(tried.cost) & (tried.speed > 0)
        if not free.any() or not free[tried.chosen]:
            return
        self._chosen_m.append(float(away[tried.chosen]))
        free[tried.chosen] = False
        self._others_m.extend(away[free].tolist())

    def scores(self) -> dict[str, float]:
        if not (self._chosen_m and self._others_m):
            return {}
        chosen, others = math.fsum(self._chosen_m), math.fsum(self._others_m)
        return {"chosen_off_m": chosen / len(self._chosen_m), "others_off_m": others / len(self._others_m)}
