"""What people alone know, laid over office and map: the wheels' ghost, the true outline, the error and the doubt of the estimate.

Each has its switch. Where nobody knows the truth, what needs it is not drawn.
"""

from __future__ import annotations

import numpy as np
import viser

from web.latest import Throttle
from web.messages import Ghost, Pose, Snapshot, Spread, WorldDrawing
from web.switches import Switches
from web.viewer.fits import DEPTH, WIDTH, error_line, judged, on_plate, walls_in_map, wheels_alone, wheels_path
from web.viewer.marks.doubt import Doubt
from web.viewer.marks.outline import Outline
from web.viewer.marks.robot import GhostRobot
from web.viewer.plates.map_plate import MapPlate
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.primitives.palette import Palette, mix

HALF = (WIDTH / 2, DEPTH / 2)
OUTLINE_Z = 0.012
GHOST_RADIUS = 0.22  # plate units, on the map, where the robot is an arrow


class JudgedLayers:
    def __init__(
        self, scene: viser.SceneApi, palette: Palette, office: OfficePlate, plate: MapPlate, switches: Switches
    ) -> None:
        self._office, self._plate, self._switches = office, plate, switches
        self.outline = Outline(
            scene, f"{plate.root}/outline", palette.drawn(mix(palette.floor, palette.wall, 0.75)), HALF, OUTLINE_Z
        )
        self.ghost = GhostRobot(scene, palette, f"{plate.root}/ghost", HALF, plate.labels, GHOST_RADIUS)
        self.doubt = Doubt(scene, palette, plate.root, plate.labels)
        self._layers = {
            "outline": Throttle(1, self._outline),
            "ghost": Throttle(6, self._ghost),
            "ghost_path": Throttle(1, self._ghost_path),
            "error": Throttle(6, self._error),
            "spread": Throttle(6, self._spread),
        }

    def draw(self, snapshot: Snapshot, now_s: float) -> None:
        offer, shown, frame = self._layers, judged(snapshot, self._switches.on), snapshot.map_in_office
        offer["outline"].offer(now_s, shown.walls_of, None if shown.walls_of is None else frame)
        offer["ghost"].offer(now_s, shown.ghost, snapshot.truth)
        offer["ghost_path"].offer(now_s, shown.ghost)
        offer["error"].offer(now_s, snapshot.estimate, shown.truth, frame)
        offer["spread"].offer(now_s, snapshot.estimate, shown.spread)

    def hurry(self) -> None:
        """Whatever is offered next is due."""
        for layer in self._layers.values():
            layer.hurry()

    def forget(self) -> None:
        """The map has moved on its plate, or the office is another one."""
        for layer in self._layers.values():
            layer.forget()

    # ------------------------------------------------------------ one layer each

    def _outline(self, world: WorldDrawing | None, frame: Pose | None) -> None:
        if world is None or frame is None:
            self.outline.show(np.zeros((0, 4)))
            return
        walls = walls_in_map(world, frame).reshape(-1, 2)
        self.outline.show(self._plate.fit.to_plate(walls).reshape(-1, 4))

    def _ghost(self, ghost: Ghost | None, truth: Pose | None) -> None:
        if ghost is None or truth is None:
            self._office.ghost.hide()
            self.ghost.hide()
            return
        office, map_, off_m = wheels_alone(ghost, truth)
        x, y = self._office.fit.to_plate(np.array([[office.x, office.y]]))[0].tolist()
        self._office.ghost.show(Pose(x, y, office.heading_rad), off_m)
        self.ghost.show(on_plate(map_, self._plate.fit), off_m)

    def _ghost_path(self, ghost: Ghost | None) -> None:
        if ghost is None:
            return
        in_office, in_map = wheels_path(ghost)
        self._office.ghost.show_path(self._office.fit.to_plate(in_office))
        self.ghost.show_path(self._plate.fit.to_plate(in_map))

    def _error(self, estimate: Pose, truth: Pose | None, frame: Pose | None) -> None:
        if truth is None or frame is None:
            self.doubt.hide_error()
            return
        line, metres = error_line(estimate, truth, frame)
        at, there = self._plate.fit.to_plate(line)
        self.doubt.show_error(at, there, metres)

    def _spread(self, estimate: Pose, spread: Spread | None) -> None:
        if spread is None:
            self.doubt.hide_spread()
            return
        fit = self._plate.fit
        at = fit.to_plate(np.array([[estimate.x, estimate.y]]))[0]
        along, across = fit.scale * spread.along_m, fit.scale * spread.across_m
        self.doubt.show_spread(at, along, across, spread.turn_rad + fit.turn_rad)
