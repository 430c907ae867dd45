"""RatSLAM after Milford, Wyeth and Prasser (2004-2006): arrays in, arrays out."""

from ratslam_core.brain_snapshot import BrainSnapshot, load_brain, restore_snapshot, save_brain, take_snapshot
from ratslam_core.experience_map import ExperienceMap
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.local_view import LocalView
from ratslam_core.occupancy_grid import MapGrid, MetricPicture, OccupancyGrid
from ratslam_core.params import (
    ExperienceMapParams,
    GoalMemoryParams,
    LocalViewParams,
    OccupancyParams,
    PoseCellParams,
    RatSlamParams,
)
from ratslam_core.places import HashCollision, MultipleRepresentation, Places, find_places
from ratslam_core.pose_cells import PoseCells
from ratslam_core.slam import RatSlam
from ratslam_core.temporal_map import Route, TemporalMap
from ratslam_core.transitions import Link
from ratslam_core.types import Estimate, Odometry, Packet, Pose2, Recognition, wrap_angle
from ratslam_core.view_links import ViewLinks

__all__ = [
    "BrainSnapshot",
    "Estimate",
    "ExperienceMap",
    "ExperienceMapParams",
    "GoalMemory",
    "GoalMemoryParams",
    "HashCollision",
    "Link",
    "LocalView",
    "LocalViewParams",
    "MapGrid",
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
    "RatSlam",
    "RatSlamParams",
    "Recognition",
    "Route",
    "TemporalMap",
    "ViewLinks",
    "find_places",
    "load_brain",
    "restore_snapshot",
    "save_brain",
    "take_snapshot",
    "wrap_angle",
]
