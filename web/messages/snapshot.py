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

from web.messages.brain import (
    Belief,
    BesideView,
    Closure,
    Ghost,
    Goal,
    GoalMemoryLayer,
    KnownPlace,
    MapLayer,
    OccupancyLayer,
    Packet,
    Pose,
    PoseCellLayer,
    Senses,
    Spread,
    TaggedPlace,
    TickWalk,
    TimesLayer,
    Timing,
    Trip,
)
from web.messages.reports import Report
from web.messages.situation import SituationView


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
    """Where on the run's timeline the page is. The live branch goes to `end_s`; `past`: what is shown is an earlier moment of
    it."""

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


LessonState = Literal["scene", "predict", "showing", "compared", "sandbox"]
UntilState = Literal["running", "met", "too late", "broken off"]


@dataclass(frozen=True, slots=True)
class LessonMark:
    """Something that happened, where it happened: m and rad, in the frame of its plate; among the pose cells x and y are cells.

    start: among the pose cells, where it came from: x and y in cells, and the heading.
    """

    plate: Literal["office", "map", "cells"]
    x: float
    y: float
    heading_rad: float | None
    words: str
    tick: int
    start: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class LessonPrediction:
    """An option by its number, from 0, or a point on the lesson's plate, m."""

    choice: int | None = None
    x: float | None = None
    y: float | None = None


@dataclass(frozen=True, slots=True)
class LessonVotes:
    """What the class predicts: votes for each option, or the points that were drawn."""

    counts: tuple[int, ...]
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class LessonOutcome:
    """What happened, beside what was predicted. right: None if nothing was predicted.

    choice: the option that came true; x, y: where it ended, m, on the lesson's plate; distance_m: from the prediction.
    """

    words: str
    because: str
    right: bool | None
    choice: int | None = None
    x: float | None = None
    y: float | None = None
    distance_m: float | None = None


@dataclass(frozen=True, slots=True)
class LessonView:
    """What the page tells of the lesson. Its texts: GET /api/lessons/NAME."""

    name: str
    title: str
    state: LessonState
    doing: str
    progress: float | None  # of the scene, or of what is shown
    round: int  # from 1; a lesson may be shown several times over, with other settings
    rounds: int
    label: str  # of the round
    seed: int
    prediction: LessonPrediction | None
    votes: LessonVotes
    outcome: LessonOutcome | None
    marks: tuple[LessonMark, ...]
    altered: bool  # somebody has changed something: it is no longer what the lesson promises
    draws: Literal["office", "map"] | None = None  # the plate on which a place is predicted; None: options are


@dataclass(frozen=True, slots=True)
class UntilView:
    """What `run_until` waits for, and how it ended. progress: share of the time that it may take."""

    what: str
    words: str
    state: UntilState
    progress: float


@dataclass(frozen=True, slots=True)
class RecordingView:
    """The recording that is played."""

    name: str
    format: str  # "Donkey tub", "MCAP", ...
    moments: int
    seconds: float
    has: tuple[str, ...]  # "camera", "speed", "truth", ...
    over: bool  # its last moment has been played


TrialState = Literal["running", "over", "ended"]  # ended: by somebody's own orders, before it was over


@dataclass(frozen=True, slots=True)
class TrialView:
    """The trial of an experiment that somebody watches."""

    experiment: str
    title: str
    engine: str
    levels: tuple[str, ...]  # of each axis, by label
    seed: int
    id: str
    state: TrialState
    doing: str  # "exploring", "on the way to printer"
    about_s: float  # how long it is, about, in simulated seconds
    ahead: float | None  # share done of running ahead to its moment; None: it runs at its pace
    altered: bool  # somebody has changed office or parameters: it is no longer the trial that it was
    outcome: str  # when it is over or ended, in words


Since = Literal["beginning", "now"]


@dataclass(frozen=True, slots=True)
class PairChoice:
    """A brain that is worth comparing with the first as it is now; app/config/presets.py makes them.

    since: the run begins anew with both, or goes on with a copy that can become such a brain while it runs.
    """

    name: str
    title: str
    about: str
    since: Since


@dataclass(frozen=True, slots=True)
class AdditionsOff:
    """Our additions that the first brain lacks, by name: if it began again, and as it runs."""

    beginning: tuple[str, ...] = ()
    now: tuple[str, ...] = ()


EventKind = Literal[
    "kidnap", "lost", "believes", "joined", "corrected", "recovered", "snap", "goal", "arrived", "unreachable", "packet",
    "brain", "office", "parameter", "link", "place", "false", "warning", "fault", "trial", "tagged", "reached", "failed",
    "closure", "explored", "branch", "recording", "lesson",
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
    lecture: bool = False  # one of the dozen that Tune opens with


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Errors and counts against time since the reset, at most 600 points, evenly thinned."""

    time_s: NDArray[np.float64]
    map_error_m: NDArray[np.float64]
    odometry_error_m: NDArray[np.float64]
    explored_percent: NDArray[np.float64]  # of the floor, within a metre of the path; NaN without an office
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
    trip: Trip | None = None  # while the robot explores on purpose
    tags: tuple[TaggedPlace, ...] = ()  # in the order in which they were given
    back: bool = False  # a run waits whose place this one has
    stepping: bool = False  # paused, but for ticks that were asked for
    situation: SituationView | None = None  # None: the run is no situation that was opened
    time: TimeView | None = None  # None: nothing of this run can be gone back to
    beside: BesideView | None = None  # None: one brain only
    pairs: tuple[PairChoice, ...] = ()  # brains that could be compared with the first
    additions_off: AdditionsOff = AdditionsOff()
    map_turn_rad: float = 0.0  # turns the map, for the eye only, so that it lies as the office does
    map_in_office: Pose | None = None  # the map's frame, fitted as for `error_map_m`; None without truth
    ghost: Ghost | None = None  # None without truth
    spread: Spread | None = None  # None without a map
    closures: tuple[Closure, ...] = ()  # of late, oldest first
    places: tuple[KnownPlace, ...] = ()  # of the office, by name

    def sought(self, last: Snapshot | None) -> bool:
        """Whether somebody asked for this moment of the past and waits for it. last: what was shown before."""
        if last is None or self.time is None or last.time is None or self.running:
            return False
        return (self.time.past or last.time.past) and (self.run, self.tick) != (last.run, last.tick)
