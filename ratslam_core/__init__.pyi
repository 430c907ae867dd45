from .brain_file import load_brain, restore_snapshot, save_brain, take_snapshot
from .experience_map.cells_only import CellsOnly
from .experience_map.experience_map import ExperienceMap
from .experience_map.places import HashCollision, MultipleRepresentation, Places, find_places
from .experience_map.temporal_map import Route, TemporalMap
from .goal_memory import GoalMemory
from .local_view.recogniser import LocalView
from .local_view.view_links import ViewLinks
from .occupancy_grid import MapGrid, MetricPicture, OccupancyGrid
from .params import (
    ExperienceMapParams,
    GoalMemoryParams,
    KidnapParams,
    LocalViewParams,
    OccupancyParams,
    PoseCellParams,
    RatSlamParams,
)
from .pose_cells.network import PoseCells
from .pose_graph.transitions import Link
from .slam import RatSlam
from .types import Estimate, Odometry, Packet, Pose2, Recognition, wrap_angle, wrap_angles

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
    "wrap_angles",
]
