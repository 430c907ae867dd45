"""The parameters of the occupancy pictures. Sources are named in params/__init__.py."""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of occupancy/2")
@dataclass(frozen=True, slots=True)
class OccupancyParams:
    """The wide sonar beam of the occupancy pictures (A 6.1, C V.A)."""

    enabled: bool = param(True, meaning="draw the occupancy grids; off = no grids", source="A 6.1, C V.A")
    beam_rad: float = param(
        math.radians(15), unit="rad", low=0.01, high=1.5, meaning="width of a sonar's beam", source="Moravec and Elfes"
    )
    farthest_m: float = param(
        5.0,
        symbol="R_max",
        unit="m",
        low=0.5,
        high=20.0,
        meaning="a range of this or more means no echo",
        source="ours",
    )
    depth_m: float = param(
        0.1, symbol="ε", unit="m", low=0.0, high=1.0, meaning="how far off an echo may be", source="Moravec and Elfes"
    )
    free: float = param(
        0.4,
        low=0.0,
        high=0.95,
        meaning="how certain one echo makes it that the floor before it is free",
        source="A 6.1; value ours",
    )
    occupied: float = param(
        0.6,
        low=0.0,
        high=0.95,
        meaning="how certain one echo makes it that something stands there",
        source="A 6.1; value ours",
    )
    bound: float = param(
        5.0, low=0.5, high=20.0, meaning="log odds stay within ± this, so that the picture can change", source="ours"
    )
    same_place_m: float = param(
        0.1,
        unit="m",
        low=0.0,
        high=5.0,
        meaning="a scan no farther than this from the newest of its experience, and facing the same way, replaces it",
        source="ours",
    )
    same_facing: float = param(
        math.radians(10),
        unit="rad",
        low=0.0,
        high=3.2,
        meaning="largest difference in heading that counts as facing the same way",
        source="ours",
    )
    scans: int = param(
        6,
        low=1,
        high=100,
        meaning="scans kept for each experience; a new one replaces the oldest",
        source="ours",
        live=False,
    )

    def __post_init__(self) -> None:
        check_ranges(self)
