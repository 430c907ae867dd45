"""Every number of the engine, once: default, symbol, unit, range, meaning and source.

Sources: A = ACRA 2004, B = ACRA 2005, C = IROS 2005, D = ACRA 2006; "ours" where the papers are silent.
"""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.evidence import EvidenceParams
from ratslam_core.params.experience_map import ExperienceMapParams
from ratslam_core.params.goal_memory import GoalMemoryParams
from ratslam_core.params.kidnap import KidnapParams
from ratslam_core.params.local_view import LocalViewParams
from ratslam_core.params.occupancy import OccupancyParams
from ratslam_core.params.parameter import check_ranges, param
from ratslam_core.params.pose_cells import PoseCellParams

__all__ = [
    "EvidenceParams",
    "ExperienceMapParams",
    "GoalMemoryParams",
    "KidnapParams",
    "LocalViewParams",
    "OccupancyParams",
    "PoseCellParams",
    "RatSlamParams",
    "check_ranges",
    "param",
]


@kind("parameters/2")
@dataclass(frozen=True, slots=True)
class RatSlamParams:
    """All of the engine."""

    pose_cells: PoseCellParams = PoseCellParams()
    local_view: LocalViewParams = LocalViewParams()
    experience_map: ExperienceMapParams = ExperienceMapParams()
    goal_memory: GoalMemoryParams = GoalMemoryParams()
    occupancy: OccupancyParams = OccupancyParams()
    kidnap: KidnapParams = KidnapParams()
    evidence: EvidenceParams = EvidenceParams()
