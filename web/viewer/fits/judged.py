"""What people alone know of a moment, as far as its switches show it, and where it lies: on the stage and in pictures alike."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from web.messages import Closure, Ghost, Pose, Snapshot, Spread, WorldDrawing
from web.switches import Name
from web.viewer.fits.poses import compose, into_map, placed

Points = NDArray[np.float64]


class Judged(NamedTuple):
    """None, and no closures: it is switched off, or nobody knows it."""

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


def walls_in_map(world: WorldDrawing, frame: Pose) -> Points:
    """(n, 4) the true walls in the map, laid there by the fit after which its error is measured."""
    return into_map(np.asarray(world.walls, np.float64).reshape(-1, 2), frame).reshape(-1, 4)


def wheels_alone(ghost: Ghost, truth: Pose) -> tuple[Pose, Pose, float]:
    """Where the wheels alone would have the robot, in the office and in the map, and how far from the robot that is, m."""
    office = compose(ghost.office_start, ghost.pose)
    return office, compose(ghost.map_start, ghost.pose), math.hypot(office.x - truth.x, office.y - truth.y)


def wheels_path(ghost: Ghost) -> tuple[Points, Points]:
    """(n, 2) the way there in the office and in the map."""
    path = np.asarray(ghost.path, np.float64).reshape(-1, 2)
    return placed(path, ghost.office_start), placed(path, ghost.map_start)


def error_line(estimate: Pose, truth: Pose, frame: Pose) -> tuple[Points, float]:
    """(2, 2) from the estimate to the true place in the map, and its length, m."""
    line = np.vstack([(estimate.x, estimate.y), into_map(np.array([[truth.x, truth.y]]), frame)])
    return line, float(np.hypot(*(line[1] - line[0])))
