"""The parameters of the experience map. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of experience map/1")
@dataclass(frozen=True, slots=True)
class ExperienceMapParams:
    """Experiences, their links and the correction of the map (B 4, D 3)."""

    enabled: bool = param(
        True,
        meaning="experiences; off = one, in whose frame the packet is the robot's place: the map of 2004",
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
    blind_m: float = param(
        1.0,
        unit="m",
        low=0.0,
        high=100.0,
        meaning="so near in the map is an experience of nothing to see, or it is not meant",
        source="ours",
    )
    blind_sigma: float = param(
        0.5, unit="m", low=0.0, high=10.0, meaning="how far off one may be that shows nothing", source="ours"
    )
    carried_sigma: float = param(
        100.0, unit="m", low=1.0, high=1e4, meaning="how far off the robot may be after it was carried", source="ours"
    )
    zone_offset: bool = param(
        True,
        meaning="the robot enters an experience's zone beside its centre; off = it is at the experience",
        source="ours",
    )
    best_look: bool = param(
        True, meaning="a transition is measured where the robot comes nearest; off = where it enters", source="ours"
    )
    odometry_edges: bool = param(
        True,
        meaning="odometry also ties experiences made one after the other past known ones",
        source="ours",
        live=False,
    )
    pace_floor: bool = param(
        True, meaning="a link takes at least what its length in the map takes at the robot's pace", source="ours"
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
    sweep: str = param(
        "by experience",
        choices=("by experience", "by link"),
        meaning="an experience is moved by the weighted mean of what its links ask, or by each link in turn",
        source="ours; B 4.3",
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
