"""What the page shows, out of the engine's thread: `Snapshot` and its parts.

Snapshots are immutable: frozen dataclasses over fresh read-only arrays. Parts that change seldom (world, map, times,
parameters, events) are the same object in the next snapshot while they are unchanged, so that `is` tells what to redraw.
Frames: `office` is the simulator's true frame, `map` the experience map's own (first experience at its origin), `cells`
are pose-cell indices [theta, y, x], one layer 10 degrees. SI units and radians.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from web.messages.reports import Report
from web.messages.tick import TickWalk, Timing


@dataclass(frozen=True, slots=True)
class Pose:
    """A place and a heading: metres and radians in (-pi, pi], counter-clockwise, 0 = +x."""

    x: float
    y: float
    heading_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class WorldDrawing:
    """All that the stage needs to draw an office. Office frame."""

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


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet of pose-cell activity: its centre in cells (fractions), its heading, its share of the activity, its id."""

    x: float
    y: float
    heading_rad: float
    mass: float
    id: int = 0  # the same for as long as the packet lives


@dataclass(frozen=True, slots=True)
class Snap:
    """A relocalisation: the winning packet's centre went from start S to end F (pose-cell frame, cells)."""

    time_s: float
    start: Packet
    end: Packet


@dataclass(frozen=True, slots=True, eq=False)
class PoseCellLayer:
    shape: tuple[int, int, int]  # n_theta, n_y, n_x
    cell_m: float
    cells: NDArray[np.int32]  # (k, 3): theta, y, x of the strongest active cells, strongest first, k <= 500
    activity: NDArray[np.float32]  # (k,)
    active_cells: int  # how many are active in all
    packets: tuple[Packet, ...]  # strongest first
    path: NDArray[np.float32]  # (p, 3): x, y (cells), heading (rad) of the winner's last two minutes of driving
    last_snap: Snap | None
    total: float = 1.0  # of all activity
    least: float = 0.0  # of the active cells


@dataclass(frozen=True, slots=True, eq=False)
class Senses:
    """What the robot sees now and what it reminds it of."""

    camera: NDArray[np.uint8]  # (h, w, 3) RGB
    front_end: str  # what views are made of
    seen: NDArray[np.uint8]  # (h, w) grey or (h, w, 3) RGB: what the front end makes of the image
    seen_words: str
    best: NDArray[np.uint8] | None  # the same of the best stored view
    best_words: str
    best_view: int  # its number, -1 when there is none
    difference: float  # to it, in levels of the front end; inf when there is none
    threshold: float
    active_view: int  # the view that is active now, -1 when there is nothing to see
    recruited: bool  # the active view is new
    false_positive: bool  # the active view was put in the place of the best one
    false_positives: int  # so far
    ranges_m: NDArray[np.float32]  # (8,) sonar


@dataclass(frozen=True, slots=True, eq=False)
class MapLayer:
    """The experience map. Map frame."""

    ids: NDArray[np.int32]  # (n,)
    xy: NDArray[np.float32]  # (n, 2)
    heading_rad: NDArray[np.float32]  # (n,)
    links: NDArray[np.int32]  # (m, 2): rows into ids


@dataclass(frozen=True, slots=True, eq=False)
class TimesLayer:
    """The temporal map: seconds to the goal when there is one, else from the robot. inf = no way known."""

    to_goal: bool
    seconds: NDArray[np.float32]  # (n,), rows as in the MapLayer of the same snapshot


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyPicture:
    """Where something stands, in the map frame. 0.5 = unknown."""

    probability: NDArray[np.float32]  # (n_y, n_x)
    origin_xy_m: tuple[float, float]  # the middle of cell [0, 0]
    cell_m: float


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyLayer:
    """What the sonars met. `draw_map` takes tens of milliseconds: for whoever shows it, in a thread of their own."""

    cells: NDArray[np.float32]  # (n_y, n_x) probability in the pose cells' frame
    draw_map: Callable[[], OccupancyPicture]  # from copies: the same picture whenever it is called


@dataclass(frozen=True, slots=True, eq=False)
class GoalMemoryLayer:
    """The goal memory on the pose cells' plane."""

    links: int
    goal: tuple[int, int] | None  # the goal's cell x', y'
    seconds: NDArray[np.float32] | None  # (n_y, n_x) to the goal, inf where no way is known; None without a goal
    direction_rad: float | None  # in which they decrease fastest at the packet; None there and where no way is known


GoalState = Literal["tracking", "coasting", "exploring", "arrived", "unreachable"]


@dataclass(frozen=True, slots=True, eq=False)
class Goal:
    experience: int
    x: float  # map frame
    y: float
    state: GoalState
    eta_s: float | None
    remaining_m: float | None
    route_xy: NDArray[np.float32]  # (r, 2) map frame, from the robot to the goal; empty when none is known
    route_arrival_s: NDArray[np.float32]  # (r,) seconds from now


EventKind = Literal[
    "kidnap", "lost", "recovered", "snap", "goal", "arrived", "unreachable", "packet", "brain", "office", "parameter",
    "link", "place", "false", "warning", "fault",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Event:
    """One mark on the timeline."""

    number: int
    time_s: float
    kind: EventKind
    text: str


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
    choices: tuple[str, ...] = ()  # of text; empty for numbers and switches


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


@dataclass(frozen=True, slots=True)
class OfficeEdition:
    """Which state of the office this is, for editors."""

    number: int  # grows with every change of the world and every other world
    undo: str  # what would be taken back; empty: nothing
    redo: str
    saved: bool  # as it was opened or saved last


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """The session at the end of one tick."""

    run: int  # grows with each reset
    tick: int
    time_s: float
    mode: Literal["explore", "manual", "goal"]
    doing: str  # what the pilot does now, for people: "following the wall", "looking back", ...
    running: bool
    speed: float  # asked-for multiple of real time; inf = as fast as possible
    real_time_factor: float  # measured
    seed: int
    fault: str | None  # why the session stopped by itself
    lost: bool  # packets compete
    world: WorldDrawing
    worlds: tuple[tuple[str, str], ...]  # (name, title) of all that reset can load
    truth: Pose  # office frame
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
    error_map_m: float
    error_odometry_m: float
    revisit_consistency: float | None  # share of revisits within half a metre
    series: Series
    timings: tuple[Timing, ...]  # the parts of a tick, in their order
    events: tuple[Event, ...]
    parameters: tuple[Parameter, ...]
    no_room: Callable[[float, float], str | None]  # why the robot cannot be put there (office frame), None: it fits
    occupancy: OccupancyLayer | None = None  # None without sonars
    goal_memory: GoalMemoryLayer | None = None
    living: LivingLayer | None = None  # None: nothing lives in this world
    switches: tuple[str, ...] = ()  # those parameters of `office` that do something in this world
    inspected: Report | None = None
    active_experience: int = -1
    walk: TickWalk | None = None  # None: nothing is shown stage by stage
    presets: tuple[str, ...] = ()
    preset: str = ""  # the one whose values are all set
    office: OfficeEdition | None = None
    map_turn_rad: float = 0.0  # of the map's frame in the office's, for the eye: turned so it lies as the office does
