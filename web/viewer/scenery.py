"""The three plates with one light, one sky and one palette."""

from __future__ import annotations

import numpy as np
import viser

from web.messages import Snapshot
from web.viewer.cameras import Robots
from web.viewer.plates.lesson_marks import LessonMarks
from web.viewer.plates.map_plate import MapPlate
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.plates.pose_cell_plate import PoseCellPlate
from web.viewer.primitives import images
from web.viewer.primitives.palette import KEY_AT, RIM_AT, RIM_LIGHT, RIM_TINT, WHITE, Palette


class Scenery:
    def __init__(self, scene: viser.SceneApi, palette: Palette) -> None:
        scene.configure_environment_map(None)
        scene.configure_default_lights(enabled=False, cast_shadow=False)
        scene.set_background_image(images.sky(palette.sky_top, palette.sky_bottom), format="png")
        scene.add_light_ambient("/lights/ambient", color=WHITE, intensity=palette.ambient)
        scene.add_light_directional(
            "/lights/key", color=WHITE, intensity=palette.key, cast_shadow=False, position=KEY_AT
        )
        scene.add_light_directional(
            "/lights/rim", color=RIM_TINT, intensity=RIM_LIGHT, cast_shadow=False, position=RIM_AT
        )
        self.office = OfficePlate(scene, palette)
        self.cells = PoseCellPlate(scene, palette)
        self.map = MapPlate(scene, palette)
        self.lesson = LessonMarks(scene, palette, self.office, self.map, self.cells)

    def robots(self, snapshot: Snapshot) -> Robots:
        """Where the robot stands on each plate, in the scene."""
        found: Robots = {}
        here, truth = snapshot.estimate, snapshot.truth
        if truth is not None and snapshot.world is not None:
            at = self.office.fit.to_plate(np.array([[truth.x, truth.y]]))[0]
            found["office"] = np.array([*at, 0.0]) + self.office.origin, self.office.fit.scale
        if snapshot.experiences:
            at = self.map.fit.to_plate(np.array([[here.x, here.y]]))[0]
            found["map"] = np.array([*at, 0.0]) + self.map.origin, self.map.fit.scale
        return found
