"""The parameters of the occupancy pictures. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of occupancy/3")
@dataclass(frozen=True, slots=True)
class OccupancyParams:
    """Pictures of where the sonars met something (A 6.1, C V.A)."""

    enabled: bool = param(True, meaning="draw the occupancy grids; off = no grids", source="A 6.1, C V.A")

    def __post_init__(self) -> None:
        check_ranges(self)
