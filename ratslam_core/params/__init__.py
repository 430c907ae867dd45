"""Every number of the engine that somebody would tune, once. What is not tuned stands beside its use.

Sources: A = ACRA 2004, B = ACRA 2005, C = IROS 2005, D = ACRA 2006; "ours" where the papers are silent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from disk.parameter import check_ranges, param

COLUMNS, ROWS = 12, 8  # of a view
MOST_CELLS = 2**26  # of the pose cells, four bytes each: a brain has to fit into memory, and into its file

# Tables: the formatter would give each number a line
# fmt: off


@kind("parameters of pose cells/5")
@dataclass(frozen=True, slots=True)
class PoseCellParams:
    """The continuous attractor network (A section 4)."""

    n_x: int = param(64, "cells along x'", 8, 1000, "cells", symbol="n_x'", source="D 5.3", live=False, lecture=True)
    n_y: int = param(64, "cells along y'", 8, 1000, "cells", symbol="n_y'", source="D 5.3", live=False, lecture=True)
    n_theta: int = param(
        36, "layers of heading; 36 are 10 degrees each", 8, 360, "layers", symbol="n_θ'", source="A 4", live=False)
    cell_m: float = param(0.25, "side of one cell", 0.01, 100.0, "m", source="A 4, D 5.3", live=False)
    excite_sigma: float = param(
        0.5, "width of the excitation Gaussian", 0.2, 3.0, "cells", symbol="σ_ε", source="A eq. 10; value ours",
        lecture=True)
    inhibit: float = param(
        3e-4, "global inhibition taken from every cell", 0.0, 0.02, symbol="φ", source="A eq. 11; value ours",
        lecture=True)
    yaw_bias: float = param(
        0.0, "added to the yaw rate for the pose cells alone while the wheels turn: 0.0262 = 1.5 deg/s; 0 = as it is",
        -0.2, 0.2, "rad/s", symbol="b_θ'", source="B 5.2", lecture=True)

    def __post_init__(self) -> None:
        check_ranges(self)
        cells = self.n_x * self.n_y * self.n_theta
        if cells > MOST_CELLS:
            raise ValueError(f"n_x, n_y and n_theta must make at most {MOST_CELLS} cells together, got {cells}")


@kind("parameters of local view/3")
@dataclass(frozen=True, slots=True)
class LocalViewParams:
    """Recognising scenes (D section 7) and their Hebbian links to pose cells (A 4). They learn and inject once a beat."""

    front_end: str = param(
        "image and sonars", "what the features of a view are", source="D 7; A 3.3; B 7; B 5; ours", live=False,
        choices=("template", "complex cells", "hue and saturation",
        "scene numbers", "image and sonars", "limited levels", "laser"))
    match_threshold: float = param(
        1.0, "mean absolute difference up to which a view is recognised, in multiples of the front end's own", 0.0, 100.0,
        symbol="d_max", source="D 7; value ours", lecture=True)
    shift: int = param(2, "horizontal shifts tried to either side", 0, 5, "columns", source="D 7; value ours")
    facing: bool = param(True, "the shift of a recognised view gives the robot's heading relative to that view")
    field_of_view: float = param(
        math.radians(50), "width of the camera's view, to read headings from shifts", 0.1, 6.3, "rad",
        source="A 3, C IV.A")
    learning_rate: float = param(
        0.015, "Hebbian learning rate, times the activity of a view", 0.0, 1.0, symbol="η", source="C IV.C; 0.15 x 0.1",
        lecture=True)
    adaptive: bool = param(
        False, "the learning rate follows the strength of vision and the confidence of the estimate",
        source="A 6.3 (future work); ours")
    decay: float = param(0.0, "share of a link forgotten in each beat", 0.0, 1.0, symbol="δ", source="A eq. 2")
    most_links: int = param(600, "links to pose cells that a view keeps, the strongest; 0 = all", 0, 1_000_000)
    saturation: float = param(
        0.0007, "most that one link injects", 0.0, 1.0, symbol="s_max", source="A eq. 4; value ours", lecture=True)
    rest: float = param(10.0, "a view younger than this does not inject", 0.0, 1e6, "s")
    surprise: float = param(
        1.0, "difference from the image before that driving cannot explain, in multiples of the front end's own", 0.0,
        100.0)
    false_positives: float = param(
        0.0, "share of the recognised views that are taken for another known one", 0.0, 1.0, symbol="N_vis",
        source="D 5.1")
    enabled: bool = param(
        True, "vision; off = path integration only, in our map with what the echoes tell", source="A figures 9, 10")

    def __post_init__(self) -> None:
        check_ranges(self)


@kind("parameters of experience map/9")
@dataclass(frozen=True, slots=True)
class ExperienceMapParams:
    """Experiences, their links and the correction of the map (B 4, D 3)."""

    enabled: bool = param(
        True, "build an experience map; off = the packet's place in the pose cells is the robot's place, as in 2004",
        source="A", live=False)
    zone_xy: float = param(
        2.0, "zone of influence in x', y'", 0.5, 20.0, "cells", symbol="r_a", source="B 4.1, D eq. 2", lecture=True)
    zone_theta: float = param(2.0, "zone of influence in θ'", 0.5, 20.0, "layers", symbol="θ_a", source="D eq. 3")
    threshold: float = param(0.0, "a new experience is made when no energy is above this", 0.0, 2.0, source="B 4.1")
    match_view: bool = param(
        True, "only experiences of the current view have energy; off = only the pose cells count", symbol="E_V",
        source="B eq. 8")
    correction: float = param(
        0.5, "correction rate; 0.5 settles a node at once, 1 or more would oscillate for ever", 0.0, 0.95, symbol="α",
        source="B table 1, D 3.3", lecture=True)
    anchor_sigma: float = param(
        0.05, "error of a match per level of its difference; worse matches weigh less in map correction, 0 = all alike",
        0.0, 1.0, "m per level")
    odometry_drift: float = param(0.05, "growth of the odometry error with the distance driven", 0.0, 1.0, "m/m")
    submaps: bool = param(
        True, "a robot that was carried maps a submap, merged where evidence is strong; off = it believes each observation")
    zone_offset: bool = param(True, "the robot enters an experience's zone beside its centre; off = at its centre")
    best_observation: bool = param(
        True, "a transition is measured where the robot comes nearest to the experience; off = where it enters the zone")
    scan_matching: bool = param(
        True, "the sonars measure where the robot is to an old place, and whether it is there, and close loops; off = pose cells "
        "and view alone", live=False)
    odometry_edges: bool = param(
        True, "odometry also ties experiences made one after the other when known ones lie between", live=False)
    pace_floor: bool = param(True, "a link takes at least as long as its length in the map at the robot's average pace")
    link_confidence: float = param(
        0.2, "a link with less confidence is deleted; 0 = never", 0.0, 1.0, symbol="c_min", source="D 3.4; value ours")
    link_trials: int = param(5, "least trials before a link is deleted", 1, 1000, symbol="n_min")
    robust: bool = param(True, "outliers weigh less in the exact correction: observations and odometry that the map contradicts")
    calibrate: bool = param(True, "learn the bias of the yaw rate from what the map cannot explain")
    sweep: str = param(
        "by experience",
        "an experience is moved by the weighted mean of its links' residuals, by each link in turn, or all are by their "
        "sums, as printed, which diverges where the rate is too high", source="ours; B 4.3",
        choices=("by experience", "by link", "all at once"))
    sweeps: int = param(1, "correction sweeps in each beat", 0, 100, "1/beat", source="B 4.3")
    exact_solver: bool = param(True, "exact corrections beside the sweeps; off = sweeps alone", live=False)
    solve_every: int = param(
        50, "least time between exact corrections, in tenths of a second, made while loops close; 0 = never", 0, 10_000,
        "beats")
    bias_sigma: float = param(
        0.01,
        "prior standard deviation of the bias of the yaw rate; a few short loops cannot show more",
        1e-4, 10.0, "rad/s")
    familiar_ground: bool = param(
        True, "ground that is recognised often gets no more views and experiences; off = every new observation is kept",
        live=False)
    shortcut_m: float = param(
        0.0, "routes may cross between experiences closer than this in the map; 0 = only along links", 0.0, 5.0, "m",
        source="C VI; value ours")

    def __post_init__(self) -> None:
        check_ranges(self)


@kind("parameters of goal memory/3")
@dataclass(frozen=True, slots=True)
class GoalMemoryParams:
    """Times between places, learnt on the pose cells (C III)."""

    enabled: bool = param(True, "learn times between pose cells; off = no goal memory", source="C III")
    time_weight: float = param(1.0, "weight of the time between two iterations", 0.0, 10.0, symbol="α", source="C IV.C")
    activity_weight: float = param(
        0.25, "time added between weakly active cells", 0.0, 10.0, "s", symbol="β", source="C IV.C")
    distance_weight: float = param(
        0.1, "time added for the distance between cells", 0.0, 10.0, "s/cell", symbol="γ", source="C IV.C")
    rate: float = param(0.2, "weight of the newest time in a link's moving average", 0.01, 1.0, source="C III.A; ours")
    share: float = param(0.5, "cells below this share of the strongest are not linked", 0.0, 0.95)
    stride_m: float = param(
        0.5, "distance the packet moves before its cells are linked; 0 = linked in every iteration", 0.0, 5.0, "m")
    over_jumps: bool = param(
        False, "cells are linked across a jump of the packet, too; off = not, since the robot did not drive there",
        source="C; off is ours")

    def __post_init__(self) -> None:
        check_ranges(self)


@kind("parameters of occupancy/3")
@dataclass(frozen=True, slots=True)
class OccupancyParams:
    """Pictures of where the sonars met something (A 6.1, C V.A)."""

    enabled: bool = param(True, "draw the occupancy grids; off = no grids", source="A 6.1, C V.A")

    def __post_init__(self) -> None:
        check_ranges(self)


@kind("parameters of kidnap/5")
@dataclass(frozen=True, slots=True)
class KidnapParams:
    """When a jump of image and sonars counts as a kidnap. The papers' robots did not notice that they were carried."""

    enabled: bool = param(True, "notice a kidnap; off = a jump of the image is only another view", live=False)
    range_surprise: float = param(
        2.0, "how much a change of the sonars adds to the image's change; above 1 is a kidnap", 0.0, 10.0)

    def __post_init__(self) -> None:
        check_ranges(self)


@kind("parameters of evidence/4")
@dataclass(frozen=True, slots=True)
class EvidenceParams:
    """How much evidence a place needs before the robot believes it, and before its maps are merged."""

    believe: float = param(0.7, "log odds above which the robot believes a hypothesis", -10.0, 100.0, "nats")
    merge: float = param(6.9, "log odds above which submaps are merged", 0.0, 100.0, "nats")
    unnoticed: float = param(11.0, "log odds against having been carried unnoticed", 0.0, 100.0, "nats")

    def __post_init__(self) -> None:
        check_ranges(self)


@kind("parameters/2")
@dataclass(frozen=True, slots=True)
class RatSlamParams:
    """All of the engine."""

    pose_cells: PoseCellParams = PoseCellParams()
    local_view: LocalViewParams = LocalViewParams()
    experience_map: ExperienceMapParams = ExperienceMapParams()
    goal_memory: GoalMemoryParams = GoalMemoryParams()
    occupancy: OccupancyParams = OccupancyParams()
    kidnap: KidnapParams = KidnapParams()
    evidence: EvidenceParams = EvidenceParams()
