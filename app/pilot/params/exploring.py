"""How the robot explores: along the wall on its left, looking back now and then, and across the room."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ratslam_core.params.parameter import param


@dataclass(frozen=True)
class ExploringParams:
    """The pilot steers towards points so far ahead of the robot and to its side."""

    wall_distance: float = param(
        0.55,
        unit="m",
        low=0.3,
        high=2.0,
        meaning="distance kept from the wall on the left",
        source="C IV.D; value ours",
    )
    follow_ahead_m: float = param(
        0.8,
        unit="m",
        low=0.1,
        high=3.0,
        meaning="how far ahead the robot aims along a wall, and when it drives back to look",
        source="ours",
    )
    follow_aside_m: float = param(
        0.5,
        unit="m",
        low=0.0,
        high=2.0,
        meaning="how far to the side it aims at most to keep its distance",
        source="ours",
    )
    blocked_ahead_m: float = param(
        0.15, unit="m", low=0.0, high=2.0,
        meaning="added to the wall distance: it turns away from anything nearer ahead",
        source="ours",
    )  # fmt: skip
    blocked_turn_ahead_m: float = param(
        0.3, unit="m", low=0.0, high=2.0, meaning="how far ahead it aims when turning away ...", source="ours"
    )
    blocked_turn_aside_m: float = param(
        0.6, unit="m", low=0.0, high=2.0, meaning="... and how far to the right", source="ours"
    )
    corner_share: float = param(
        2.0,
        low=1.0,
        high=10.0,
        meaning="a wall more than so many wall distances away has ended: it turns round the corner",
        source="ours",
    )
    corner_ahead_m: float = param(
        0.5, unit="m", low=0.0, high=2.0, meaning="how far ahead it aims when rounding a corner ...", source="ours"
    )
    corner_aside_m: float = param(
        0.45, unit="m", low=0.0, high=2.0, meaning="... and how far to the left", source="ours"
    )
    turned_to_rad: float = param(
        0.15,
        unit="rad",
        low=0.01,
        high=1.0,
        meaning="a turn on the spot ends when no more than this is left",
        source="ours",
    )
    turn_patience_s: float = param(
        12.0, unit="s", low=1.0, high=120.0, meaning="a turn on the spot is given up after this time", source="ours"
    )
    look_back_after_m: float = param(
        5.0,
        unit="m",
        low=1.0,
        high=1000.0,
        meaning="distance driven before it turns back to look",
        source="C IV.D: 3 m",
    )
    look_turn_rad: float = param(
        math.pi, unit="rad", low=0.5, high=math.pi, meaning="how far it turns to look back", source="C IV.D"
    )
    look_back_m: float = param(
        1.0, unit="m", low=0.0, high=10.0, meaning="how far it drives back to look", source="ours"
    )
    look_back_s: float = param(
        8.0, unit="s", low=0.0, high=120.0, meaning="driving back ends after this time at the latest", source="ours"
    )
    look_stop_m: float = param(
        0.15,
        unit="m",
        low=0.0,
        high=2.0,
        meaning="driving back ends when no more than this is free ahead",
        source="ours",
    )
    look_return_rad: float = param(
        math.pi - 1e-3,
        unit="rad",
        low=0.5,
        high=math.pi,
        meaning="how far it turns after looking back, to go on",
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
        0.25, low=0.0, high=1.0, meaning="largest random variation of that time, as a share of it", source="ours"
    )
    cross_least_s: float = param(
        6.0, unit="s", low=0.0, high=600.0, meaning="shortest crossing, not counting its turn", source="ours"
    )
    cross_most_s: float = param(
        20.0, unit="s", low=0.0, high=600.0, meaning="longest crossing, not counting its turn", source="ours"
    )
    cross_ahead_m: float = param(
        1.2, unit="m", low=0.1, high=3.0, meaning="how far ahead it aims while crossing", source="ours"
    )
    cross_stop_m: float = param(
        0.35, unit="m", low=0.0, high=2.0, meaning="a crossing ends when less than this is free ahead", source="ours"
    )
