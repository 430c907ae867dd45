"""What the robot senses, what it believes, where it is going, what only people are shown, one tick in detail, and a second brain
on the same senses. Parts of a snapshot.

The map frame is the experience map's own (first experience at its origin); pose cells are indices [theta, y, x], one layer
10 degrees. SI units and radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

NO_PLACES: NDArray[np.float32] = np.zeros((0, 2), np.float32)
NO_PLACES.setflags(write=False)


@dataclass(frozen=True, slots=True)
class Pose:
    """A place and a heading: metres and radians in (-pi, pi], counter-clockwise, 0 = +x."""

    x: float
    y: float
    heading_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Senses:
    """What the robot sees now, and the stored view that is most like it."""

    camera: NDArray[np.uint8]  # (h, w, 3) RGB; without pixels: there is no camera, or it is off
    front_end: str  # the name of the front end
    seen: NDArray[np.uint8]  # (h, w) grey or (h, w, 3) RGB: what the front end makes of the image
    seen_words: str
    best: NDArray[np.uint8] | None  # the same for the best stored view
    best_words: str
    best_view: int  # its number, -1 when there is none
    difference: float  # from it, in levels of the front end; inf when there is none
    threshold: float
    active_view: int  # the view that is active now, -1 when there is nothing to see
    recruited: bool  # the active view is new
    false_positive: bool  # the active view was put in the place of the best one
    false_positives: int  # so far
    ranges_m: NDArray[np.float32]  # (8,) sonar


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet of pose-cell activity: its centre in cells (fractions), its heading, its share of the activity, its id."""

    x: float
    y: float
    heading_rad: float
    mass: float
    id: int = 0  # the same for as long as the packet lives


@dataclass(frozen=True, slots=True)
class SnapCause:
    """A view whose links put activity where a snap has led."""

    view: int
    looks: int  # ticks in which it did, since the packet came into being
    amount: float  # of activity in all of them
    share: float  # of what all views put there
    links: int  # to cells around the packet
    strongest: float  # of these links
    age_s: float  # since the view was learnt


@dataclass(frozen=True, slots=True)
class Snap:
    """A relocalisation: the winning packet's centre went from start S to end F (pose-cell frame, cells)."""

    time_s: float
    start: Packet
    end: Packet
    causes: tuple[SnapCause, ...] = ()  # those that injected most first


FLAT = (0.5, 1.0, 1.0)  # theta', y', x': one layer counts as half a cell


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

    def owners(self) -> NDArray[np.int64]:
        """(k,) rows of `packets`: the packet nearest to each cell, around the torus; 0 when there are no packets."""
        if not self.packets:
            return np.zeros(len(self.cells), np.int64)
        turn = self.shape[0] / math.tau
        centres = np.array([[p.heading_rad % math.tau * turn, p.y, p.x] for p in self.packets])
        gaps = np.abs(self.cells[:, None] - centres[None])
        size = np.array(self.shape)
        gaps = np.minimum(gaps % size, -gaps % size)
        return ((gaps * FLAT) ** 2).sum(2).argmin(1)


@dataclass(frozen=True, slots=True, eq=False)
class MapLayer:
    """The experience map. Map frame."""

    ids: NDArray[np.int32]  # (n,)
    xy: NDArray[np.float32]  # (n, 2)
    heading_rad: NDArray[np.float32]  # (n,)
    links: NDArray[np.int32]  # (m, 2): rows into ids
    visited_xy: NDArray[np.float32] = field(default_factory=lambda: NO_PLACES)
    """(4, 2) corners of where the robot has believed to be, where there are only the pose cells, as in 2004."""

    @property
    def extent_xy(self) -> NDArray[np.float32]:
        """(k, 2) places between which all of it lies, the robot as well."""
        return np.concatenate([self.xy, self.visited_xy])


@dataclass(frozen=True, slots=True, eq=False)
class TimesLayer:
    """The temporal map: seconds to the goal when there is one, else from the robot. inf = no route known."""

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
    """What the sonars met. `draw_map` takes tens of milliseconds, so call it in another thread, and only to show it."""

    cells: NDArray[np.float32]  # (n_y, n_x) probability in the pose cells' frame
    draw_map: Callable[[], OccupancyPicture]  # works on copies, so the picture is the same whenever it is called


@dataclass(frozen=True, slots=True, eq=False)
class GoalMemoryLayer:
    """The goal memory on the pose cells' plane."""

    links: int
    goal: tuple[int, int] | None  # the goal's cell x', y'
    seconds: NDArray[np.float32] | None  # (n_y, n_x) to the goal, inf where no way is known; None without a goal
    direction_rad: float | None  # where they fall fastest at the packet; None at the goal or without a way


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A place where the robot may be instead of where it believes itself to be. Map frame."""

    x: float
    y: float
    heading_rad: float
    share: float  # how likely it is, 0 to 1
    cells: tuple[float, float, float] | None = None  # its state of the pose cells: x', y' (cells), heading (rad)


@dataclass(frozen=True, slots=True)
class Belief:
    """How sure the robot is of its place, and what it doubts. Map frame."""

    off_m: float  # how far off it may be; inf: it does not know
    others: tuple[Hypothesis, ...]  # the likeliest first
    corrected: int  # how often evidence proved it elsewhere: carried unnoticed, slipped, or merged where it was not
    apart: int  # experiences on submaps other than the robot's
    joined: int  # submaps that were merged
    spared: int  # observations on familiar ground that became no experience
    links_spared: int  # links between places that had enough of them
    forgotten: int  # links of views to pose cells
    odds: float | None = None  # of its believed place against all else; None: not carried, or it believes nothing
    places: int = 0  # where a robot that was carried may be


@dataclass(frozen=True, slots=True)
class TaggedPlace:
    """A place that somebody has named. Map frame."""

    name: str
    experience: int
    x: float
    y: float


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
    # (k, 2) map frame, of all experiences that stand for the goal
    places_xy: NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 2), np.float32))
    lost: bool = False  # the robot does not know where it is, and so only believes what it says of the goal
    followed: bool = True  # the robot is on its way there, or there: nobody drives it, nor was it told to explore
    why: str = ""  # no route is known, in a few words


@dataclass(frozen=True, slots=True, eq=False)
class Trip:
    """[ours] Where the robot explores, and why. Map frame."""

    x: float
    y: float
    reason: str
    openings_xy: NDArray[np.float32]  # (k, 2) open floor that it saw and never drove on
    beside: bool = False  # the robot is so near that the reason, written there, would lie over it


@dataclass(frozen=True, slots=True, eq=False)
class Ghost:
    """The robot as it would be if it believed its wheels alone, in the frame of where the run began."""

    pose: Pose
    path: NDArray[np.float32]  # (n, 2) of the last two minutes, the newest last
    office_start: Pose  # that frame in the office
    map_start: Pose  # that frame in the map, as the map is now


@dataclass(frozen=True, slots=True)
class Spread:
    """[ours] How far off the estimate may be: one standard deviation, as an ellipse around it. Map frame."""

    along_m: float
    across_m: float
    turn_rad: float  # of `along`
    by: str  # "filter" or "packet": what tells it


@dataclass(frozen=True, slots=True, eq=False)
class Closure:
    """A loop closure, with the map before it and after its correction. Map frame; n experiences were known then."""

    event: int  # its number on the timeline
    time_s: float
    start: int  # the link that closed the loop leads from this experience
    end: int  # to this one
    links: NDArray[np.int32]  # (m, 2)
    before_xy: NDArray[np.float32]  # (n, 2)
    after_xy: NDArray[np.float32]  # (n, 2), some seconds later
    moved_m: float = 0.0  # how far the experience moved that moved farthest


@dataclass(frozen=True, slots=True)
class KnownPlace:
    """A place of the office by its name, and where the map has it; None: the robot has not been near it."""

    name: str
    x: float  # office frame
    y: float
    map_xy: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class Timing:
    """What a part of a tick costs, in milliseconds, over the last hundred ticks."""

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
    """A tick shown stage by stage. The snapshot's pose cells, map and estimate are those of stage `at`."""

    stages: tuple[TickStage, ...]
    at: int


@dataclass(frozen=True, slots=True)
class BrainFigures:
    """One of two brains in figures."""

    name: str
    views: int
    experiences: int
    links: int
    relocalisations: int
    error_map_m: float | None  # None without truth
    off_m: float | None  # from the robot to where this brain believes it to be, judged by where its experience was made
    lost: bool


@dataclass(frozen=True, slots=True)
class Difference:
    """What two brains differ in, and since when."""

    kind: Literal["packet", "view", "experience", "link"]
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
