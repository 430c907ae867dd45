"""What a trial has left behind at its end, as plain arrays laid over the office: map, pose cells, pictures, plan."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.evaluation.alignment import alignment
from app.session import Session
from app.trials.course import Course
from ratslam_core import Pose2
from ratslam_core.experience_map.places import find_places
from ratslam_core.goal_plateau import lead_s
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
