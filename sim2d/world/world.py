"""An office as data: walls and their panels, elements, and where the robot starts. Metres, radians, z up."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sim2d.world.elements import Box, Daylight, Door, Event, Lamp, Person, Rgb, SlowZone


@dataclass(frozen=True, slots=True)
class Panel:
    """A poster, door, window or stretch of paint on one side of a wall, `at` metres from the wall's first end."""

    at: float
    width: float
    bottom: float
    top: float
    texture: str
    colour: Rgb
    seed: int
    side: str  # "left", "right" (seen from the first end to the second) or "both"


@dataclass(frozen=True, slots=True)
class Wall:
    """An upright rectangle from (x1, y1) to (x2, y2). It has no thickness. Its two sides may have different panels.

    A wall of kind "glass" lets light through, except for the share `reflection`, which it reflects.
    """

    x1: float
    y1: float
    x2: float
    y2: float
    kind: str
    height: float
    colour: Rgb
    outer: bool = False
    bottom: float = 0.0  # m above the floor; more than 0 only for something that stands on a desk
    panels: tuple[Panel, ...] = ()
    name: str = ""
    reflection: float = 0.25  # of glass

    @property
    def length(self) -> float:
        """Length in metres."""
        return math.hypot(self.x2 - self.x1, self.y2 - self.y1)

    @property
    def stands(self) -> bool:
        """Whether it stands on the floor, where the robot and the sonars meet it."""
        return self.bottom == 0.0


@dataclass(frozen=True, slots=True)
class Start:
    """A pose to start from: x, y in metres; heading 0 = +x, positive counter-clockwise."""

    name: str
    x: float
    y: float
    heading_rad: float


@dataclass(frozen=True, slots=True)
class Place:
    """A point with a name."""

    name: str
    x: float
    y: float


@dataclass(frozen=True)
class World:
    """One office. `walls` begins with the outer walls, a closed ring that runs counter-clockwise."""

    name: str
    title: str
    source: str
    walls: tuple[Wall, ...]
    starts: tuple[Start, ...]
    places: tuple[Place, ...]
    floor_colour: Rgb = (120, 112, 104)
    ceiling_colour: Rgb = (226, 226, 220)
    doors: tuple[Door, ...] = ()
    lamps: tuple[Lamp, ...] = ()
    daylight: Daylight | None = None  # None: always 1
    boxes: tuple[Box, ...] = ()
    people: tuple[Person, ...] = ()
    slow_zones: tuple[SlowZone, ...] = ()
    script: tuple[Event, ...] = ()
    paper: str = ""
    about: str = ""  # one sentence

    @cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x, least y, most x, most y of the outer walls (m)."""
        ring = self._ring
        return float(ring[:, 0].min()), float(ring[:, 1].min()), float(ring[:, 0].max()), float(ring[:, 1].max())

    @cached_property
    def highest(self) -> float:
        """The height of the highest wall (m), which is that of the ceiling."""
        return max(w.height for w in self.walls)

    @property
    def outline(self) -> NDArray[np.float64]:
        """(k, 2): corners of the outer walls, counter-clockwise; the first is not repeated."""
        return self._ring.copy()

    @cached_property
    def obstacles(self) -> tuple[int, ...]:
        """Numbers of the walls that stand on the floor."""
        return tuple(i for i, w in enumerate(self.walls) if w.stands)

    def segments(self) -> NDArray[np.float64]:
        """(n, 4): x1 y1 x2 y2 of every wall."""
        return self._segments.copy()

    @cached_property
    def _ring(self) -> NDArray[np.float64]:
        return np.array([(w.x1, w.y1) for w in self.walls if w.outer])

    @cached_property
    def _segments(self) -> NDArray[np.float64]:
        return np.array([(w.x1, w.y1, w.x2, w.y2) for w in self.walls])
