"""When the robot considers itself stuck, and how it gets free."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class FreeingParams:
    """To get free, the robot backs off, then turns on the spot."""

    stuck_s: float = param(
        6.0,
        unit="s",
        low=1.0,
        high=60.0,
        meaning="without progress for this long, the robot frees itself",
        source="ours",
    )
    bumped_s: float = param(
        1.0,
        unit="s",
        low=0.0,
        high=60.0,
        meaning="the same for a robot that has bumped into something",
        source="ours",
    )
    somewhere_m: float = param(
        0.4, unit="m", low=0.05, high=5.0, meaning="progress is to come this far, by odometry ...", source="ours"
    )
    turned_rad: float = param(1.5, unit="rad", low=0.1, high=6.0, meaning="... or to turn this far ...", source="ours")
    most_turns: int = param(
        2, low=0, high=100, meaning="... but turns count no more often than this in one place", source="ours"
    )
    grip_yaw_rate: float = param(
        0.2, unit="rad/s", low=0.0, high=1.5,
        meaning="turns faster than this are used to measure how slow the floor is",
        source="ours",
    )  # fmt: skip
    least_grip: float = param(
        0.2, low=0.01, high=1.0, meaning="on the slowest floor, time without progress runs at this share", source="ours"
    )
    grip_s: float = param(
        2.0, unit="s", low=0.1, high=60.0, meaning="time constant of measuring the floor", source="ours"
    )
    back_off_s: float = param(
        1.0, unit="s", low=0.0, high=30.0, meaning="how long the robot backs off ...", source="ours"
    )
    back_off_speed: float = param(0.2, unit="m/s", low=0.0, high=0.5, meaning="... at this speed ...", source="ours")
    free_turn_s: float = param(
        1.5, unit="s", low=0.0, high=30.0, meaning="... and how long it turns then", source="ours"
    )
    free_turn_share: float = param(
        0.5,
        low=0.0,
        high=1.0,
        meaning="slowest such turn, to the left or right, as a share of the turn rate",
        source="ours",
    )
