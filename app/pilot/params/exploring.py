"""How the robot explores: along the wall on its left, looking back now and then, and across the room."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class ExploringParams:
    """Points that are headed for lie so far ahead of the robot and aside."""

    wall_distance: float = param(
        0.55,
        unit="m",
        low=0.3,
        high=2.0,
        meaning="distance kept from the wall on the left",
        source="C IV.D; value ours",
    )
    follow_ahead_m: float = param(
        0.8, unit="m", low=0.1, high=3.0, meaning="how far ahead it heads along a wall, or straight back", source="ours"
    )
    follow_aside_m: float = param(
        0.5, unit="m", low=0.0, high=2.0, meaning="how far aside it heads at most to keep its distance", source="ours"
    )
    blocked_ahead_m: float = param(
        0.15, unit="m", low=0.0, high=2.0, meaning="beyond the wall distance: what is nearer ahead is turned from",
        source="ours",
    )  # fmt: skip
    blocked_turn_ahead_m: float = param(
        0.3, unit="m", low=0.0, high=2.0, meaning="how far ahead it heads there ...", source="ours"
    )
    blocked_turn_aside_m: float = param(
        0.6, unit="m", low=0.0, high=2.0, meaning="... and how far to the right", source="ours"
    )
    corner_share: float = param(
        2.0, low=1.0, high=10.0, meaning="a wall so many wall distances away has ended: round the corner", source="ours"
    )
    corner_ahead_m: float = param(
        0.5, unit="m", low=0.0, high=2.0, meaning="how far ahead it heads there ...", source="ours"
    )
    corner_aside_m: float = param(
        0.45, unit="m", low=0.0, high=2.0, meaning="... and how far to the left", source="ours"
    )
    turned_to_rad: float = param(
        0.15,
        unit="rad",
        low=0.01,
        high=1.0,
        meaning="a turn on the spot ends when less than this is left",
        source="ours",
    )
    turn_patience_s: float = param(
        12.0, unit="s", low=1.0, high=120.0, meaning="a turn on the spot is given up after", source="ours"
    )
    look_back_after_m: float = param(
        5.0,
        unit="m",
        low=1.0,
        high=1000.0,
        meaning="turn back and look after so much way",
        source="C IV.D: 3 m",
    )
    look_turn_rad: float = param(
        math.pi, unit="rad", low=0.5, high=math.pi, meaning="how far it turns to look back", source="C IV.D"
    )
    look_back_m: float = param(
        1.0, unit="m", low=0.0, high=10.0, meaning="how far it drives back to look", source="ours"
    )
    look_back_s: float = param(
        8.0, unit="s", low=0.0, high=120.0, meaning="driving back ends after so long, whatever the way", source="ours"
    )
    look_stop_m: float = param(
        0.15, unit="m", low=0.0, high=2.0, meaning="driving back ends when less than this is free ahead", source="ours"
    )
    look_return_rad: float = param(
        math.pi - 1e-3,
        unit="rad",
        low=0.5,
        high=math.pi,
        meaning="how far it turns round again to go on",
        source="ours",
    )
    cross_after_s: float = param(
        16.0,
        unit="s",
        low=2.0,
        high=1e6,
        meaning="mean time of wall following before a crossing",
        source="ours",
    )
    cross_spread: float = param(
        0.25, low=0.0, high=1.0, meaning="share by which that time varies at most, either way", source="ours"
    )
    cross_least_s: float = param(
        6.0, unit="s", low=0.0, high=600.0, meaning="shortest crossing, its turn left out", source="ours"
    )
    cross_most_s: float = param(
        20.0, unit="s", low=0.0, high=600.0, meaning="longest crossing, its turn left out", source="ours"
    )
    cross_ahead_m: float = param(
        1.2, unit="m", low=0.1, high=3.0, meaning="how far ahead it heads while crossing", source="ours"
    )
    cross_stop_m: float = param(
        0.35, unit="m", low=0.0, high=2.0, meaning="a crossing ends when less than this is free ahead", source="ours"
    )
