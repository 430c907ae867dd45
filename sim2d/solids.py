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


class Solids:
    """Shapes of one world on the space's static body. They stand still during a tick and move between ticks."""

    def __init__(self, space: pymunk.Space, world: World, living: Living) -> None:
        self._space, self._living = space, living
        self._walls = [self._segment(world.walls[i].x1, world.walls[i].y1, world.walls[i].x2, world.walls[i].y2)
                       for i in world.obstacles]  # fmt: skip
        self._doors: list[pymunk.Segment] = []
        self._boxes: list[pymunk.Poly] = []
        self._people: list[pymunk.Circle] = []
        self._out: set[pymunk.Shape] = set()
        self.furnish(living)

    def furnish(self, living: Living) -> None:
        """Take the living things' shapes anew."""
        for shape in (*self._doors, *self._boxes, *self._people):
            if shape not in self._out:
                self._space.remove(shape)
        self._living, self._out = living, set()
        self._opening = living.opening.copy()
        self._doors = [self._segment(*living.segments[i].tolist()) for i in range(living.first_box)]
        self._boxes = [
            self._add(pymunk.Poly(self._space.static_body, box.corners.tolist())) for box in living.world.boxes
        ]
        self._people = [self._add(pymunk.Circle(self._space.static_body, p.radius)) for p in living.world.people]
        for shape in (*self._boxes, *self._people):
            self._put_out(shape)
        self.follow((math.inf, math.inf))

    def remove_all(self) -> None:
        """Leave the space."""
        for shape in (*self._walls, *self._doors, *self._boxes, *self._people):
            if shape not in self._out:
                self._space.remove(shape)

    def follow(self, robot: tuple[float, float]) -> None:
        """Put everything that has moved to where it is now."""
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
