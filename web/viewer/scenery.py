"""The plates on the stage: those of one brain, and of a second one beside it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from web.latest import Throttle
from web.messages import BesideView, MapLayer, PoseCellLayer, Snapshot
from web.viewer.camera_views import stands
from web.viewer.cameras import Robots
from web.viewer.plates.lesson_marks import LessonMarks
from web.viewer.plates.map_plate import NODE_Z, MapPlate, on_sheet
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.plates.plate import point_on_plane
from web.viewer.plates.pose_cell_plate import PoseCellPlate
from web.viewer.primitives import images
from web.viewer.primitives.palette import BRAINS, KEY_AT, RIM_AT, RIM_LIGHT, RIM_TINT, WHITE, Palette


class Scenery:
    """The three plates of a brain with one light, one sky and one palette."""

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


class Beside:
    """The second brain's plates, and where all plates stand: each brain has its pose cells behind and its map in front, and the
    office they share stands between. Made when they are first needed, and hidden while there is one brain only.
    """

    def __init__(
        self, scene: viser.SceneApi, palette: Palette, scenery: Scenery, moved: Callable[[bool], None]
    ) -> None:
        """moved: is told when the plates have been moved, and whether there are two brains now."""
        self._scene, self._palette, self._scenery, self._moved = scene, palette, scenery, moved
        self._stands: tuple[bool, bool] = (True, False)  # with an office; with two brains
        self._names: tuple[str, str] | None = None
        self.cells: PoseCellPlate | None = None
        self.map: MapPlate | None = None
        self._layers: dict[str, Throttle] = {}

    def draw(self, view: BesideView | None, now_s: float, *, office: bool) -> None:
        """office: whether there is one."""
        if (office, view is not None) != self._stands:
            self._arrange(office=office, two=view is not None)
        names = None if view is None else (view.first.name, view.second.name)
        if names != self._names:
            self._name(names)
        if view is None:
            return
        offer, cells = self._layers, view.pose_cells
        offer["cells"].offer(now_s, cells)
        offer["path"].offer(now_s, cells.path, cells.shape)
        offer["glow"].offer(now_s, cells)
        offer["map"].offer(now_s, view.map, view.map_turn_rad)
        offer["times"].offer(now_s, view.times)
        offer["estimate"].offer(now_s, view.estimate)
        offer["others"].offer(now_s, view.others)
        offer["cell_others"].offer(now_s, view.others, view.pose_cells.shape)
        offer["goal"].offer(now_s, view.goal)

    def hurry(self) -> None:
        """Whatever is offered next is due."""
        for layer in self._layers.values():
            layer.hurry()

    @property
    def two(self) -> bool:
        return self._stands[1]

    def holds(self, origin: tuple[float, float, float], direction: tuple[float, float, float]) -> bool:
        """Whether a ray meets the second brain's map."""
        if self.map is None or not self.two:
            return False
        at = point_on_plane(np.array(origin), np.array(direction), self.map.origin, NODE_Z)
        return at is not None and on_sheet(at)

    def _arrange(self, *, office: bool, two: bool) -> None:
        self._stands = office, two
        first, at = self._scenery, stands(office=office, two=two)
        if two:
            self._make()
        for plate, where in zip(
            (first.office, first.cells, first.map), (at.office, at.cells[0], at.maps[0]), strict=True
        ):
            plate.stand_at(*where)
        if self.cells is not None and self.map is not None:
            self.cells.frame.visible = self.map.frame.visible = two
            self.cells.stand_at(*at.cells[-1])
            self.map.stand_at(*at.maps[-1])
        self._moved(two)

    def _make(self) -> None:
        """The plates of the second brain, once."""
        if self.cells is None:
            self.cells = cells = PoseCellPlate(self._scene, self._palette, "pose_cells_2")
            self.map = plate = MapPlate(self._scene, self._palette, "map_2")
            self._layers = {  # less often than the first one's, so that two cost less than twice as much as one
                "cells": Throttle(5, cells.set_cells),
                "path": Throttle(2, cells.set_path),
                "glow": Throttle(2, self._draw_glow),
                "map": Throttle(2, self._draw_map),
                "times": Throttle(2, plate.set_times),
                "estimate": Throttle(10, plate.set_robot),
                "others": Throttle(5, plate.set_others),
                "cell_others": Throttle(5, cells.set_others),
                "goal": Throttle(2, plate.set_goal),
            }
        for layer in self._layers.values():
            layer.forget()

    def _draw_glow(self, layer: PoseCellLayer) -> None:
        assert self.cells is not None
        self.cells.set_glow(layer, self.cells.under)

    def _draw_map(self, layer: MapLayer, turn_rad: float) -> None:
        assert self.map is not None
        if self.map.set_map(layer, turn_rad):
            for name in ("times", "estimate", "others", "goal"):
                self._layers[name].forget()

    def _name(self, names: tuple[str, str] | None) -> None:
        """Every plate of a brain bears its name and colour; None: there is one brain, which needs neither."""
        self._names = names
        colours = BRAINS[self._palette.dark]
        for k, plates in enumerate(((self._scenery.cells, self._scenery.map), (self.cells, self.map))):
            for plate in plates:
                if plate is not None:
                    plate.belong_to(None if names is None else (names[k], colours[k]))
