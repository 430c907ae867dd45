"""The office as the page draws it: what stands, what moves, and which edition an editor has made. Parts of a snapshot.

The office frame is the simulator's true one. SI units and radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class WorldDrawing:
    """All that the viewer needs to draw an office. Office frame."""

    name: str
    title: str
    bounds: tuple[float, float, float, float]  # min x, min y, max x, max y
    walls: NDArray[np.float32]  # (n, 4): x1 y1 x2 y2
    wall_height_m: NDArray[np.float32]  # (n,)
    wall_kind: tuple[str, ...]  # (n,): "wall", "partition", "desk", "door", "window", ...
    panels: NDArray[np.float32]  # (m, 6): x1 y1 x2 y2 bottom top of posters, doors and windows on walls
    panel_rgb: NDArray[np.uint8]  # (m, 3)
    places: tuple[tuple[str, float, float], ...]  # named places
    robot_radius_m: float
    camera_fov_rad: float
    sonar_angles_rad: NDArray[np.float32]  # (8,), from the robot's heading
    slow_zones: tuple[NDArray[np.float32], ...] = ()  # (k, 2) corners of each
    is_office: bool = True  # False: the bare ground of a recording's true path


@dataclass(frozen=True, slots=True, eq=False)
class LivingLayer:
    """What moves in the office. Office frame; rows of one kind keep their order."""

    door_names: tuple[str, ...]
    doors: NDArray[np.float32]  # (d, 4): x1 y1 x2 y2 of each leaf, its hinge first
    door_wanted: NDArray[np.bool_]  # (d,) open, or on its way to be
    door_opening: NDArray[np.float32]  # (d,) 0 = shut, 1 = open
    box_names: tuple[str, ...]
    boxes: NDArray[np.float32]  # (b, 6): x y width depth height angle of those that are there
    box_rgb: NDArray[np.uint8]  # (b, 3)
    person_names: tuple[str, ...]
    people: NDArray[np.float32]  # (p, 5): x y heading radius height of those who are there
    people_rgb: NDArray[np.uint8]  # (p, 3)
    lamp_names: tuple[str, ...]
    lamps: NDArray[np.float32]  # (l, 4): x y reach and 1 when it shines
    lamp_on: NDArray[np.bool_]  # (l,) its own switch; it shines when office.lamps is on, too
    daylight: float  # 1 = as painted


@dataclass(frozen=True, slots=True, eq=False)
class Movements:
    """The n local movements that the robot tried in this tick, from where it was then. Office frame."""

    paths: NDArray[np.float32]  # (n, k, 2): places along each
    length_m: NDArray[np.float32]  # (n,) of each path
    turned_rad: NDArray[np.float32]  # (n,) from beginning to end
    heading_rad: float  # at the beginning
    drives: NDArray[np.bool_]  # (n,) False: it only turns on the spot
    free: NDArray[np.bool_]  # (n,) no echo is too close to it
    chosen: int  # which of them


@dataclass(frozen=True, slots=True)
class OfficeEdition:
    """Which edition of the office this is, for editors."""

    number: int  # grows with every change of the world and with every other world
    undo: str  # what would be undone; empty: nothing
    redo: str
    saved: bool  # whether it is as last opened or saved
