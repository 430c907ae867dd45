"""The pilot's numbers, each declared once: driving, exploring, following a route, getting free. One section of the config."""

from __future__ import annotations

from dataclasses import dataclass

from app.pilot.params.driving import DrivingParams
from app.pilot.params.exploring import ExploringParams
from app.pilot.params.freeing import FreeingParams
from app.pilot.params.routes import RouteParams
from disk import kind
from ratslam_core.params.parameter import check_ranges

__all__ = ["DrivingParams", "ExploringParams", "FreeingParams", "PilotParams", "RouteParams"]


@kind("parameters of pilot/1")
@dataclass(frozen=True)
class PilotParams(FreeingParams, RouteParams, ExploringParams, DrivingParams):
    """How the robot moves. Declared in reverse: the fields of the last base come first."""

    def __post_init__(self) -> None:
        check_ranges(self)
