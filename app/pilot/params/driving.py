"""How fast the robot drives, and how it chooses among the arcs that are free."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class DrivingParams:
    """An arc costs the distance left at its end, plus the angle left to turn and passing close to an echo."""

    cruise_speed: float = param(
        0.36, symbol="v", unit="m/s", low=0.05, high=0.5, meaning="speed on free floor", source="B 6"
    )
    turn_rate: float = param(
        1.0,
        symbol="ω",
        unit="rad/s",
        low=0.2,
        high=1.57,
        meaning="yaw rate of a turn on the spot, and the highest on an arc",
        source="A 6",
    )
    clearance: float = param(
        0.27,
        unit="m",
        low=0.2,
        high=1.0,
        meaning="least distance from the robot's middle to an obstacle",
        source="ours",
    )
    echo_s: float = param(
        3.0, unit="s", low=0.1, high=60.0, meaning="how long a sonar echo is remembered", source="ours", live=False
    )
    echo_range_m: float = param(
        1.6, unit="m", low=0.3, high=10.0, meaning="echoes from farther away are ignored", source="ours"
    )
    arc_s: float = param(
        1.2, unit="s", low=0.2, high=10.0, meaning="time over which an arc is planned ahead", source="D 4.3; value ours"
    )
    arc_steps: int = param(8, low=1, high=100, meaning="points on an arc that are tested for clearance", source="ours")
    arcs_a_side: int = param(6, low=1, high=50, meaning="arcs tried to each side at each speed", source="ours")
    medium_share: float = param(
        0.6, low=0.01, high=1.0, meaning="second speed that is tried, as a share of the cruise speed", source="ours"
    )
    slow_share: float = param(
        0.3, low=0.01, high=1.0, meaning="third speed that is tried, as a share of the cruise speed", source="ours"
    )
    spot_share: float = param(
        0.5,
        low=0.0,
        high=1.0,
        meaning="slowest turn on the spot that is tried, as a share of the turn rate",
        source="ours",
    )
    spot_s: float = param(
        0.6, unit="s", low=0.05, high=10.0, meaning="time over which a turn on the spot is planned ahead", source="ours"
    )
    turn_cost: float = param(
        0.25,
        unit="m/rad",
        low=0.0,
        high=10.0,
        meaning="cost of the angle left to turn at the end of an arc",
        source="ours",
    )
    bearing_m: float = param(
        0.15, unit="m", low=0.0, high=2.0,
        meaning="an arc that ends nearer to its target is judged by the bearing from the robot, not from the arc's end",
        source="ours",
    )  # fmt: skip
    narrow_m: float = param(
        0.15, unit="m", low=0.01, high=2.0,
        meaning="width of the margin beyond the clearance in which an echo costs, less the farther away it is",
        source="ours",
    )  # fmt: skip
    narrow_cost: float = param(
        0.15,
        unit="m",
        low=0.0,
        high=10.0,
        meaning="cost of an echo exactly at the clearance",
        source="ours",
    )
    escape_m2: float = param(
        1e-4, unit="m²", low=0.0, high=0.01,
        meaning="on the way out, the squared distance of an echo that is too close may shrink by this much",
        source="ours",
    )  # fmt: skip
