"""Where on the run's timeline the page is: live or in the past, on which branch, and between which marks it loops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from web.messages.brain import Packet, Pose


@dataclass(frozen=True, slots=True)
class BranchView:
    """One line of time. It left its parent's at `from_s` (simulated seconds)."""

    number: int
    parent: int | None  # None: the run as it began
    from_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Bookmark:
    """A moment that somebody has named."""

    tick: int
    time_s: float
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One of two branches that are shown side by side, at one moment or at its end. Map frame, metres."""

    number: int
    time_s: float
    error_map_m: float | None
    error_odometry_m: float | None
    views: int
    experiences: int
    links: int
    packet: Packet
    xy: NDArray[np.float32]  # (n, 2) some of the experiences
    robot: Pose
    turn_rad: float  # turns the map to lie as the office does


@dataclass(frozen=True, slots=True)
class TimeView:
    """The live branch goes to `end_s`; `past`: what is shown is an earlier moment of it."""

    past: bool
    end_tick: int
    end_s: float
    begin_s: float  # nothing before it can be shown
    branch: int
    branches: tuple[BranchView, ...]
    loop: tuple[float, float] | None  # simulated seconds, between which the past is played again and again
    sides: tuple[Side, ...] = ()  # the live branch and the one that it is compared with; empty: with none
    bookmarks: tuple[Bookmark, ...] = ()  # of the live branch, by tick
    differs: str = ""  # in words, where these two differ first
    doing: str = ""  # what the page waits for, in words; empty: nothing
    done: float = 0.0  # the share of it that is done
