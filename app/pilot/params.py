"""The pilot's parameters, one section of the config: what somebody would tune. What is not tuned stands beside its use."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from disk.parameter import check_ranges, param

# A table: the formatter would give each number a line
# fmt: off


@kind("parameters of pilot/3")
@dataclass(frozen=True)
class PilotParams:
    """How the robot drives, explores, follows routes, and seeks; without `seek` it follows walls, looks back and crosses."""

    cruise_speed: float = param(0.36, "speed on free floor", 0.05, 0.5, "m/s", symbol="v", source="B 6")
    turn_rate: float = param(
        1.0, "yaw rate of a turn on the spot, and the highest on an arc", 0.2, 1.57, "rad/s", symbol="ω", source="A 6")
    clearance: float = param(0.24, "least distance from the robot's middle to an obstacle", 0.2, 1.0, "m")
    echo_s: float = param(3.0, "how long a sonar echo is remembered", 0.1, 60.0, "s", live=False)
    wall_distance: float = param(
        0.55, "distance kept from the wall on the left", 0.3, 2.0, "m", source="C IV.D; value ours")
    look_back_after_m: float = param(
        5.0, "distance driven before it turns back to look", 1.0, 1000.0, "m", source="C IV.D: 3 m")
    cross_after_s: float = param(16.0, "mean time of wall following before a crossing", 2.0, 1e6, "s")
    goal_place_m: float = param(
        0.2, "all experiences within this of the one nearest to a click stand for its place; 0 = that one only", 0.0, 5.0,
        "m", source="B 3.6; value ours")
    arrival_m: float = param(
        0.1, "a robot nearer to its goal than this has arrived", 0.02, 2.0, "m", source="C III.B: a cell; value ours")
    approach_m: float = param(
        1.0, "nearer to its goal than this, it drives straight there if the sonars find the way free; 0 = never", 0.0,
        5.0, "m")
    bar_fade_s: float = param(
        45.0,
        "time in which a bar fades, doubled each time the robot fails there again; 0 = bars stay, and links across them "
        "are deleted in the end", 0.0, 1e5, "s", source="ours; 0: D 3.4")
    gap_m: float = param(
        0.8, "if less than this is free towards the next point, the robot heads for the freest direction beside it; "
        "0 = straight on", 0.0, 3.0, "m")
    stuck_s: float = param(6.0, "without progress for this long, the robot frees itself", 1.0, 60.0, "s")
    seek: bool = param(
        True, "the robot goes to new ground, closes loops, goes back and finds out where it is on purpose; off = it only wanders",
        source="ours; off: C IV.D")
    retrace: bool = param(
        False,
        "who only wanders turns back after look_back_after_m or 30 degrees, retraces its path since it last did, and "
        "returns; off = it looks back 1 m, and crosses rooms", source="C IV.D; off: ours")
    return_sigma_m: float = param(
        1.5, "it goes back to known ground when odometry may be off by this since it left that", 0.01, 1e3, "m")
    loop_share: float = param(
        0.25, "known ground nearer than this share of the way there by the links is driven along until a loop closes", 0.0,
        1.0)
    far_look_back_m: float = param(
        10.0, "on new ground: distance driven before it turns back to look; each turn costs heading", 1.0, 1000.0, "m")

    def __post_init__(self) -> None:
        check_ranges(self)
