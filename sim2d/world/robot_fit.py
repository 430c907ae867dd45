"""The one authority on where the robot fits: for kidnaps, starts, edits and the ring under a dragged robot."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sim2d.geometry.segments import inside_ring, nearest_segment
from sim2d.world.elements import Box, Door
from sim2d.world.free_space import FreeSpace
from sim2d.world.world import World

LEANS_M = 0.01  # how far the robot may overlap with something that it leans on


@dataclass(frozen=True, slots=True)
class Standing:
    """What stands on the floor besides walls: doors with their opening, boxes, people (name, x, y, radius)."""

    doors: tuple[tuple[Door, float], ...] = ()
    boxes: tuple[Box, ...] = ()
    people: tuple[tuple[str, float, float, float], ...] = ()

    @classmethod
    def at_first(cls, world: World) -> Standing:
        """What stands there as a world begins. People are left out, since they make way for the robot."""
        doors = tuple((door, float(door.open)) for door in world.doors)
        return cls(doors, tuple(box for box in world.boxes if box.present))

    def distances(self, x: float, y: float) -> Iterator[tuple[float, str]]:
        """The distance (m) from (x, y) to each of them, 0 inside it, and its name."""
        for i, (door, opening) in enumerate(self.doors):
            yield nearest_segment(door.leaf(opening)[None], x, y)[1], f"doors[{i}] ({door.name})"
        for box in self.boxes:
            yield box.distance(x, y), f"box {box.name!r}"
        for name, px, py, radius in self.people:
            yield max(math.hypot(px - x, py - y) - radius, 0.0), f"person {name!r}"


@dataclass(frozen=True, slots=True, eq=False)
class RobotFit:
    """Where a robot fits at one moment. It is immutable, so it may be used from any thread."""

    floor: FreeSpace  # what the walls leave free for a robot of this size
    standing: Standing = Standing()

    def refusal(self, x: float, y: float) -> str | None:
        """Why the robot cannot be put at (x, y), or None."""
        refusal = self.floor.refusal(x, y)
        if refusal is not None:
            return refusal
        for distance, what in self.standing.distances(x, y):
            if distance < self.floor.radius:
                return f"({x:g}, {y:g}) is {distance:.3f} m from {what}; the robot needs {self.floor.radius:g} m"
        return None

    def covering(self, x: float, y: float) -> str | None:
        """Why a robot that is at (x, y) cannot stay there, or None. It may lean on things and need not be reachable."""
        at, radius = f"the robot at ({x:.2f}, {y:.2f})", self.floor.radius - LEANS_M
        if not inside_ring(self.floor.world.outline, x, y):
            return f"{at} would be outside of the outer walls; leave it inside"
        for distance, what in (self.floor.nearest_wall(x, y), *self.standing.distances(x, y)):
            if distance < radius:
                return f"{what} would cover {at}; keep {radius:.2f} m away from it"
        return None
