"""The occupancy grids from the sonars: the one around the robot, and one laid out over the experience map."""

from __future__ import annotations

import copy

from app.session import Session
from app.views.arrays import frozen
from web.messages import OccupancyLayer, OccupancyPicture


def occupancy_layer(session: Session) -> OccupancyLayer | None:
    brain = session.brain
    if brain.occupancy is None or brain.map_grid is None:
        return None
    grid, poses = copy.deepcopy(brain.map_grid), brain.experience_map.poses.copy()

    def draw_map() -> OccupancyPicture:
        drawn = grid.draw(poses)
        return OccupancyPicture(frozen(drawn.probability), drawn.origin_xy_m, drawn.cell_m)

    return OccupancyLayer(frozen(brain.occupancy.probability), draw_map)
