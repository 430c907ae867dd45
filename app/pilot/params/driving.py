"""How fast the robot drives, and how it chooses among the arcs that are free."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class DrivingParams:
    """An arc costs the distance that is left at its end, and more for what is left to turn and for passing close by."""

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
    echo_ticks: int = param(
        30, unit="ticks", low=1, high=600, meaning="how long a sonar echo is remembered", source="ours", live=False
    )
    echo_range_m: float = param(
        1.6, unit="m", low=0.3, high=10.0, meaning="echoes from beyond this are left out of account", source="ours"
    )
    arc_s: float = param(
        1.2, unit="s", low=0.2, high=10.0, meaning="how far an arc is looked ahead along", source="D 4.3; value ours"
    )
    arc_steps: int = param(8, low=1, high=100, meaning="places on an arc that are tested for room", source="ours")
    arcs_a_side: int = param(
        6, low=1, high=50, meaning="arcs to the left, and as many to the right, at each speed", source="ours"
    )
    medium_share: float = param(
        0.6, low=0.01, high=1.0, meaning="second of the speeds that are tried, as a share of the first", source="ours"
    )
    slow_share: float = param(
        0.3, low=0.01, high=1.0, meaning="third of the speeds that are tried, as a share of the first", source="ours"
    )
    spot_share: float = param(
        0.5, low=0.0, high=1.0, meaning="a turn on the spot is no slower than this share of the rate", source="ours"
    )
    spot_s: float = param(
        0.6, unit="s", low=0.05, high=10.0, meaning="how far a turn on the spot is looked ahead", source="ours"
    )
    turn_cost: float = param(
        0.25, unit="m/rad", low=0.0, high=10.0, meaning="cost of an angle that is left to turn", source="ours"
    )
    bearing_m: float = param(
        0.15, unit="m", low=0.0, high=2.0, meaning="nearer to its target an arc is to point as the robot should now",
        source="ours",
    )  # fmt: skip
    narrow_m: float = param(
        0.15, unit="m", low=0.01, high=2.0, meaning="beyond the clearance an echo costs the less the farther, up to here",
        source="ours",
    )  # fmt: skip
    narrow_cost: float = param(
        0.15,
        unit="m",
        low=0.0,
        high=10.0,
        meaning="cost of an echo that is just as far as the clearance",
        source="ours",
    )
    escape_m2: float = param(
        1e-4, unit="m²", low=0.0, high=0.01, meaning="what is too close may get nearer by so much on the way out, squared",
        source="ours",
    )  # fmt: skip
