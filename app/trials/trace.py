"""What the figures need of a trial that is not kept with its scores: it is run again and written down here."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.evaluation.alignment import align, alignment, rmse
from app.trials.course import Course, Moment
from app.trials.measures import MEASURES
from app.trials.trial import Trial, watched
from ratslam_core import Pose2

_Array = NDArray[np.float64]
EVERY_S = 0.5  # between two rows
ERROR_EVERY_S = 15.0  # between two looks at the whole map
MOST_PACKETS = 4


@dataclass(slots=True)
class Trace:
    """One trial, written down. Lengths in metres, angles in rad, times in s; n rows, one each `EVERY_S`."""

    trial: Trial
    course: Course  # at its end
    time_s: _Array  # (n,)
    truth: _Array  # (n, 3) true x, y, heading, office frame
    cells: _Array  # (n, 3) the winning packet: x, y in cells, heading in rad
    mass: _Array  # (n, 4) activity of the strongest packets
    off_m: _Array  # (n,) between the robot and where it believes itself to be; NaN where that has no meaning
    jumped: NDArray[np.bool_]  # (n,) the packet has jumped since the row before
    active: NDArray[np.int64]  # (n,) experience
    views: NDArray[np.int64]  # (n,) recruited so far
    residual: _Array  # (n,) mean disagreement of map and links, m
    error_time_s: _Array  # (k,)
    error_m: _Array  # (k,) of the whole map so far
    moments: list[Moment]

    @property
    def map_in_office(self) -> Pose2:
        """The pose of the map's frame in the office that fits the whole path best."""
        evaluation, map_ = self.course.session.evaluation, self.course.session.brain.experience_map
        truth, mapped, _ = evaluation.trajectories(map_, every=5)
        return alignment(mapped, truth)

    @property
    def mapped_path(self) -> _Array:
        """The robot's path as its map tells it at the end, laid over the office; (m, 2)."""
        evaluation, map_ = self.course.session.evaluation, self.course.session.brain.experience_map
        truth, mapped, _ = evaluation.trajectories(map_, every=5)
        return align(mapped, truth)

    @property
    def odometry_path(self) -> _Array:
        """The path by odometry alone, laid so that it begins where the robot began; (m, 2)."""
        evaluation = self.course.session.evaluation
        _, _, odometry = evaluation.trajectories(self.course.session.brain.experience_map, every=5)
        x, y, heading = self.truth[0]
        c, s = math.cos(heading), math.sin(heading)
        return odometry @ np.array([[c, s], [-s, c]]) + (x, y)


class _Recorder:
    def __init__(self, course: Course) -> None:
        self.course = course
        self.rows: list[tuple[float, ...]] = []
        self.errors: list[tuple[float, float]] = []
        self._row_s = self._error_s = 0.0
        self._snaps = 0

    def note(self) -> None:
        session = self.course.session
        if session.time_s < self._row_s - 1e-9:
            return
        self._row_s += EVERY_S
        brain, truth = session.brain, session.simulator.truth
        map_, winner = brain.experience_map, brain.pose_cells.winner
        mass = [packet.mass for packet in brain.pose_cells.packets[:MOST_PACKETS]]
        mass += [0.0] * (MOST_PACKETS - len(mass))
        off_m = session.evaluation.belief_off(truth, map_)[0]
        jumped, self._snaps = brain.relocalisations > self._snaps, brain.relocalisations
        self.rows.append((
            session.time_s, truth.x, truth.y, truth.heading_rad, winner.x, winner.y, winner.heading_rad, *mass, off_m, jumped,
            map_.active, len(brain.local_view), map_.residual[0],
        ))  # fmt: skip
        if session.time_s >= self._error_s - 1e-9:
            self._error_s += ERROR_EVERY_S
            path, mapped, _ = session.evaluation.trajectories(map_, every=10)
            self.errors.append((session.time_s, rmse(mapped, path)))

    def scores(self) -> dict[str, float]:
        return {}


def trace_of(trial: Trial) -> Trace:
    """Run a trial again and write it down. The run is the same, bit for bit, as without."""
    course = trial.begin()
    recorder = _Recorder(course)
    watched(course, [*(MEASURES[name](course) for name in trial.measures), recorder])
    rows, errors = np.array(recorder.rows, np.float64), np.array(recorder.errors, np.float64)
    return Trace(
        trial, course, rows[:, 0], rows[:, 1:4], rows[:, 4:7], rows[:, 7:11], rows[:, 11], rows[:, 12].astype(np.bool_),
        rows[:, 13].astype(np.int64), rows[:, 14].astype(np.int64), rows[:, 15], errors[:, 0], errors[:, 1], course.moments,
    )  # fmt: skip
