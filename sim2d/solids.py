"""What the robot can run into, in pymunk: walls, leaves, boxes, and the people who are near."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
import pymunk

from sim2d.living import Living
from sim2d.world import World

_Shape = TypeVar("_Shape", bound=pymunk.Shape)
_FRICTION = 0.3
_NEAR_M = 2.0  # people farther from the robot than this need no place in the space
_WALLS_M, _MOVES_M = 6.0, 3.0  # of walls only those around the robot stand in it, chosen anew when it has moved so far


class Solids:
    """Shapes of one world on the space's static body. They stand still during a tick and move between ticks.

    [ours] The space holds the walls around the robot alone: ten thousand took a second to put in, and an edit put them all
    in again. What the robot cannot reach before they are chosen anew is left out, so nothing else changes
    (test_solids.py::test_the_robot_meets_every_wall).
    """

    def __init__(self, space: pymunk.Space, world: World, living: Living) -> None:
        self._space = space
        self._walls: list[pymunk.Segment] = []
        self._doors: list[pymunk.Segment] = []
        self._boxes: list[pymunk.Poly] = []
        self._people: list[pymunk.Circle] = []
        self._out: set[pymunk.Shape] = set()
        self.furnish(world, living)

    def furnish(self, world: World, living: Living) -> None:
        """Take all shapes anew; the walls come with the next `follow`. In one order always: the solver's sums follow it."""
        for shape in (*self._walls, *self._doors, *self._boxes, *self._people):
            if shape not in self._out:
                self._space.remove(shape)
        self._living, self._out = living, set()
        self._segments, self._walls = world.segments()[list(world.obstacles)], []
        self._centre = (math.inf, math.inf)  # nowhere near
        self._opening = living.opening.copy()
        self._doors = [self._segment(*living.segments[i].tolist()) for i in range(living.first_box)]
        self._boxes = [self._add(pymunk.Poly(self._space.static_body, box.corners.tolist())) for box in world.boxes]
        self._people = [self._add(pymunk.Circle(self._space.static_body, p.radius)) for p in world.people]
        for shape in (*self._boxes, *self._people):
            self._put_out(shape)

    def follow(self, robot: tuple[float, float]) -> None:
        """Put everything that has moved to where it is now."""
        if max(abs(robot[0] - self._centre[0]), abs(robot[1] - self._centre[1])) > _MOVES_M:
            self._wall_in(robot)
        if not (self._doors or self._boxes or self._people):
            return
        living = self._living
        for i in np.flatnonzero(living.opening != self._opening):
            x1, y1, x2, y2 = living.segments[i].tolist()
            self._doors[i].unsafe_set_endpoints((x1, y1), (x2, y2))
            self._space.reindex_shape(self._doors[i])
            self._opening[i] = living.opening[i]
        for i, shape in enumerate(self._boxes):
            self._put_in(shape) if living.box_present[i] else self._put_out(shape)
        if not self._people:
            return
        walkers = living.walkers
        near = walkers.present & (np.abs(walkers.xy - robot).max(axis=1) < _NEAR_M)
        for i, is_near in enumerate(near.tolist()):
            shape = self._people[i]
            if not is_near:
                self._put_out(shape)
                continue
            shape.unsafe_set_offset(tuple(walkers.xy[i].tolist()))
            if shape in self._out:
                self._put_in(shape)
            else:
                self._space.reindex_shape(shape)

    def _wall_in(self, robot: tuple[float, float]) -> None:
        """Put the walls around the robot into the space, in the world's order, and take out all others."""
        if self._walls:
            self._space.remove(*self._walls)
        ends, self._centre = self._segments.reshape(-1, 2, 2), robot
        near = (ends.max(axis=1) >= np.subtract(robot, _WALLS_M)) & (ends.min(axis=1) <= np.add(robot, _WALLS_M))
        self._walls = [self._segment(*row) for row in self._segments[near.all(axis=1)].tolist()]

    def _segment(self, x1: float, y1: float, x2: float, y2: float) -> pymunk.Segment:
        return self._add(pymunk.Segment(self._space.static_body, (x1, y1), (x2, y2), 0.0))

    def _add(self, shape: _Shape) -> _Shape:
        shape.friction = _FRICTION
        self._space.add(shape)
        return shape

    def _put_in(self, shape: pymunk.Shape) -> None:
        if shape in self._out:
            self._out.remove(shape)
            self._space.add(shape)

    def _put_out(self, shape: pymunk.Shape) -> None:
        if shape not in self._out:
            self._out.add(shape)
            self._space.remove(shape)
