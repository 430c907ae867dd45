"""Every number of the engine, once: default, symbol, unit, range, meaning and source.

Sources: A = ACRA 2004, B = ACRA 2005, C = IROS 2005, D = ACRA 2006; "ours" where the papers are silent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ratslam_core.parameter import check_ranges, param


@dataclass(frozen=True, slots=True)
class PoseCellParams:
    """The continuous attractor network (A section 4)."""

    n_x: int = param(
        64, symbol="n_x'", unit="cells", low=8, high=1000, meaning="cells along x'", source="D 5.3", live=False
    )
    n_y: int = param(
        64, symbol="n_y'", unit="cells", low=8, high=1000, meaning="cells along y'", source="D 5.3", live=False
    )
    n_theta: int = param(
        36,
        symbol="n_θ'",
        unit="layers",
        low=8,
        high=360,
        meaning="layers of heading; 36 are 10 degrees each",
        source="A 4",
        live=False,
    )
    cell_m: float = param(
        0.25, unit="m", low=0.01, high=100.0, meaning="side of one cell", source="A 4, D 5.3", live=False
    )
    excite_sigma: float = param(
        0.5,
        symbol="σ_ε",
        unit="cells",
        low=0.2,
        high=3.0,
        meaning="width of the excitation Gaussian",
        source="A eq. 10; value ours",
    )
    excite_radius: int = param(
        2, unit="cells", low=1, high=9, meaning="reach of the excitation", source="A eq. 10; value ours"
    )
    inhibit: float = param(
        3e-4,
        symbol="φ",
        low=0.0,
        high=0.02,
        meaning="global inhibition taken from every cell",
        source="A eq. 11; value ours",
    )
    local_inhibit: float = param(
        0.0, low=0.0, high=1.0, meaning="strength of local inhibition, 0 = off", source="later RatSLAM"
    )
    local_inhibit_sigma: float = param(
        2.0, unit="cells", low=0.5, high=5.0, meaning="width of the local inhibition", source="later RatSLAM"
    )
    local_inhibit_radius: int = param(
        2, unit="cells", low=1, high=9, meaning="reach of the local inhibition", source="later RatSLAM"
    )
    window: int = param(
        6, unit="cells", low=2, high=12, meaning="half-width of the window that holds one packet", source="ours"
    )
    carry: bool = param(True, meaning="give back the motion that the attractor swallows", source="ours")
    snap_cells: float = param(
        3.0,
        unit="cells",
        low=1.0,
        high=100.0,
        meaning="a longer jump of the winning packet is a relocalisation",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, slots=True)
class LocalViewParams:
    """Recognising scenes (D section 7) and their Hebbian links to pose cells (A 4)."""

    front_end: str = param(
        "template",
        choices=("template", "complex cells", "hue and saturation", "scene numbers"),
        meaning="what a view is made of",
        source="D 7; A 3.3; B 7; B 5",
        live=False,
    )
    match_threshold: float = param(
        6.0,
        unit="grey levels",
        low=0.0,
        high=255.0,
        meaning="mean absolute difference below which a view is recognised",
        source="D 7; value ours",
    )
    edge_threshold: float = param(
        6.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="the same for complex cells",
        source="A 3.3; value ours",
    )
    colour_threshold: float = param(
        5.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="the same for hue and saturation",
        source="B 7; value ours",
    )
    shift: int = param(
        2, unit="columns", low=0, high=5, meaning="horizontal shifts tried to either side", source="D 7; value ours"
    )
    field_of_view: float = param(
        math.radians(50),
        unit="rad",
        low=0.1,
        high=6.3,
        meaning="width of the camera's view, to read headings from shifts",
        source="A 3, C IV.A",
    )
    min_contrast: float = param(
        12.0, unit="grey levels", low=0.0, high=255.0, meaning="a view with less contrast shows nothing", source="ours"
    )
    min_edges: float = param(
        16.0, unit="levels", low=0.0, high=255.0, meaning="complex cells that see less edge see nothing", source="ours"
    )
    min_colour: float = param(
        0.6, low=0.0, high=1.0, meaning="a view with a smaller share of colour shows no hue", source="ours"
    )
    learning_rate: float = param(0.15, symbol="η", low=0.0, high=1.0, meaning="Hebbian learning rate", source="C IV.C")
    adaptive: bool = param(
        False,
        meaning="learning rate that follows the strength of vision and the confidence of the estimate",
        source="A 6.3 (future work); ours",
    )
    decay: float = param(
        0.0, symbol="δ", low=0.0, high=1.0, meaning="share of a link forgotten at each sight", source="A eq. 2"
    )
    saturation: float = param(
        0.02, symbol="s_max", low=0.0, high=1.0, meaning="most that one link injects", source="A eq. 4; value ours"
    )
    injection: float = param(
        0.14, low=0.0, high=5.0, meaning="most that all links of a view inject together", source="ours"
    )
    rest: float = param(
        10.0, unit="s", low=0.0, high=1e6, meaning="a view younger than this does not inject", source="ours"
    )
    surprise: float = param(
        20.0,
        unit="grey levels",
        low=0.0,
        high=255.0,
        meaning="an image that differs so much from the one before was not driven to",
        source="ours",
    )
    edge_surprise: float = param(
        20.0, unit="levels", low=0.0, high=255.0, meaning="the same for complex cells", source="ours"
    )
    colour_surprise: float = param(
        20.0, unit="levels", low=0.0, high=255.0, meaning="the same for hue and saturation", source="ours"
    )
    range_surprise: float = param(
        1.5,
        unit="1/m",
        low=0.0,
        high=10.0,
        meaning="what half of the sonars add to the surprise, a metre of change beyond 0.17 m; 1 is a kidnap",
        source="ours",
    )
    lost_injection: float = param(
        0.5,
        low=0.0,
        high=5.0,
        meaning="what a view may inject while the robot knows that it is lost",
        source="ours",
    )
    false_positives: float = param(
        0.0,
        symbol="N_vis",
        low=0.0,
        high=1.0,
        meaning="share of the recognised views that are taken for another known one",
        source="D 5.1",
    )
    enabled: bool = param(True, meaning="vision; off = path integration only", source="A figures 9, 10")

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, slots=True)
class ExperienceMapParams:
    """Experiences, their links and the correction of the map (B 4, D 3)."""

    zone_xy: float = param(
        2.0, symbol="r_a", unit="cells", low=0.5, high=20.0, meaning="zone of influence in x', y'", source="D eq. 2"
    )
    zone_theta: float = param(
        2.0, symbol="θ_a", unit="layers", low=0.5, high=20.0, meaning="zone of influence in θ'", source="D eq. 3"
    )
    threshold: float = param(
        0.0, low=0.0, high=2.0, meaning="a new experience when no energy is above it", source="B 4.1"
    )
    energy: str = param(
        "2006",
        symbol="E",
        choices=("2006", "2005"),
        meaning="2006: nothing outside the zone; 2005: place and heading count each for itself",
        source="D eqs. 1-4, B eqs. 4-9",
    )
    match_view: bool = param(
        True,
        symbol="E_V",
        meaning="the scene switches experiences on and off; off = only the pose cells count",
        source="B eq. 8",
    )
    correction: float = param(
        0.5,
        symbol="α",
        low=0.0,
        high=0.95,
        meaning="correction rate; 0.5 settles a node at once, from 1 on it would swing for ever",
        source="B table 1, D 3.3",
    )
    anchor_sigma: float = param(
        0.05,
        unit="m per grey level",
        low=0.0,
        high=1.0,
        meaning="how far off a match may be; looser matches weigh less in map correction, 0 = all weigh the same",
        source="ours",
    )
    odometry_sigma: float = param(
        0.01, unit="m", low=1e-4, high=1.0, meaning="error of a transition of one step", source="ours"
    )
    odometry_drift: float = param(
        0.03,
        unit="m/m",
        low=0.0,
        high=1.0,
        meaning="how the error of odometry grows with the way",
        source="ours",
    )
    confirm_jumps: int = param(
        0,
        unit="sights",
        low=0,
        high=50,
        meaning="a match more than 1 m or 0.8 rad off in the map is believed after so many that agree; 0 = at once",
        source="ours",
    )
    link_confidence: float = param(
        0.2,
        symbol="c_min",
        low=0.0,
        high=1.0,
        meaning="a link of less confidence is deleted; 0 = never",
        source="D 3.4; value ours",
    )
    link_trials: int = param(5, symbol="n_min", low=1, high=1000, meaning="not before so many trials", source="ours")
    link_recency: float = param(
        0.3,
        low=0.0,
        high=1.0,
        meaning="least that the newest trial of a link counts; 0 = all count the same",
        source="D 3.4, as next step",
    )
    link_trials_are: str = param(
        "tried",
        choices=("tried", "departures"),
        meaning="a link is on trial when it is driven or tried by a route, or at every departure under its behaviour",
        source="ours; D eq. 9",
    )
    robust: bool = param(
        True, meaning="looks and odometry that the map contradicts weigh less in its exact correction", source="ours"
    )
    calibrate: bool = param(
        True, meaning="learn the bias of the yaw rate from what the map cannot explain", source="ours"
    )
    sweeps: int = param(1, unit="1/step", low=0, high=100, meaning="correction sweeps in each step", source="B 4.3")
    solve_every: int = param(
        50,
        unit="steps",
        low=0,
        high=10_000,
        meaning="exact correction this often while loops close; 0 = never",
        source="ours",
    )

    shortcut_m: float = param(
        0.0,
        unit="m",
        low=0.0,
        high=5.0,
        meaning="routes may cross between experiences closer than this in the map; 0 = only along links",
        source="C VI; value ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, slots=True)
class GoalMemoryParams:
    """Times between places, learnt on the pose cells (C III)."""

    time_weight: float = param(
        1.0, symbol="α", low=0.0, high=10.0, meaning="weight of the time between two iterations", source="C IV.C"
    )
    activity_weight: float = param(
        0.25, symbol="β", unit="s", low=0.0, high=10.0, meaning="added between weakly active cells", source="C IV.C"
    )
    distance_weight: float = param(
        0.1, symbol="γ", unit="s/cell", low=0.0, high=10.0, meaning="added for the distance of cells", source="C IV.C"
    )
    rate: float = param(
        0.2,
        low=0.01,
        high=1.0,
        meaning="what the newest time counts in a link's moving average",
        source="C III.A; ours",
    )
    share: float = param(
        0.5, low=0.05, high=0.95, meaning="cells below this share of the strongest are not linked", source="ours"
    )
    stride_m: float = param(
        0.5,
        unit="m",
        low=0.0,
        high=5.0,
        meaning="the packet moves so far before its cells are linked; 0 = linked in every iteration",
        source="ours",
    )
    reach: int = param(
        3,
        unit="cells",
        low=1,
        high=10,
        meaning="how far around the packet the way is looked for",
        source="C III.B; ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, slots=True)
class OccupancyParams:
    """The wide sonar beam of the occupancy pictures (A 6.1, C V.A)."""

    beam_rad: float = param(
        math.radians(15), unit="rad", low=0.01, high=1.5, meaning="width of a sonar's beam", source="Moravec and Elfes"
    )
    farthest_m: float = param(
        5.0, symbol="R_max", unit="m", low=0.5, high=20.0, meaning="a range from here on is no echo", source="ours"
    )
    depth_m: float = param(
        0.1, symbol="ε", unit="m", low=0.0, high=1.0, meaning="how far off an echo may be", source="Moravec and Elfes"
    )
    free: float = param(
        0.4, low=0.0, high=0.95, meaning="how sure one echo is of the free floor before it", source="A 6.1; value ours"
    )
    occupied: float = param(
        0.6, low=0.0, high=0.95, meaning="how sure one echo is of what it met", source="A 6.1; value ours"
    )
    bound: float = param(
        5.0, low=0.5, high=20.0, meaning="log odds stay within ± this, so that the picture can change", source="ours"
    )
    scans: int = param(
        6,
        low=1,
        high=100,
        meaning="scans kept for each experience, the oldest gives way",
        source="ours",
        live=False,
    )

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, slots=True)
class RatSlamParams:
    """All of the engine."""

    pose_cells: PoseCellParams = PoseCellParams()
    local_view: LocalViewParams = LocalViewParams()
    experience_map: ExperienceMapParams = ExperienceMapParams()
    goal_memory: GoalMemoryParams = GoalMemoryParams()
    occupancy: OccupancyParams = OccupancyParams()
