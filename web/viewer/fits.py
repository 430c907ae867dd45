"""Where things lie: poses and points of one frame in another, of the office, the map and the pose cells on their plates; and what
the switches show and lay over them at a moment, on the stage and in pictures alike.

Frames are in metres and radians, but the pose cells' in cells [theta, y, x]; plates are in units of their own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from web.messages import (
    Closure,
    Ghost,
    GoalMemoryLayer,
    Movements,
    OccupancyLayer,
    Packet,
    Pose,
    Report,
    Snapshot,
    Spread,
    WorldDrawing,
)
from web.switches import Name

Array = NDArray[np.float64]


def placed(points: Array, frame: Pose) -> Array:
    """(n, 2) points of a frame, in the frame in which that lies."""
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return points @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


def into_map(points: Array, map_in_office: Pose) -> Array:
    """From (n, 2) in the office to the map: the inverse of `placed`."""
    c, s = math.cos(map_in_office.heading_rad), math.sin(map_in_office.heading_rad)
    return (points - (map_in_office.x, map_in_office.y)) @ np.array([[c, -s], [s, c]])


def compose(frame: Pose, pose: Pose) -> Pose:
    """A pose of a frame, in the frame in which that lies."""
    x, y = placed(np.array([[pose.x, pose.y]]), frame)[0].tolist()
    return Pose(x, y, frame.heading_rad + pose.heading_rad)


def on_plate(pose: Pose, fit: MapFit) -> Pose:
    """A pose of the map, on its plate."""
    x, y = fit.to_plate(np.array([[pose.x, pose.y]]))[0].tolist()
    return Pose(x, y, pose.heading_rad + fit.turn_rad)


WIDTH, DEPTH = 10.0, 8.0  # the floor of the plate
METRE_HIGH = 0.62 / 2.5  # plate units per metre of height, for everything but walls


class OfficeFit:
    """Between the office frame and the office plate: any world, scaled to fit 10 x 8 m."""

    def __init__(self, bounds: tuple[float, float, float, float]) -> None:
        low_x, low_y, high_x, high_y = bounds
        self.size_m = (max(high_x - low_x, 1e-3), max(high_y - low_y, 1e-3))
        self.low = np.array([low_x, low_y])
        self.scale = min(WIDTH / self.size_m[0], DEPTH / self.size_m[1])
        low = min(0.3, 140 * self.scale**2)  # in worlds beyond 200 m, higher walls would hide the rooms between them
        self.relief = min(1.0, max(1.5 * self.scale, low))  # scales heights and thicknesses: low where rooms are small
        self.grid_step_m = 1.0 if self.scale > 0.35 else 5.0  # between the lines of the floor
        self._centre = self.low + np.array(self.size_m) / 2

    def to_plate(self, xy: NDArray[np.floating]) -> Array:
        """From (n, 2) metres in the office to (n, 2) on the plate."""
        return (np.asarray(xy, np.float64) - self._centre) * self.scale

    def to_office(self, xy: NDArray[np.floating]) -> Array:
        """The inverse of `to_plate`."""
        return np.asarray(xy, np.float64) / self.scale + self._centre


ROOM = 0.35  # kept clear around the map
STEP = 2**0.25  # ratio of successive scales
LARGEST = 1.0 * STEP
GRID = 0.25  # the centre moves in steps of this size, in plate units


@dataclass(frozen=True)
class MapFit:
    """Between the map frame and the map plate, turned like the office (for the eye only) and scaled in steps:
    plate = scale * turn(map - centre)."""

    scale: float = LARGEST
    turn_rad: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)

    def to_plate(self, xy: NDArray[np.floating]) -> Array:
        """From (n, 2) metres in the map to (n, 2) on the plate."""
        return (np.asarray(xy, np.float64).reshape(-1, 2) - self.centre) @ _turned(self.turn_rad).T * self.scale

    def to_map(self, xy: NDArray[np.floating]) -> Array:
        """The inverse of `to_plate`."""
        return np.asarray(xy, np.float64).reshape(-1, 2) / self.scale @ _turned(self.turn_rad) + self.centre


def refit(fit: MapFit, xy: NDArray[np.floating], turn_rad: float) -> MapFit:
    """`fit` itself while it still suits the map (n, 2), else a fit at the largest scale that shows all of the map."""
    if len(xy) == 0:
        return MapFit(LARGEST, turn_rad)
    if fit.turn_rad == turn_rad and _suits(fit, xy):
        return fit
    turned = np.asarray(xy, np.float64) @ _turned(turn_rad).T
    low: Array = turned.min(0)
    high: Array = turned.max(0)
    size = np.maximum(high - low, 1e-6)
    largest = min((WIDTH - 2 * ROOM) / size[0], (DEPTH - 2 * ROOM) / size[1])
    scale = min(LARGEST, STEP ** math.floor(math.log(largest) / math.log(STEP)))
    middle = np.round((low + high) / 2 * scale / GRID) * GRID / scale @ _turned(turn_rad)
    return MapFit(scale, turn_rad, (float(middle[0]), float(middle[1])))


def _suits(fit: MapFit, xy: NDArray[np.floating]) -> bool:
    """Whether all of the map is on the floor, and would not be at a scale two steps larger."""
    placed = fit.to_plate(xy)
    low, high = placed.min(0), placed.max(0)
    if low[0] < -WIDTH / 2 + 0.2 or high[0] > WIDTH / 2 - 0.2 or low[1] < -DEPTH / 2 + 0.2 or high[1] > DEPTH / 2 - 0.2:
        return False
    small = fit.scale < LARGEST / STEP**1.5
    larger = STEP**2 * (high - low)
    return not (small and larger[0] < WIDTH - 2 * ROOM and larger[1] < DEPTH - 2 * ROOM)


def _turned(angle_rad: float) -> Array:
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s], [s, c]])


SIDE, HEIGHT = 7.2, 4.7


class CellFit:
    """From pose cells to the glass box on their plate: a torus unrolled. `shape` is (n_theta, n_y, n_x); x' and y' start at the
    box's left front corner, theta' at its floor."""

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self.shape = shape
        self.voxel = (SIDE / shape[2], SIDE / shape[1], HEIGHT / shape[0])

    def cells(self, cells: NDArray[np.integer]) -> Array:
        """From (k, 3) theta, y, x of cells to the (k, 3) centres of their voxels."""
        share = (cells[:, ::-1].astype(np.float64) + 0.5) / np.array(self.shape[::-1], np.float64)
        return share * np.array([SIDE, SIDE, HEIGHT]) - np.array([SIDE / 2, SIDE / 2, 0.0])

    def path(self, path: NDArray[np.floating]) -> Array:
        """From (p, 3) x, y in cells and heading to (p, 3) in the box."""
        x = (path[:, 0] + 0.5) / self.shape[2] % 1.0 * SIDE - SIDE / 2
        y = (path[:, 1] + 0.5) / self.shape[1] % 1.0 * SIDE - SIDE / 2
        z = path[:, 2] % math.tau / math.tau * HEIGHT
        return np.column_stack([x, y, z]).astype(np.float64)

    def packet(self, packet: Packet) -> Array:
        return self.path(np.array([[packet.x, packet.y, packet.heading_rad]]))[0]


def broken_where_it_wraps(points: Array) -> NDArray[np.float32]:
    """From (p, 3) points to segments, without those that jump around the torus."""
    segments = np.stack([points[:-1], points[1:]], 1)
    jumps = np.abs(segments[:, 1] - segments[:, 0]) > np.array([SIDE, SIDE, HEIGHT]) / 2
    return segments[~jumps.any(1)].astype(np.float32)


class Judged(NamedTuple):
    """What people alone know of a moment. None, and no closures: it is switched off, or nobody knows it."""

    walls_of: WorldDrawing | None  # its true walls lie under the map
    ghost: Ghost | None
    truth: Pose | None  # with which the estimate is compared
    spread: Spread | None
    closures: tuple[Closure, ...]


def judged(snapshot: Snapshot, on: Collection[Name]) -> Judged:
    """on: the switches that are on."""
    world, known = snapshot.world, snapshot.map_in_office is not None
    return Judged(
        world if "outline" in on and known and world is not None and world.is_office else None,
        snapshot.ghost if "ghost" in on and snapshot.truth is not None else None,
        snapshot.truth if "doubt" in on and known else None,
        snapshot.spread if "doubt" in on else None,
        snapshot.closures if "closures" in on else (),
    )


def walls_in_map(world: WorldDrawing, frame: Pose) -> Array:
    """(n, 4) the true walls in the map, laid there by the fit after which its error is measured."""
    return into_map(np.asarray(world.walls, np.float64).reshape(-1, 2), frame).reshape(-1, 4)


def wheels_alone(ghost: Ghost, truth: Pose) -> tuple[Pose, Pose, float]:
    """Where the wheels alone would have the robot, in the office and in the map, and how far from the robot that is, m."""
    office = compose(ghost.office_start, ghost.pose)
    return office, compose(ghost.map_start, ghost.pose), math.hypot(office.x - truth.x, office.y - truth.y)


def wheels_path(ghost: Ghost) -> tuple[Array, Array]:
    """(n, 2) the way there in the office and in the map."""
    path = np.asarray(ghost.path, np.float64).reshape(-1, 2)
    return placed(path, ghost.office_start), placed(path, ghost.map_start)


def error_line(estimate: Pose, truth: Pose, frame: Pose) -> tuple[Array, float]:
    """(2, 2) from the estimate to the true place in the map, and its length, m."""
    line = np.vstack([(estimate.x, estimate.y), into_map(np.array([[truth.x, truth.y]]), frame)])
    return line, float(np.hypot(*(line[1] - line[0])))


class Overlaid(NamedTuple):
    """What lies over the plates, and what is inspected. None: it is switched off, or there is none."""

    occupancy: OccupancyLayer | None  # below the map
    beneath: OccupancyLayer | None  # the same below the pose cells
    goal_memory: GoalMemoryLayer | None
    movements: Callable[[], Movements] | None
    inspected: Report | None


def overlaid(snapshot: Snapshot, on: Collection[Name]) -> Overlaid:
    """on: the switches that are on."""
    alone = snapshot.beside is None  # of two brains, both are drawn alike
    return Overlaid(
        snapshot.occupancy if alone and "occupancy" in on else None,
        snapshot.occupancy if "cell_occupancy" in on else None,
        snapshot.goal_memory if alone and "goal_memory" in on else None,
        snapshot.movements if "movements" in on else None,
        snapshot.inspected,
    )
