"""What crosses between the engine's thread and the browser's: `Snapshot` out, `Command` in. Nothing else is shared.

Snapshots are immutable: frozen dataclasses over fresh read-only arrays. Parts that change seldom (world, map, times,
parameters, events) are the same object in the next snapshot while they are unchanged, so that `is` tells what to redraw.
Frames: `office` is the simulator's true frame, `map` the experience map's own (first experience at its origin), `cells`
are pose-cell indices [theta, y, x], one layer 10 degrees. SI units and radians.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from sim2d.world import World

# ---------------------------------------------------------------- out


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
    path: NDArray[np.float32]  # (p, 3): x, y (cells), heading (rad) of the winner over the last two minutes
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


@dataclass(frozen=True, slots=True)
class LinkReport:
    """One transition of the experience map. ACRA 2005 4.2, ACRA 2006 3.2."""

    start: int  # experience where it begins
    end: int
    distance_m: float
    bearing_rad: float  # to the end, relative to the start's facing
    facing_rad: float  # change of facing
    time_s: float  # mean over the passages
    behaviour: str  # under which it was learnt
    passages: int
    trials: int
    confidence: float  # share of the trials in which the robot arrived


@dataclass(frozen=True, slots=True)
class Times:
    """When something was there, seconds since the reset; None: not in this run."""

    first_s: float | None
    last_s: float | None
    visits: int  # how often it became active


@dataclass(frozen=True, slots=True, eq=False)
class HebbianReport:
    """What a view is linked to. ACRA 2004 eqs. 2-4."""

    count: int  # links to pose cells
    cells: NDArray[np.int32]  # (k, 3) theta, y, x of the strongest, strongest first, k <= 300
    strength: NDArray[np.float32]  # (k,)
    saturation: float  # a link injects no more than this


@dataclass(frozen=True, slots=True, eq=False)
class ExperienceReport:
    """One experience and all that hangs on it."""

    id: int
    cell: tuple[float, float, float]  # x', y' (cells), theta' (layers)
    view: int  # -1: made where there was nothing to see
    picture: NDArray[np.uint8] | None  # (h, w) or (h, w, 3) its stored view
    pose: Pose  # map frame
    zone_xy: float  # radius of its zone of influence, cells
    zone_theta: float  # layers
    energy: float  # how well the present state fits it, at most 2
    active: bool
    links: tuple[LinkReport, ...]  # that begin here, then that end here
    hebbian: HebbianReport  # of its view
    times: Times


@dataclass(frozen=True, slots=True, eq=False)
class ViewReport:
    """One local view cell: what it stands for, beside what is seen now."""

    id: int
    picture: NDArray[np.uint8]  # (h, w) or (h, w, 3) as it is stored
    now: NDArray[np.uint8]  # the same of what is seen now
    camera: NDArray[np.uint8]  # (h, w, 3) the image that it was made of
    difference: float  # between the two at the best shift, as in Senses
    threshold: float
    active: bool
    experiences: tuple[int, ...]  # that were made with it
    hebbian: HebbianReport
    times: Times


@dataclass(frozen=True, slots=True, eq=False)
class CellReport:
    """All pose cells above one x', y'."""

    x: int
    y: int
    by_heading: NDArray[np.float32]  # (n_theta,) activity
    packet: Packet | None  # to which most of it belongs; None: nothing is active here
    views: tuple[tuple[int, float], ...]  # linked here, with the sum of their links, strongest first, at most 24
    view_count: int  # how many are linked here
    experiences: tuple[int, ...]  # whose zone of influence this is in


Report = ExperienceReport | ViewReport | CellReport


@dataclass(frozen=True, slots=True)
class Timing:
    """What a part of a tick costs: over the last hundred ticks, milliseconds."""

    part: str
    mean_ms: float
    worst_ms: float


@dataclass(frozen=True, slots=True)
class TickStage:
    """One stage of a tick that is walked through."""

    name: str  # "image", "view match", "path integration", "injection", ...
    title: str
    words: str  # what it did, in a sentence


@dataclass(frozen=True, slots=True)
class TickWalk:
    """A tick that is shown stage by stage: the snapshot's pose cells, map and estimate are those of stage `at`."""

    stages: tuple[TickStage, ...]
    at: int


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


@dataclass(frozen=True, slots=True, eq=False)
class Goal:
    experience: int
    x: float  # map frame
    y: float
    state: str  # "tracking", "coasting", "exploring", "arrived", "unreachable"
    eta_s: float | None
    remaining_m: float | None
    route_xy: NDArray[np.float32]  # (r, 2) map frame, from the robot to the goal; empty when none is known
    route_arrival_s: NDArray[np.float32]  # (r,) seconds from now


@dataclass(frozen=True, slots=True)
class Event:
    """One mark on the timeline."""

    number: int
    time_s: float
    kind: str  # a key of NAMES in timeline.js
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
    trail: NDArray[np.float32]  # (t, 2) true path of the last two minutes, office frame
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
    occupancy: OccupancyLayer | None = None  # None without sonars
    goal_memory: GoalMemoryLayer | None = None
    living: LivingLayer | None = None  # None: nothing lives in this world
    inspected: Report | None = None
    active_experience: int = -1
    walk: TickWalk | None = None  # None: nothing is shown stage by stage
    presets: tuple[str, ...] = ()
    preset: str = ""  # the one whose values are all set
    office: OfficeEdition | None = None


# ---------------------------------------------------------------- in


class _Command(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


Finite = Annotated[float, Field(allow_inf_nan=False)]


class SetGoal(_Command):
    """Go to the experience nearest to this place of the map (metres, map frame)."""

    type: Literal["set_goal"]
    x: Finite
    y: Finite


class CancelGoal(_Command):
    type: Literal["cancel_goal"]


class SetMode(_Command):
    type: Literal["set_mode"]
    mode: Literal["explore", "manual", "goal"]


class Drive(_Command):
    """Drive by hand; expires 0.3 s after the last one. m/s forwards, rad/s counter-clockwise."""

    type: Literal["drive"]
    speed: Annotated[float, Field(ge=-0.5, le=0.5)]
    yaw_rate: Annotated[float, Field(ge=-1.6, le=1.6)]


class Kidnap(_Command):
    """Put the robot elsewhere (office frame) without telling it. Without a place: a free one by chance."""

    type: Literal["kidnap"]
    x: Finite | None = None
    y: Finite | None = None
    heading_rad: Finite | None = None


class Pause(_Command):
    type: Literal["pause"]


class Resume(_Command):
    type: Literal["resume"]


class Step(_Command):
    """Pause and advance by so many ticks of 0.1 s."""

    type: Literal["step"]
    ticks: Annotated[int, Field(ge=1, le=1000)] = 1


class SetSpeed(_Command):
    """Simulated seconds per second; 0 = as fast as possible."""

    type: Literal["set_speed"]
    factor: Annotated[float, Field(ge=0.0, le=1000.0)]


class Reset(_Command):
    """Start anew; what is left out stays as it is."""

    type: Literal["reset"]
    world: Annotated[str, Field(max_length=64)] | None = None
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] | None = None


class SetParameter(_Command):
    type: Literal["set_parameter"]
    name: Annotated[str, Field(max_length=64)]
    value: float | int | bool | Annotated[str, Field(max_length=64)]


_Name = Annotated[str, Field(min_length=1, max_length=40)]
_Size = Annotated[float, Field(ge=0.05, le=20.0)]


class SetDoor(_Command):
    """Open or shut a door of the office; it moves from the next tick on, and waits for who stands in it."""

    type: Literal["set_door"]
    name: _Name
    open: bool


class SetLamp(_Command):
    type: Literal["set_lamp"]
    name: _Name
    on: bool


class PutBox(_Command):
    """Put a box down (office frame, metres); refused where it would cover the robot. A reset takes it away."""

    type: Literal["put_box"]
    name: _Name
    x: Finite
    y: Finite
    width: _Size = 0.5
    depth: _Size = 0.5
    height: _Size = 0.6
    angle_rad: Finite = 0.0


class RemoveBox(_Command):
    type: Literal["remove_box"]
    name: _Name


class UsePreset(_Command):
    """Set the robot's sensors and encoders to a preset: "Pioneer 2DXE 2004" or "ideal"."""

    type: Literal["use_preset"]
    name: _Name


class StepStage(_Command):
    """Pause and show the next stage of a tick, or the one before; after the last stage the next tick begins."""

    type: Literal["step_stage"]
    back: bool = False


class InjectPacket(_Command):
    """Add a packet of activity at a place of the pose cells (cells and radians), to watch it compete: no sense says it.

    share: of all activity afterwards.
    """

    type: Literal["inject_packet"]
    x: Annotated[int, Field(ge=0)]
    y: Annotated[int, Field(ge=0)]
    heading_rad: Finite = 0.0
    share: Annotated[float, Field(ge=0.01, le=0.95)] = 0.45


class Inspect(_Command):
    """Choose what everybody looks at: an experience, a view, or the pose cells at x', y'; nothing of it: nothing.

    Changes nothing in the robot.
    """

    type: Literal["inspect"]
    experience: Annotated[int, Field(ge=0)] | None = None
    view: Annotated[int, Field(ge=0)] | None = None
    x: Annotated[int, Field(ge=0)] | None = None
    y: Annotated[int, Field(ge=0)] | None = None


OfficeList = Literal[
    "walls", "starts", "places", "doors", "lamps", "boxes", "people", "slow_zones", "script", "daylight"
]  # fmt: skip


class EditStep(_Command):
    """One item of one list of the world file: added at the end, changed, or deleted. `item` is written as in that file.

    `daylight` counts as a list of one item at most.
    """

    do: Literal["add", "change", "delete"]
    list: OfficeList
    number: Annotated[int, Field(ge=0, le=100_000)] | None = None  # of the item to change or delete, from 0
    item: dict[str, Any] | None = None  # to add, or to change into; a wall without a colour gets looks of its own


class EditWorld(_Command):
    """Change the office under the running robot, all steps or none. Refused when the world would not be sound, when the
    robot would be covered, or when the office is no longer the edition that the editor saw. Undone as one."""

    type: Literal["edit_world"]
    steps: Annotated[list[EditStep], Field(min_length=1, max_length=200)]
    edition: int | None = None


class UndoEdit(_Command):
    """Take the last change of the office back."""

    type: Literal["undo_edit"]


class RedoEdit(_Command):
    """Do again what was taken back last."""

    type: Literal["redo_edit"]


EditOrder = EditWorld | UndoEdit | RedoEdit
OfficeOrder = SetDoor | SetLamp | PutBox | RemoveBox | UsePreset
LookOrder = Inspect | StepStage | InjectPacket
Command = Annotated[
    SetGoal
    | CancelGoal
    | SetMode
    | Drive
    | Kidnap
    | Pause
    | Resume
    | Step
    | SetSpeed
    | Reset
    | SetParameter
    | OfficeOrder
    | EditOrder
    | LookOrder,
    Field(discriminator="type"),
]


@dataclass(frozen=True, slots=True)
class ReadExperience:
    """The answer's `result` is an ExperienceReport."""

    experience: int


@dataclass(frozen=True, slots=True)
class ReadBrain:
    """The answer's `result` is a snapshot of the whole brain, the engine's own."""


@dataclass(frozen=True, slots=True, eq=False)
class UseBrain:
    """Start anew in the same world with this brain, the engine's own class; what cannot be used is refused."""

    brain: object


class ReadWorld:
    """The answer's `result` is the World as it is now and its OfficeEdition."""


@dataclass(frozen=True, slots=True, eq=False)
class OpenWorld:
    """Begin anew in this world, which has been checked. The answer's `result` is the name that it got."""

    world: World
    filed: bool = True  # False: it is in no file yet, and would be lost


@dataclass(frozen=True, slots=True, eq=False)
class WorldSaved:
    """The world that was read has been saved, named as `world` is."""

    was: World
    world: World


@dataclass(frozen=True, slots=True)
class WorldDeleted:
    """The saved world of this name is in no file any more. Where it is open, it stays until another is opened."""

    name: str


@dataclass(frozen=True, slots=True)
class WorldRestored:
    """It is in its file again."""

    name: str
    title: str


Errand = (
    ReadExperience | ReadBrain | UseBrain | ReadWorld | OpenWorld | WorldSaved | WorldDeleted | WorldRestored
)  # what no command can hold; goes the same way


@dataclass(frozen=True, slots=True)
class Accepted:
    tick: int  # the tick before which the command took effect
    result: object = None  # what an errand asked for


@dataclass(frozen=True, slots=True)
class Refused:
    """Why a command did nothing: which field, its value, and what would be right."""

    field: str
    value: object
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A command or an errand on its way to the engine, with the place where its answer will appear."""

    command: Command | Errand
    answer: Future[Accepted | Refused]
