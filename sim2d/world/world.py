"""An office as data: its elements, which are doors, lamps, daylight, boxes, people, slow zones and a script; walls and their
panels; and where the robot starts.

Lengths in metres, times in seconds, angles in radians, counter-clockwise, z up. A name is unique among the elements of a
kind.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Rgb = tuple[int, int, int]
Action = Literal[
    "open_door", "close_door", "lamp_on", "lamp_off", "box_appear", "box_vanish", "people_on", "people_off", "daylight"
]


@dataclass(frozen=True, slots=True)
class Door:
    """A door leaf. Shut, it reaches `width` metres from its hinge along `angle_rad`. It swings open, or slides back."""

    name: str
    x: float  # of the hinge
    y: float
    angle_rad: float  # of the shut leaf
    width: float
    height: float = 2.05
    colour: Rgb = (138, 90, 51)
    swing_rad: float = math.pi / 2  # from shut to open; negative = clockwise
    slides: bool = False
    open: bool = True  # at the start
    period_s: float = 0.0  # opens and shuts by itself once in this time; 0 = never
    open_s: float = 0.0  # how long it is open in each period
    phase_s: float = 0.0  # how far into its period it is at the start

    def leaf(self, opening: float) -> NDArray[np.float64]:
        """(4,): x1 y1 x2 y2 of the leaf; opening: 0 = shut, 1 = open."""
        x, y, angle = self.x, self.y, self.angle_rad
        if not self.slides:
            angle += opening * self.swing_rad
        ux, uy = math.cos(angle), math.sin(angle)
        if self.slides:
            x, y = x - self.width * opening * ux, y - self.width * opening * uy
        return np.array([x, y, x + self.width * ux, y + self.width * uy])


@dataclass(frozen=True, slots=True)
class Lamp:
    """A ceiling lamp: adds `brightness` directly below, less farther away, nothing beyond `reach` metres."""

    name: str
    x: float
    y: float
    reach: float
    brightness: float  # 1 = as painted
    on: bool = True  # at the start


@dataclass(frozen=True, slots=True)
class Daylight:
    """Brightness everywhere over time: linear between its points, repeated every `repeat_s` (0 = once)."""

    at_s: tuple[float, ...]  # ascending
    level: tuple[float, ...]  # 1 = as painted
    repeat_s: float = 0.0

    def at(self, time_s: float) -> float:
        """The level `time_s` seconds after the start; outside its points, the level of the nearest."""
        if self.repeat_s > 0:
            time_s = math.fmod(time_s, self.repeat_s)
        return float(np.interp(time_s, self.at_s, self.level))


BOX_M = (0.05, 20.0)  # how long an edge of a box may be


@dataclass(frozen=True, slots=True)
class Box:
    """An obstacle on the floor: a rectangle with its middle at (x, y)."""

    name: str
    x: float
    y: float
    width: float  # along its own x axis
    depth: float
    height: float = 0.6
    angle_rad: float = 0.0
    colour: Rgb = (176, 137, 86)
    present: bool = True  # at the start

    @property
    def corners(self) -> NDArray[np.float64]:
        """(4, 2): the corners, counter-clockwise."""
        c, s = math.cos(self.angle_rad), math.sin(self.angle_rad)
        a, b = 0.5 * self.width, 0.5 * self.depth
        return np.array(
            [(self.x + u * c - v * s, self.y + u * s + v * c) for u, v in ((-a, -b), (a, -b), (a, b), (-a, b))]
        )

    def distance(self, x: float, y: float) -> float:
        """Distance (m) from (x, y) to the box; 0 inside."""
        c, s = math.cos(self.angle_rad), math.sin(self.angle_rad)
        u, v = (x - self.x) * c + (y - self.y) * s, (y - self.y) * c - (x - self.x) * s
        return math.hypot(max(abs(u) - 0.5 * self.width, 0.0), max(abs(v) - 0.5 * self.depth, 0.0))


@dataclass(frozen=True, slots=True)
class Person:
    """A person who walks from point to point, waits at each, and stops for obstacles."""

    name: str
    path: tuple[tuple[float, float], ...]
    wait_s: tuple[float, ...]  # at each point
    speed: float = 0.8  # m/s
    loop: bool = True  # from the last point on to the first; otherwise back the way they came
    radius: float = 0.22
    height: float = 1.7
    colour: Rgb = (86, 110, 150)


@dataclass(frozen=True, slots=True)
class SlowZone:
    """A floor on which the wheels reach only a share of the commanded speed, like the carpet at point B in C."""

    name: str
    corners: tuple[tuple[float, float], ...]  # a polygon
    factor: float


@dataclass(frozen=True, slots=True)
class Event:
    """One line of the script: at a time since the start, do something to the element of this name."""

    at_s: float
    do: Action
    name: str = ""  # of the door, lamp or box
    level: float = 1.0  # of the daylight, from then on


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
