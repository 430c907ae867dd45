"""What the robot can run into in one tick, in pymunk: the walls, door leaves, boxes and people around it."""

from __future__ import annotations

import numpy as np
import pymunk

from sim2d.actors.actors import Actors
from sim2d.world.world import World

_MARGIN_M = 0.1  # more than the solver can push the robot beyond its reach


class Surroundings:
    """Makes the pymunk space of a tick.

    [ours] Every tick in which the robot may touch something gets a new space, with everything near in the world's
    order. A space kept over several ticks would hold contacts and impulses that cannot be read or set. With a new one,
    only the robot's pose and speeds go from tick to tick, and a saved session goes on bit for bit even while the robot
    touches a wall (test_session_snapshot.py). Most ticks need no space; making one costs a tenth of a millisecond.
    """

    def __init__(self, world: World, actors: Actors) -> None:
        self._walls = world.segments()[list(world.obstacles)].reshape(-1, 2, 2)
        self._actors = actors

    def space(self, x: float, y: float, reach: float, friction: float) -> pymunk.Space:
        """A space with everything within `reach` metres of (x, y), and little more. All of it has this friction."""
        space = pymunk.Space()
        space.collision_slop = 0.001  # overlap (m) that the solver tolerates; pymunk's default is meant for pixels
        low, high = np.subtract((x, y), reach + _MARGIN_M), np.add((x, y), reach + _MARGIN_M)
        near = (self._walls.max(axis=1) >= low) & (self._walls.min(axis=1) <= high)
        ground, actors = space.static_body, self._actors
        leaves = actors.segments[: actors.first_box]
        standing, shapes = actors.standing(), list[pymunk.Shape]()
        for x1, y1, x2, y2 in (*self._walls[near.all(axis=1)].reshape(-1, 4).tolist(), *leaves.tolist()):
            shapes.append(pymunk.Segment(ground, (x1, y1), (x2, y2), 0.0))
        for box in standing.boxes:
            shapes.append(pymunk.Poly(ground, box.corners.tolist()))
        for _, px, py, radius in standing.people:
            if max(abs(px - x), abs(py - y)) < radius + reach + _MARGIN_M:
                shapes.append(pymunk.Circle(ground, radius, (px, py)))
        for shape in shapes:
            shape.friction = friction
        space.add(*shapes)
        return space
