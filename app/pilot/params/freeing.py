"""When the robot takes itself for stuck, and how it gets free."""

from __future__ import annotations

from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class FreeingParams:
    """It backs off, then turns on the spot."""

    stuck_s: float = param(
        6.0, unit="s", low=1.0, high=60.0, meaning="a robot that gets nowhere for so long frees itself", source="ours"
    )
    bumped_s: float = param(
        1.0,
        unit="s",
        low=0.0,
        high=60.0,
        meaning="one that has bumped into something frees itself after",
        source="ours",
    )
    somewhere_m: float = param(
        0.4, unit="m", low=0.05, high=5.0, meaning="who has come so far, by odometry, has got somewhere", source="ours"
    )
    turned_rad: float = param(
        1.5, unit="rad", low=0.1, high=6.0, meaning="who has turned so far has got somewhere, too ...", source="ours"
    )
    most_turns: int = param(2, low=0, high=100, meaning="... but no more often than this in one place", source="ours")
    grip_yaw_rate: float = param(
        0.2, unit="rad/s", low=0.0, high=1.5, meaning="turns faster than this tell how slow the floor makes it",
        source="ours",
    )  # fmt: skip
    least_grip: float = param(
        0.2, low=0.01, high=1.0, meaning="on the slowest floor its time runs at this share", source="ours"
    )
    grip_s: float = param(
        2.0, unit="s", low=0.1, high=60.0, meaning="time in which it gets used to another floor", source="ours"
    )
    back_off_s: float = param(1.0, unit="s", low=0.0, high=30.0, meaning="how long it backs off ...", source="ours")
    back_off_speed: float = param(0.2, unit="m/s", low=0.0, high=0.5, meaning="... at this speed ...", source="ours")
    free_turn_s: float = param(1.5, unit="s", low=0.0, high=30.0, meaning="... and then turns", source="ours")
    free_turn_share: float = param(
        0.5, low=0.0, high=1.0, meaning="it turns left or right, no slower than this share of the rate", source="ours"
    )
