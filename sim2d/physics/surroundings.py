"""What the robot can run into in one tick, in pymunk: the walls, leaves, boxes and people around it."""

from __future__ import annotations

import numpy as np
import pymunk

from sim2d.actors.actors import Actors
from sim2d.world.world import World

_FRICTION = 0.3
_MARGIN_M = 0.1  # what the solver may push the robot beyond its reach, and more


class Surroundings:
    """Makes the space of a tick.

    [ours] Every tick in which the robot may touch something gets a space of its own, with what is near in the world's order. A
    space that lives on remembers contacts and impulses that nobody can read or set; so nothing but the robot's pose and
    speeds goes from tick to tick, and a session that was saved goes on bit for bit even while it touches a wall
    (test_session_snapshot.py). Most ticks need none, and one costs a tenth of a millisecond.
    """

    def __init__(self, world: World, actors: Actors) -> None:
        self._walls = world.segments()[list(world.obstacles)].reshape(-1, 2, 2)
        self._actors = actors

    def space(self, x: float, y: float, reach: float) -> pymunk.Space:
        """With all that is within `reach` metres of (x, y), and hardly more."""
        space = pymunk.Space()
        space.collision_slop = 0.001  # metres of overlap that the solver leaves alone; pymunk's own is for pixels
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
            shape.friction = _FRICTION
        space.add(*shapes)
        return space
