"""Errors and counts over time, and the turn of the map. The longer the run, the less often they are sampled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.evaluation import Coverage
from app.session import Session
from app.views.arrays import frozen
from app.views.map_turn import map_turn
from disk import kind
from ratslam_core import Pose2
from web.messages import Series

SERIES_POINTS = 600
ERROR_POINTS = 1000


@kind("run_series/1")
class RunSeries:
    """Call `watch` after each tick."""

    CACHES = ("_session", "series")

    def __init__(self, session: Session) -> None:
        self._session = session
        self._samples: NDArray[np.float64] = np.zeros((0, 7))
        self._sample_every_s = 1.0
        self.error_map_m: float | None = None  # None without truth
        self.error_odometry_m: float | None = None
        self.map_in_office: Pose2 | None = None  # None without truth
        self.coverage: float | None = None  # None without an office
        self._covered = Coverage()
        self.map_turn_rad = self._turn(None)
        self.series = self._shown()
        self._sample()

    def settle(self, session: Session) -> None:
        """Go on in a history that was restored."""
        self._session = session
        if session.recording is None:
            self._covered.settle(session.simulator.free_space)
        self.series = self._shown()

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
            self.map_in_office = session.evaluation.map_in_office(brain.experience_map, every)
        if session.recording is None:
            self.coverage = self._covered.follow(session.simulator.free_space, session.evaluation.path)
        self.map_turn_rad = self._turn(self.map_turn_rad)
        views, experiences = len(brain.local_view), len(brain.experience_map)
        metres, radians = brain.experience_map.residual
        residual = 1000 * metres, 1000 * radians
        sample = session.time_s, *errors, views, experiences, *residual
        self._samples = np.vstack([self._samples, sample])
        if len(self._samples) > SERIES_POINTS:
            self._samples = self._samples[::2]
            self._sample_every_s *= 2
        self.series = self._shown()

    def _shown(self) -> Series:
        return Series(*frozen(self._samples.T.copy()))
