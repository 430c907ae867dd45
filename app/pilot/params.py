"""The pilot's numbers, each declared once."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.parameter import check_ranges, param


@dataclass(frozen=True, slots=True)
class PilotParams:
    """How the robot moves: exploring, avoiding, following a route."""

    cruise_speed: float = param(
        0.36, symbol="v", unit="m/s", low=0.05, high=0.5, meaning="speed on free floor", source="B 6"
    )
    turn_rate: float = param(
        1.0, symbol="ω", unit="rad/s", low=0.2, high=1.57, meaning="turning on the spot", source="A 6"
    )
    clearance: float = param(
        0.27,
        unit="m",
        low=0.2,
        high=1.0,
        meaning="least distance of the robot's middle from an obstacle",
        source="ours",
    )
    wall_distance: float = param(
        0.55,
        unit="m",
        low=0.3,
        high=2.0,
        meaning="distance kept from the wall on the left",
        source="C IV.D; value ours",
    )
    look_back_after_m: float = param(
        5.0,
        unit="m",
        low=1.0,
        high=1000.0,
        meaning="turn back and look after so much way",
        source="C IV.D: 3 m",
    )
    cross_after_s: float = param(
        16.0,
        unit="s",
        low=2.0,
        high=1e6,
        meaning="mean time of wall following before a crossing",
        source="ours",
    )
    lookahead_m: float = param(
        0.6, unit="m", low=0.2, high=3.0, meaning="how far ahead on the route the robot aims", source="ours"
    )
    arrival_m: float = param(
        0.3, unit="m", low=0.05, high=2.0, meaning="nearer to the goal than this is there", source="C III.B: a cell"
    )
    coast_s: float = param(
        8.0, unit="s", low=0.0, high=120.0, meaning="how long an old route is relied on", source="D 4.4; value ours"
    )
    stuck_s: float = param(
        6.0, unit="s", low=1.0, high=60.0, meaning="a robot that gets nowhere for so long frees itself", source="ours"
    )

    def __post_init__(self) -> None:
        check_ranges(self)
