"""The parameters of the experience map. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of experience map/5")
@dataclass(frozen=True, slots=True)
class ExperienceMapParams:
    """Experiences, their links and the correction of the map (B 4, D 3)."""

    enabled: bool = param(
        True,
        meaning="build an experience map; off = the packet's place in the pose cells is the robot's place, as in 2004",
        source="A",
        live=False,
    )
    zone_xy: float = param(
        2.0, symbol="r_a", unit="cells", low=0.5, high=20.0, meaning="zone of influence in x', y'", source="D eq. 2"
    )
    zone_theta: float = param(
        2.0, symbol="θ_a", unit="layers", low=0.5, high=20.0, meaning="zone of influence in θ'", source="D eq. 3"
    )
    threshold: float = param(
        0.0, low=0.0, high=2.0, meaning="a new experience is made when no energy is above this", source="B 4.1"
    )
    energy: str = param(
        "2006",
        symbol="E",
        choices=("2006", "2005"),
        meaning="2006: zero outside the zone; 2005: place and heading count separately",
        source="D eqs. 1-4, B eqs. 4-9",
    )
    match_view: bool = param(
        True,
        symbol="E_V",
        meaning="only experiences of the current view have energy; off = only the pose cells count",
        source="B eq. 8",
    )
    correction: float = param(
        0.5,
        symbol="α",
        low=0.0,
        high=0.95,
        meaning="correction rate; 0.5 settles a node at once, 1 or more would oscillate for ever",
        source="B table 1, D 3.3",
    )
    anchor_sigma: float = param(
        0.05,
        unit="m per level",
        low=0.0,
        high=1.0,
        meaning="error of a match per level of its difference; worse matches weigh less in map correction, 0 = all alike",
        source="ours",
    )
    odometry_drift: float = param(
        0.05,
        unit="m/m",
        low=0.0,
        high=1.0,
        meaning="growth of the odometry error with the distance driven",
        source="ours",
    )
    islands: bool = param(
        True,
        meaning="a robot that was carried maps a submap, merged where evidence is strong; off = it believes each look",
        source="ours",
    )
    zone_offset: bool = param(
        True,
        meaning="the robot enters an experience's zone beside its centre; off = at its centre",
        source="ours",
    )
    best_look: bool = param(
        True,
        meaning="a transition is measured where the robot comes nearest to the experience; off = where it enters the zone",
        source="ours",
    )
    odometry_edges: bool = param(
        True,
        meaning="odometry also ties experiences made one after the other when known ones lie between",
        source="ours",
        live=False,
    )
    pace_floor: bool = param(
        True,
        meaning="a link takes at least as long as its length in the map at the robot's average pace",
        source="ours",
    )
    link_confidence: float = param(
        0.2,
        symbol="c_min",
        low=0.0,
        high=1.0,
        meaning="a link with less confidence is deleted; 0 = never",
        source="D 3.4; value ours",
    )
    link_trials: int = param(
        5, symbol="n_min", low=1, high=1000, meaning="least trials before a link is deleted", source="ours"
    )
    robust: bool = param(
        True, meaning="looks and odometry that the map contradicts weigh less in the exact correction", source="ours"
    )
    calibrate: bool = param(
        True, meaning="learn the bias of the yaw rate from what the map cannot explain", source="ours"
    )
    sweep: str = param(
        "by experience",
        choices=("by experience", "by link", "all at once"),
        meaning="an experience is moved by the weighted mean of its links' residuals, by each link in turn, or all are by their "
        "sums, as printed, which diverges where the rate is too high",
        source="ours; B 4.3",
    )
    sweeps: int = param(1, unit="1/beat", low=0, high=100, meaning="correction sweeps in each beat", source="B 4.3")
    exact_solver: bool = param(
        True, meaning="exact corrections beside the sweeps; off = sweeps alone", source="ours", live=False
    )
    solve_every: int = param(
        50,
        unit="beats",
        low=0,
        high=10_000,
        meaning="least time between exact corrections, in tenths of a second, made while loops close; 0 = never",
        source="ours",
    )
    bias_sigma: float = param(
        0.01,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        meaning="how large a bias of the yaw rate may well be; what a few short loops seem to show beyond it is not believed",
        source="ours",
    )
    familiar_ground: bool = param(
        True,
        meaning="ground that is recognised often gets no more views and experiences; off = every new sight is kept",
        source="ours",
        live=False,
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
