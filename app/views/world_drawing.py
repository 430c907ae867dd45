"""What the viewer draws of a world: the walls and their looks, places, slow floors, and the robot's fixed measures."""

from __future__ import annotations

import numpy as np

from app.views.arrays import frozen
from sim2d import SONAR_ANGLES_RAD, Simulator, World, draw_world
from web.messages import WorldDrawing


class DrawnWorld:
    """Made anew only when walls, names, slow floors, field of view or the robot's size have changed."""

    def __init__(self) -> None:
        self._drawn: tuple[object, object, WorldDrawing] | None = None

    def look(self, simulator: Simulator) -> WorldDrawing:
        world, params, drawn = simulator.world, simulator.params, self._drawn
        now = (world.name, world.title, world.slow_zones, world.places, params.camera_fov_rad, params.robot_radius_m)
        if drawn is None or drawn[0] is not world.walls or drawn[1] != now:
            drawn = (world.walls, now, world_drawing(world, params.robot_radius_m, params.camera_fov_rad))
            self._drawn = drawn
        return drawn[2]


def world_drawing(world: World, robot_radius_m: float, camera_fov_rad: float) -> WorldDrawing:
    """What the viewer draws of a world."""
    drawing = draw_world(world)
    return WorldDrawing(
        name=world.name,
        title=world.title,
        bounds=world.bounds,
        walls=drawing.walls,
        wall_height_m=drawing.wall_height_m,
        wall_kind=drawing.wall_kind,
        panels=drawing.panels,
        panel_rgb=drawing.panel_rgb,
        places=tuple((place.name, place.x, place.y) for place in world.places),
        robot_radius_m=robot_radius_m,
        camera_fov_rad=camera_fov_rad,
        sonar_angles_rad=frozen(np.array(SONAR_ANGLES_RAD, np.float32)),
        slow_zones=tuple(frozen(np.array(zone.corners, np.float32)) for zone in world.slow_zones),
    )
