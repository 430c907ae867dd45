"""What the figures need of a trial that is not kept with its scores: it is run again and written down here.

Plain numbers and arrays, since it is made in other processes and sent here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.evaluation.alignment import rmse
from app.trials.course import Course
from app.trials.final_map import FinalMap, Plan, final_map, placed, plan_of
from app.trials.measures import MEASURES
from app.trials.notes import Moment, Visited
from app.trials.trial import Trial, watched
from ratslam_core import Packet, Pose2
from ratslam_core.pose_graph.preintegrated import moved_by

_Array = NDArray[np.float64]
EVERY_S = 0.5  # between two rows
PATH_EVERY = 5  # ticks between two points of a path
ERROR_EVERY_S = 15.0  # between two looks at the whole map
LOOK_EVERY_S = 1.0  # between two looks at the arcs of a robot on a route
MOST_PACKETS = 4


@dataclass(frozen=True, slots=True)
class Goal:
    """A place that was tagged. experience: None if the robot never came near."""

    name: str
    x: float
    y: float
    experience: int | None


@dataclass(frozen=True, slots=True)
class Carried:
    """A kidnap; after_s and after_m are None if the robot never knew again where it was."""

    at_s: float
    after_s: float | None
    after_m: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Movements:
    """The n arcs among which the robot chose at one moment of following a route, in the office's frame: m and rad."""

    time_s: float
    robot: Pose2  # where it truly was when it chose
    radius_m: float  # of the robot
    paths: _Array  # (n, steps + 1, 2), as app/pilot/candidates.py has them; one point if it only turns
    cost: _Array  # (n,) m; inf where an echo bars the arc
    drives: NDArray[np.bool_]  # (n,) False for a turn on the spot
    chosen: int
    aim: _Array  # (2,) the point that it steered towards
    route: _Array  # (k, 2) the experiences ahead, as the map has them about the robot

    @property
    def free(self) -> NDArray[np.bool_]:
        """(n,) whether no echo bars the arc."""
        return np.isfinite(self.cost)


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One trial, written down. Lengths in m, angles in rad, times in s; n rows, one each `EVERY_S`."""

    trial: Trial
    time_s: _Array  # (n,)
    truth: _Array  # (n, 3) true x, y, heading, office frame
    cells: _Array  # (n, 3) the winning packet: x, y in cells, heading in rad
    mass: _Array  # (n, 4) activity of the strongest packets, 0 where there are fewer
    off_m: _Array  # (n,) between the robot and where it believes itself to be; NaN where that has no meaning
    residual: _Array  # (n,) by how much map and links disagree, m
    views: NDArray[np.int64]  # (n,) recruited so far
    experiences: NDArray[np.int64]  # (n,) made so far
    active: NDArray[np.int64]  # (n,) experience
    snaps: _Array  # (k, 7) each jump of the winning packet: time; x, y, heading before (S); x, y, heading after (F)
    error_time_s: _Array  # (e,)
    error_m: _Array  # (e,) of the whole map so far
    true_path: _Array  # (p, 2)
    mapped_path: _Array  # (p, 2) the same path as the map tells it at the end, laid over the office
    odometry_path: _Array  # (p, 2) the same by odometry alone, laid so that it begins where the robot began
    cells_shape: tuple[int, int, int]  # layers, cells along y' and x'
    cell_m: float
    map: FinalMap
    plan: Plan
    moments: tuple[Moment, ...]
    goals: tuple[Goal, ...]
    visits: tuple[Visited, ...]
    kidnaps: tuple[Carried, ...]
    movements: Movements | None  # None if it never chose on a route between arcs that were free and arcs that were not


class Recorder:
    """Looks at a course before its first tick and after each, as a measure does, and changes nothing in it."""

    def __init__(self, course: Course) -> None:
        self.course = course
        self.rows: list[tuple[float, ...]] = []
        self.errors: list[tuple[float, float]] = []
        self.snaps: list[tuple[float, ...]] = []
        self._row_s = self._error_s = 0.0
        self._snaps = course.session.brain.relocalisations
        self._before: Packet = course.session.brain.pose_cells.winner
        self._look_s = 0.0
        self._telling = 0  # of the movements that are kept
        self.movements: Movements | None = None
        self.note()  # before the first tick

    def note(self) -> None:
        session = self.course.session
        winner, snaps = session.brain.pose_cells.winner, session.brain.relocalisations
        if snaps > self._snaps:
            self.snaps.append((session.time_s, *_state(self._before), *_state(winner)))
        self._before, self._snaps = winner, snaps
        if session.time_s >= self._row_s - 1e-9:
            self._row_s += EVERY_S
            self._row()
        if session.time_s >= self._error_s - 1e-9:
            self._error_s += ERROR_EVERY_S
            path, mapped, _ = session.evaluation.trajectories(session.brain.experience_map, every=2 * PATH_EVERY)
            self.errors.append((session.time_s, rmse(mapped, path)))
        state = session.pilot.goal_state
        if state is not None and state[1] == "tracking" and session.time_s >= self._look_s - 1e-9:
            self._look_s = session.time_s + LOOK_EVERY_S
            self._look()

    def _row(self) -> None:
        session = self.course.session
        brain, truth, map_ = session.brain, session.simulator.truth, session.brain.experience_map
        mass = [packet.mass for packet in brain.pose_cells.packets[:MOST_PACKETS]]
        mass += [0.0] * (MOST_PACKETS - len(mass))
        off_m = session.evaluation.belief_off(truth, map_)[0]
        self.rows.append((
            session.time_s, truth.x, truth.y, truth.heading_rad, *_state(brain.pose_cells.winner), *mass, off_m,
            map_.residual[0], len(brain.local_view), len(map_), map_.active,
        ))  # fmt: skip

    def _look(self) -> None:
        """Keep the moment with the largest product of free and barred arcs, the first of equals: it tells most."""
        session = self.course.session
        look, aim = session.pilot.look_at_choice(), session.pilot.aim
        if look is None or aim is None:
            return
        tried = look()
        drives, free = tried.speed > 0, np.isfinite(tried.cost)
        telling = int((drives & free).sum()) * int((drives & ~free).sum())
        if telling <= self._telling or not drives[tried.chosen]:
            return
        self._telling = telling
        truth, map_ = session.simulator.truth, session.brain.experience_map
        now = Pose2(truth.x, truth.y, truth.heading_rad)
        then = now.compose(moved_by(session.odometry).inverse())  # it chose before the tick, and has moved since
        progress = session.pilot.progress(map_)
        ahead = map_.poses[progress.route, :2] if progress else np.zeros((0, 2))
        self.movements = Movements(
            time_s=session.time_s, robot=then, radius_m=session.config.robot.robot_radius_m,
            paths=placed(tried.paths.reshape(-1, 2), then).reshape(tried.paths.shape),
            cost=tried.cost, drives=drives, chosen=tried.chosen,
            aim=placed(np.array([aim]), then)[0], route=placed(ahead, now.compose(map_.robot.inverse())),
        )  # fmt: skip

    def scores(self) -> dict[str, float]:
        return {}


def trace_of(trial: Trial) -> Trace:
    """Run a trial again and write it down. The run is the same, bit for bit, as without."""
    course = trial.begin()
    recorder = Recorder(course)
    watched(course, [*(MEASURES[name](course) for name in trial.measures), recorder])
    session, map_ = course.session, course.session.brain.experience_map
    rows = np.array(recorder.rows, np.float64).reshape(-1, 16)
    errors = np.array(recorder.errors, np.float64).reshape(-1, 2)
    truth, mapped, odometry = session.evaluation.trajectories(map_, every=PATH_EVERY)
    picture = final_map(course)
    whole = rows[:, 13:16].astype(np.int64)
    return Trace(
        trial=trial,
        time_s=rows[:, 0], truth=rows[:, 1:4], cells=rows[:, 4:7], mass=rows[:, 7:11], off_m=rows[:, 11],
        residual=rows[:, 12], views=whole[:, 0], experiences=whole[:, 1], active=whole[:, 2],
        snaps=np.array(recorder.snaps, np.float64).reshape(-1, 7),
        error_time_s=errors[:, 0], error_m=errors[:, 1],
        true_path=truth.copy(),
        mapped_path=placed(mapped, picture.in_office),
        odometry_path=placed(odometry, _beginning(course)),
        cells_shape=session.brain.pose_cells.shape, cell_m=map_.cell_m,
        map=picture, plan=plan_of(session.world),
        moments=tuple(course.moments),
        goals=tuple(Goal(name, tag.x, tag.y, tag.experience) for name, tag in course.tags.items()),
        visits=tuple(course.visits),
        kidnaps=tuple(Carried(k.at_s, k.after_s, k.after_m) for k in session.evaluation.kidnaps),
        movements=recorder.movements,
    )  # fmt: skip


def _state(packet: Packet) -> tuple[float, float, float]:
    return packet.x, packet.y, packet.heading_rad


def _beginning(course: Course) -> Pose2:
    """The true pose at the start, which is the origin of odometry."""
    x, y, heading, _ = course.session.evaluation.births(1)[0].tolist()
    return Pose2(x, y, heading) if math.isfinite(x) else Pose2(0.0, 0.0, 0.0)
