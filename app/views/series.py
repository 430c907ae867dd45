"""Errors and counts over time, and the turn of the map. The longer the run, the less often they are sampled."""

from __future__ import annotations

import math

import numpy as np

from app.evaluation import Coverage
from app.session import Session
from app.views.arrays import frozen
from app.views.map_turn import map_turn
from web.messages import Series

SERIES_POINTS = 600
ERROR_POINTS = 1000


class RunSeries:
    """Call `watch` after each tick."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._samples: list[tuple[float, ...]] = []
        self._sample_every_s = 1.0
        self.error_map_m: float | None = None  # None without truth
        self.error_odometry_m: float | None = None
        self.coverage: float | None = None  # None without an office
        self._covered = Coverage()
        self.map_turn_rad = self._turn(None)
        self.series = Series(*(np.zeros(0) for _ in range(7)))
        self._sample()

    def watch(self) -> None:
        if self._session.time_s >= len(self._samples) * self._sample_every_s:
            self._sample()

    def _turn(self, shown_rad: float | None) -> float:
        session = self._session
        return map_turn(shown_rad, session.evaluation, session.brain.experience_map, session.truth)

    def _sample(self) -> None:
        """Add one point to the series. If there are too many, every other point is dropped."""
        session, brain = self._session, self._session.brain
        every = max(1, session.tick_count // ERROR_POINTS)
        errors = math.nan, math.nan
        if session.truth is not None:
            errors = self.error_map_m, self.error_odometry_m = session.evaluation.errors(brain.experience_map, every)
        if session.recording is None:
            self.coverage = self._covered.follow(session.simulator.free_space, session.evaluation.path)
        self.map_turn_rad = self._turn(self.map_turn_rad)
        views, experiences = len(brain.local_view), len(brain.experience_map)
        metres, radians = brain.experience_map.residual
        residual = 1000 * metres, 1000 * radians
        self._samples.append((session.time_s, *errors, views, experiences, *residual))
        if len(self._samples) > SERIES_POINTS:
            self._samples = self._samples[::2]
            self._sample_every_s *= 2
        self.series = Series(*frozen(np.array(self._samples, np.float64).T.copy()))
