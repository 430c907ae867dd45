"""What the page shows, as it leaves the engine's thread: `Snapshot` and its parts.

Snapshots are immutable: frozen dataclasses over fresh read-only arrays. Parts that seldom change (world, map, times,
parameters, events) stay the same object from snapshot to snapshot while they are unchanged, so `is` tells what to
redraw. Frames: `office` is the simulator's true frame, `map` the experience map's own (first experience at its origin),
`cells` are pose-cell indices [theta, y, x], one layer 10 degrees. SI units and radians.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from web.messages.beside import BesideView
from web.messages.brain import (
    Belief,
    Goal,
    GoalMemoryLayer,
    MapLayer,
    OccupancyLayer,
    Pose,
    PoseCellLayer,
    Senses,
    TaggedPlace,
    TimesLayer,
)
from web.messages.judged import Closure, Ghost, KnownPlace, Spread
from web.messages.lesson import LessonView, UntilView
from web.messages.office import LivingLayer, Movements, OfficeEdition, WorldDrawing
from web.messages.pairs import AdditionsOff, PairChoice
from web.messages.recording import RecordingView
from web.messages.reports import Report
from web.messages.situation import SituationView
from web.messages.tick import TickWalk, Timing
from web.messages.time import TimeView
from web.messages.trial import TrialView

EventKind = Literal[
    "kidnap", "lost", "believes", "joined", "corrected", "recovered", "snap", "goal", "arrived", "unreachable", "packet",
    "brain", "office", "parameter", "link", "place", "false", "warning", "fault", "trial", "tagged", "reached", "failed",
    "closure", "branch", "recording", "lesson",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Event:
    """One mark on the timeline. What repeats is one line that counts: with each time it gets a new number, time and text."""

    number: int
    time_s: float
    kind: EventKind
    text: str
    line: str = ""  # its name, where it repeats: the newest event of a line stands for all
    count: int = 1
    since_s: float | None = None  # when the first of them happened, where they are more than one


@dataclass(frozen=True, slots=True)
class Parameter:
    name: str  # dotted, as in `ratslam config`
    value: float | int | bool | str
    default: float | int | bool | str
    symbol: str
    unit: str
    low: float | None
    high: float | None
    meaning: str
    source: str
    live: bool  # False: takes effect with the next reset
    choices: tuple[str, ...] = ()  # the texts that it may be; empty for numbers and switches


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Errors and counts against time since the reset, at most 600 points, evenly thinned."""

    time_s: NDArray[np.float64]
    map_error_m: NDArray[np.float64]
    odometry_error_m: NDArray[np.float64]
    views: NDArray[np.float64]
    experiences: NDArray[np.float64]
    residual_mm: NDArray[np.float64]  # by how much links and map disagree, root mean square
    residual_mrad: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """The session at the end of one tick."""

    run: int  # grows with each reset
    tick: int
    time_s: float
    mode: Literal["explore", "manual", "goal", "recorded"]
    doing: str  # what the pilot does now, for people: "following the wall", "looking back", ...
    running: bool
    speed: float  # asked-for multiple of real time; inf = as fast as possible
    real_time_factor: float  # measured
    seed: int
    fault: str | None  # why the session stopped by itself
    lost: bool  # packets compete
    world: WorldDrawing | None  # None: a recording plays that has no truth
    worlds: tuple[tuple[str, str], ...]  # (name, title) of all that reset can load
    truth: Pose | None  # office frame; None: the source does not know it
    trail: NDArray[np.float32]  # (t, 2) true path of the last two minutes of driving, office frame
    estimate: Pose  # map frame
    senses: Senses
    pose_cells: PoseCellLayer
    map: MapLayer
    times: TimesLayer
    goal: Goal | None
    views: int
    experiences: int
    links: int
    relocalisations: int
    coverage: float | None  # share of the floor from which the robot can drive to its path within a metre
    error_map_m: float | None  # None without truth
    error_odometry_m: float | None
    revisit_consistency: float | None  # share of revisits within half a metre
    series: Series
    timings: tuple[Timing, ...]  # the parts of a tick, in their order
    events: tuple[Event, ...]
    parameters: tuple[Parameter, ...]
    no_room: Callable[[float, float], str | None]  # why the robot cannot be put there (office frame); None: it fits
    occupancy: OccupancyLayer | None = None  # None without sonars
    goal_memory: GoalMemoryLayer | None = None
    movements: Callable[[], Movements] | None = None  # works on copies, in any thread; None: the robot chose no arc
    living: LivingLayer | None = None  # None: nothing lives in this world
    switches: tuple[str, ...] = ()  # those parameters of `office` that do something in this world
    inspected: Report | None = None
    active_experience: int = -1
    walk: TickWalk | None = None  # None: nothing is shown stage by stage
    presets: tuple[str, ...] = ()
    preset: str = ""  # the preset whose values are all set; empty: none
    office: OfficeEdition | None = None
    belief: Belief | None = None  # None: there is no experience map
    recording: RecordingView | None = None  # None: the simulator runs
    trial: TrialView | None = None  # None: no trial of an experiment was begun in this run
    lesson: LessonView | None = None  # None: no lesson was begun in this run
    until: UntilView | None = None  # None: nothing is or was waited for
    tags: tuple[TaggedPlace, ...] = ()  # in the order in which they were given
    situation: SituationView | None = None  # None: the run is no situation that was opened
    time: TimeView | None = None  # None: nothing of this run can be gone back to
    beside: BesideView | None = None  # None: one brain only
    pairs: tuple[PairChoice, ...] = ()  # brains that could be compared with the first
    additions_off: AdditionsOff = AdditionsOff()
    map_turn_rad: float = 0.0  # turns the map, for the eye only, so that it lies as the office does
    map_in_office: Pose | None = (
        None  # the map's frame by the fit after which `error_map_m` is measured; None without truth
    )
    ghost: Ghost | None = None  # None without truth
    spread: Spread | None = None  # None without a map
    closures: tuple[Closure, ...] = ()  # of late, oldest first
    places: tuple[KnownPlace, ...] = ()  # of the office, by name

    def sought(self, last: Snapshot | None) -> bool:
        """Whether somebody asked for this moment of the past and waits for it. last: what was shown before."""
        if last is None or self.time is None or last.time is None or self.running:
            return False
        return (self.time.past or last.time.past) and (self.run, self.tick) != (last.run, last.tick)
