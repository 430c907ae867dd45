"""The pilot's parameters, one section of the config: driving, exploring, following routes, getting free, seeking."""

from __future__ import annotations

from dataclasses import dataclass

from app.pilot.params.driving import DrivingParams
from app.pilot.params.exploring import ExploringParams
from app.pilot.params.freeing import FreeingParams
from app.pilot.params.routes import RouteParams
from app.pilot.params.seeking import SeekingParams
from disk import kind
from ratslam_core.params.parameter import check_ranges

__all__ = ["DrivingParams", "ExploringParams", "FreeingParams", "PilotParams", "RouteParams", "SeekingParams"]


@kind("parameters of pilot/1")
@dataclass(frozen=True)
class PilotParams(SeekingParams, FreeingParams, RouteParams, ExploringParams, DrivingParams):
    """How the robot moves. The bases stand in reverse: a dataclass takes the fields of its last base first."""

    def __post_init__(self) -> None:
        check_ranges(self)
