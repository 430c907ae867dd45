"""What has happened in a run so far, for people to look at. It watches the session and never changes it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.companion import Companion
from app.evaluation import Coverage
from app.session import Session
from app.views.arrays import frozen, map_turn
from app.views.events import EventLog, EventWatch
from disk import kind
from ratslam_core import Packet, Pose2
from web.messages import Series, Snap, Times

TRAIL_S = 120.0  # of driving
RECORDED_S = 1800.0  # of a recording with truth, which has no office beside its true path
STILL_M, STILL_CELLS = 0.005, 0.02  # smaller movements add no point


@kind("history/1")
class History:
    """Call `watch` after each tick."""

    CACHES = ("log", "_session")

    def __init__(self, session: Session) -> None:
        self._session, self.log = session, EventLog(session)
        self.events = EventWatch(session, self.log)
        self.trails, self.visits, self.series = Trails(session), VisitLog(session), RunSeries(session)
        self.beside: BesideHistory | None = None  # of the second brain, while there is one

    def settle(self, session: Session, log: EventLog, last_snap: Snap | None) -> None:
        """Go on in a history that was restored with this session. Its events are noted in this log."""
        self._session, self.log = session, log
        if self.beside is not None:
            self.beside.settle()
        self.events.settle(session, log, last_snap)
        for part in (self.trails, self.visits, self.series):
            part.settle(session)

    def watch(self) -> None:
        self.log.of_tick = True
        for part in (self.trails, self.visits, self.events, self.series):
            part.watch()
        self.watch_companion()
        if self.beside is not None:
            self.beside.watch(self._session)
        self.log.of_tick = False

    def watch_companion(self) -> None:
        """To be called when there is another second brain, too, so that it is shown before the next tick."""
        companion = self._session.companion
        if companion is None:
            self.beside = None
        elif self.beside is None or self.beside.of is not companion:
            self.beside = BesideHistory(self._session, companion)


@kind("trails/1")
class Trails:
    """The recent paths of the robot (true) and of the winning packet.

    Call `watch` after each tick. A trail is the same object as long as nothing is added to it.
    """

    CACHES = ("_session",)

    def __init__(self, session: Session) -> None:
        self._session = session
        self._most = int((TRAIL_S if session.source.worlds else RECORDED_S) / session.frame.dt) // 2
        self.robot = _no_points(2)  # true path, (t, 2), office frame
        self.packet = _no_points(3)  # of the winning packet, (p, 3): x', y' (cells), heading (rad)

    def settle(self, session: Session) -> None:
        """Go on in a history that was restored."""
        self._session = session
        self.robot, self.packet = frozen(self.robot), frozen(self.packet)

    def watch(self) -> None:
        session = self._session
        if session.tick_count % 2 == 0:
            truth, packet = session.truth, session.estimate.packet
            if truth is not None:
                self.robot = _grown(self.robot, (truth.x, truth.y), self._most, STILL_M)
            self.packet = _grown(self.packet, (packet.x, packet.y, packet.heading_rad), self._most, STILL_CELLS)


def _no_points(columns: int) -> NDArray[np.float32]:
    return frozen(np.zeros((0, columns), np.float32))


def _grown(path: NDArray[np.float32], point: tuple[float, ...], most: int, still: float) -> NDArray[np.float32]:
    """`path` with `point` added, the last `most` points; `path` itself if the point is within `still` of its end."""
    if len(path) and math.dist(path[-1].tolist(), point) < still:
        return path
    return frozen(np.vstack([path[max(0, len(path) + 1 - most) :], np.array([point], np.float32)]))


@kind("visit_log/1")
class VisitLog:
    """When each experience and each view was first and last active, and how often it became active.

    Call `watch` after each tick.
    """

    CACHES = ("_session",)

    def __init__(self, session: Session) -> None:
        self._session = session
        self.experiences, self.views = Visits(), Visits()
        self.watch()

    def settle(self, session: Session) -> None:
        """Go on in a history that was restored."""
        self._session = session

    def watch(self) -> None:
        session = self._session
        self.experiences.note(session.brain.experience_map.active, session.time_s)
        self.views.note(session.estimate.recognition.view, session.time_s)


@kind("visits/1")
class Visits:
    """Visits of experiences, or of views. Those that a brain brought with it have no times until they are met again."""

    def __init__(self) -> None:
        self._first_s, self._last_s = np.full(1024, np.nan), np.full(1024, np.nan)
        self._count = np.zeros(1024, np.int64)
        self._active = -1

    def note(self, number: int, time_s: float) -> None:
        """The experience or view that is active now; -1: none."""
        if number >= len(self._count):
            more = max(number + 1, 2 * len(self._count)) - len(self._count)
            self._first_s, self._last_s = (np.append(a, np.full(more, np.nan)) for a in (self._first_s, self._last_s))
            self._count = np.append(self._count, np.zeros(more, np.int64))
        if number >= 0:
            if self._count[number] == 0:
                self._first_s[number] = time_s
            self._last_s[number] = time_s
            self._count[number] += number != self._active
        self._active = number

    @property
    def first_s(self) -> NDArray[np.float64]:
        """When each was active first, simulated seconds; NaN: never."""
        return self._first_s

    def of(self, number: int) -> Times:
        if number >= len(self._count) or self._count[number] == 0:
            return Times(None, None, 0)
        return Times(float(self._first_s[number]), float(self._last_s[number]), int(self._count[number]))


SERIES_POINTS = 600
ERROR_POINTS = 1000


@kind("run_series/2")
class RunSeries:
    """Errors, explored floor and counts over time, and the turn of the map. The longer the run, the less often they are sampled.

    Call `watch` after each tick.
    """

    CACHES = ("_session", "series")

    def __init__(self, session: Session) -> None:
        self._session = session
        self._samples: NDArray[np.float64] = np.zeros((0, 8))
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
        if session.source.worlds:
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
        if session.source.worlds:
            self.coverage = self._covered.follow(session.simulator.free_space, session.evaluation.path)
        self.map_turn_rad = self._turn(self.map_turn_rad)
        explored = math.nan if self.coverage is None else 100 * self.coverage
        views, experiences = len(brain.local_view), len(brain.experience_map)
        metres, radians = brain.experience_map.residual
        sample = session.time_s, *errors, explored, views, experiences, 1000 * metres, 1000 * radians
        self._samples = np.vstack([self._samples, sample])
        if len(self._samples) > SERIES_POINTS:
            self._samples = self._samples[::2]
            self._sample_every_s *= 2
        self.series = self._shown()

    def _shown(self) -> Series:
        return Series(*frozen(self._samples.T.copy()))


EVERY_S = 1.0  # simulated time between two measurements of the errors


@kind("beside_history/1")
class BesideHistory:
    """What is kept of a second brain: its packet's path, its last snap, its errors. Call `watch` after each tick."""

    def __init__(self, session: Session, companion: Companion) -> None:
        self.of = companion
        self._most = int(TRAIL_S / session.frame.dt) // 2
        self.path = _no_points(3)  # of the winning packet, as in `Trails`
        self.last_snap: tuple[float, Packet, Packet] | None = None  # when, from, to
        self._before: Packet | None = None
        self.error_map_m: float | None = None
        self.map_turn_rad = 0.0
        self._due_s = 0.0

    def settle(self) -> None:
        """Go on after it was restored."""
        self.path = frozen(self.path)

    def watch(self, session: Session) -> None:
        estimate = self.of.estimate
        assert estimate is not None
        packet = estimate.packet
        if estimate.relocalised and self._before is not None:
            self.last_snap = session.time_s, self._before, packet
        self._before = packet
        if session.tick_count % 2 == 0:
            self.path = _grown(self.path, (packet.x, packet.y, packet.heading_rad), self._most, STILL_CELLS)
        if session.time_s >= self._due_s:
            self._measure(session)

    def _measure(self, session: Session) -> None:
        self._due_s = session.time_s + EVERY_S
        evaluation, map_ = self.of.evaluation, self.of.brain.experience_map
        if session.truth is not None:
            self.error_map_m = evaluation.errors(map_, max(1, session.tick_count // ERROR_POINTS))[0]
        self.map_turn_rad = map_turn(self.map_turn_rad, evaluation, map_, session.truth)
