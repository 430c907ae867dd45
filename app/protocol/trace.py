"""What the figures need of a trial that is not kept with its scores: it is run again and written down here, with what it has
left behind at its end, laid over the office. Plain numbers and arrays, since it is made in other processes and sent here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.evaluation.agreement import alignment, rmse
from app.protocol.course import Course, Moment, Visited, run_ticks
from app.protocol.trial import Trial
from app.session import Session
from ratslam_core import Packet, Pose2
from ratslam_core.experience_map.places import find_places
from ratslam_core.goal_memory import lead_s
from ratslam_core.pose_graph.transitions import moved_by
from sim2d import World

_Array = NDArray[np.float64]
_Numbers = NDArray[np.int64]
PLACE_M = 0.5  # experiences nearer than this to the first of their place belong to it
APART_M = 4.0  # two ways to a goal are two if they come so far apart


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The office from above, m."""

    name: str
    walls: _Array  # (w, 4): x1 y1 x2 y2, of the walls that stand on the floor
    boxes: tuple[_Array, ...]  # (4, 2) corners of each
    bounds: tuple[float, float, float, float]  # least x, least y, most x, most y


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """A picture made of squares. values: (n_y, n_x)."""

    values: _Array
    origin: tuple[float, float]  # the middle of [0, 0]; m, or cells of the pose cells
    cell: float  # side of a square, in the same unit


@dataclass(frozen=True, slots=True, eq=False)
class FinalMap:
    """The experience map at the end, n experiences, in the office's frame."""

    in_office: Pose2  # of the map's frame: it fits the whole path best
    poses: _Array  # (n, 3) x, y (m), heading (rad)
    truth: _Array  # (n, 3) where each was truly made; NaN where that is unknown
    states: _Array  # (n, 3) x', y' (cells), theta' (layers)
    views: _Numbers  # (n,) scene, -1 for none
    links: _Numbers  # (m, 2)
    goal: int  # the experience that the temporal map leads to: that of the last visit, else the active one
    times_s: _Array  # (n,) to it; inf where no way is known
    multiple: tuple[tuple[int, ...], ...]  # multiple representations: the first experience of each state of one place
    collisions: tuple[tuple[int, ...], ...]  # hash collisions: the first experience at each place of one state
    occupancy: (
        Grid | None
    )  # probability that something stands there, laid over the map before it is laid over the office
    cells_occupancy: Grid | None  # the same in the pose cells' own frame, as the papers draw it
    goal_times: Grid | None  # the goal memory's temporal map over the pose cells, s; inf where no way is known
    goal_lead: (
        Grid | None
    )  # by how many s the quickest way from each cell leads over another; inf where there is no other


def plan_of(world: World) -> Plan:
    """The plan of a world as it is at the start."""
    walls = world.segments()[list(world.obstacles)].astype(np.float64)
    boxes = tuple(_corners(b.x, b.y, b.width, b.depth, b.angle_rad) for b in world.boxes if b.present)
    return Plan(world.name, walls, boxes, world.bounds)


def final_map(course: Course) -> FinalMap:
    """Read the map of a course that has ended."""
    session = course.session
    brain, map_ = session.brain, session.brain.experience_map
    truth, mapped, _ = session.evaluation.trajectories(map_, every=5)
    in_office = alignment(mapped, truth)
    places = find_places(map_, PLACE_M)
    goal = _goal(course)
    occupancy, cells_occupancy = _occupancy(session)
    goal_times, goal_lead = _goal_times(session, goal) if len(brain.goal_memory) else (None, None)
    return FinalMap(
        in_office=in_office,
        poses=placed(map_.poses, in_office),
        truth=session.evaluation.births(len(map_))[:, :3].copy(),
        states=map_.cell_states.copy(),
        views=map_.views.astype(np.int64),
        links=map_.links.astype(np.int64),
        goal=goal,
        times_s=map_.temporal_map.times_to(goal),
        multiple=tuple(each.experiences for each in places.multiple_representations),
        collisions=tuple(each.experiences for each in places.hash_collisions),
        occupancy=occupancy,
        cells_occupancy=cells_occupancy,
        goal_times=goal_times,
        goal_lead=goal_lead,
    )


def placed(poses: _Array, frame: Pose2) -> _Array:
    """(n, 2) points or (n, 3) poses of a frame, seen from where the frame lies."""
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    points = poses[:, :2] @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)
    if poses.shape[1] == 2:
        return points
    return np.column_stack([points, poses[:, 2] + frame.heading_rad])


def _goal(course: Course) -> int:
    map_ = course.session.brain.experience_map
    visited = [visit.experience for visit in course.visits]
    known = [experience for experience in visited if experience is not None]
    return known[-1] if known else map_.active


def _goal_times(session: Session, goal: int) -> tuple[Grid, Grid]:
    map_, memory = session.brain.experience_map, session.brain.goal_memory
    x, y, *_ = map_.cell_state(goal)
    n_y, n_x = memory.shape[1:]
    times = memory.times_to(round(x) % n_x, round(y) % n_y)
    return Grid(times, (0.0, 0.0), 1.0), Grid(lead_s(memory, times, APART_M), (0.0, 0.0), 1.0)


def _occupancy(session: Session) -> tuple[Grid | None, Grid | None]:
    brain = session.brain
    if brain.map_grid is None or brain.occupancy is None:
        return None, None
    drawn = brain.map_grid.draw(brain.experience_map.poses)
    metric = Grid(drawn.probability.astype(np.float64), drawn.origin_xy_m, drawn.cell_m)
    return metric, Grid(brain.occupancy.probability.astype(np.float64), (0.0, 0.0), 1.0)


def _corners(x: float, y: float, width: float, depth: float, angle_rad: float) -> _Array:
    half = np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]]) / 2
    return placed(half, Pose2(x, y, angle_rad))


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
    paths: _Array  # (n, steps + 1, 2), as app/pilot/local_movement.py has them; one point if it only turns
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
    off_m: _Array  # (n,) between ground truth and pose estimate; NaN where that has no meaning
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
    """Looks at a course before its first tick and after each, and changes nothing in it."""

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


def trace_of(trial: Trial) -> Trace:
    """Run a trial again and write it down. The run is the same, bit for bit, as without."""
    course = trial.begin()
    recorder = Recorder(course)
    run_ticks(course, course.ticks(), [recorder.note])
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
