"""Two brains on the same senses: the second one as it is drawn, and how the two differ. Parts of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from web.messages.brain import Goal, Hypothesis, MapLayer, Pose, PoseCellLayer, TimesLayer

Kind = Literal["packet", "view", "experience", "link"]


@dataclass(frozen=True, slots=True)
class BrainFigures:
    """One of two brains in figures."""

    name: str
    views: int
    experiences: int
    links: int
    relocalisations: int
    error_map_m: float | None  # None without truth
    off_m: (
        float | None
    )  # how far the robot is from where this brain believes it to be, judged by where its experience was made
    lost: bool


@dataclass(frozen=True, slots=True)
class Difference:
    """What two brains differ in, and since when."""

    kind: Kind
    tick: int
    time_s: float
    words: str


@dataclass(frozen=True, slots=True)
class Changed:
    """A parameter in which two brains differ: its dotted name, and its value in each."""

    name: str
    first: float | int | bool | str
    second: float | int | bool | str


@dataclass(frozen=True, slots=True, eq=False)
class BesideView:
    """The second brain is drawn as the first; its map lies in a frame of its own."""

    first: BrainFigures
    second: BrainFigures
    since_s: float  # when the second began; at 0 it began as a new one, later as a copy of the first
    error_odometry_m: float | None
    differences: tuple[Difference, ...]  # the earliest first
    changed: tuple[Changed, ...]  # what makes the difference
    pose_cells: PoseCellLayer
    map: MapLayer
    times: TimesLayer
    estimate: Pose
    others: tuple[Hypothesis, ...]  # where it may be instead, the likeliest first
    goal: Goal | None  # where the first is sent to: the same place, and the way to it, in this map
    map_turn_rad: float
