"""RatSLAM after Milford, Wyeth and Prasser (2004-2006): arrays in, arrays out."""

from ratslam_core.brain_file import load_brain, restore_snapshot, save_brain, take_snapshot
from ratslam_core.experience_map.cells_only import CellsOnly
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.experience_map.places import HashCollision, MultipleRepresentation, Places, find_places
from ratslam_core.experience_map.temporal_map import Route, TemporalMap
from ratslam_core.experience_map.transitions import Link
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.local_view.view_links import ViewLinks
from ratslam_core.occupancy_grid import MapGrid, MetricPicture, OccupancyGrid
from ratslam_core.params import (
    ExperienceMapParams,
    GoalMemoryParams,
    KidnapParams,
    LocalViewParams,
    MemoryParams,
    OccupancyParams,
    PoseCellParams,
    PoseFilterParams,
    RatSlamParams,
    SolverParams,
)
from ratslam_core.pose_cells.network import PoseCells
from ratslam_core.slam import RatSlam
from ratslam_core.types import Estimate, Odometry, Packet, Pose2, Recognition, wrap_angle

__all__ = [
    "CellsOnly",
    "Estimate",
    "ExperienceMap",
    "ExperienceMapParams",
    "GoalMemory",
    "GoalMemoryParams",
    "HashCollision",
    "KidnapParams",
    "Link",
    "LocalView",
    "LocalViewParams",
    "MapGrid",
    "MemoryParams",
    "MetricPicture",
    "MultipleRepresentation",
    "OccupancyGrid",
    "OccupancyParams",
    "Odometry",
    "Packet",
    "Places",
    "Pose2",
    "PoseCellParams",
    "PoseCells",
    "PoseFilterParams",
    "RatSlam",
    "RatSlamParams",
    "Recognition",
    "Route",
    "SolverParams",
    "TemporalMap",
    "ViewLinks",
    "find_places",
    "load_brain",
    "restore_snapshot",
    "save_brain",
    "take_snapshot",
    "wrap_angle",
]
