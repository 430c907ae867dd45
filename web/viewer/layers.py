"""What a viewer draws, layer by layer: each is offered what is new of a snapshot, and takes it as often as it needs to."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
import viser

from web.latest import Throttle
from web.messages import Ghost, MapLayer, OccupancyLayer, OccupancyPicture, Pose, Snapshot, Spread, WorldDrawing
from web.switches import Switches
from web.viewer.fits import (
    DEPTH,
    WIDTH,
    MapFit,
    Overlaid,
    error_line,
    judged,
    on_plate,
    overlaid,
    walls_in_map,
    wheels_alone,
    wheels_path,
)
from web.viewer.marks.judged import Doubt, Outline
from web.viewer.marks.robot import GhostRobot
from web.viewer.motion import Motion
from web.viewer.plates.map_plate import MapPlate
from web.viewer.plates.office_plate import OfficePlate
from web.viewer.pointer import Pointer
from web.viewer.primitives.palette import Palette, mix
from web.viewer.replay import Replay
from web.viewer.scenery import Beside, Scenery

ON_MAP = "times", "estimate", "others", "goal", "trip", "tags", "places", "closures"  # layers that move with it


class Layers:
    """All of one viewer. To be used in its thread only."""

    def __init__(
        self, scenery: Scenery, beside: Beside, judged: JudgedLayers, replay: Replay, motion: Motion | None,
        pointer: Pointer, switches: Switches, post: Callable[[Callable[[], None]], None],
    ) -> None:  # fmt: skip
        """post: has something done in the viewer's thread. motion: None: nothing moves by itself."""
        self._scenery, self._beside, self._judged, self._replay = scenery, beside, judged, replay
        self._motion = motion
        self._pointer, self._switches = pointer, switches
        office, cells, map_plate = scenery.office, scenery.cells, scenery.map
        self._run = 0
        self._artist = OccupancyArtist(map_plate, switches, post)
        self._layers: dict[str, Throttle] = {
            "world": Throttle(5, office.set_world),
            "robot": Throttle(15, office.set_robot),
            "movements": Throttle(10, office.set_movements),
            "trail": Throttle(2, office.set_trail),
            "living": Throttle(12, office.set_living),
            "cells": Throttle(6, cells.set_cells),
            "path": Throttle(2, cells.set_path),
            "cell_others": Throttle(6, cells.set_others),
            "glow": Throttle(3, cells.set_glow),
            "map": Throttle(2, self._draw_map),
            "times": Throttle(3, map_plate.set_times),
            "estimate": Throttle(15, map_plate.set_robot),
            "others": Throttle(6, map_plate.set_others),
            "goal": Throttle(3, map_plate.set_goal),
            "trip": Throttle(2, map_plate.set_trip),
            "tags": Throttle(2, map_plate.set_tags),
            "names": Throttle(2, office.set_places),
            "places": Throttle(2, map_plate.set_places),
            "closures": Throttle(1, map_plate.set_closures),
            "lesson": Throttle(3, self._scenery.lesson.show),
            "cell_floor": Throttle(2, cells.set_floor),
            "zone": Throttle(4, cells.set_inspected),
            "inspected": Throttle(4, map_plate.set_inspected),
            "way": Throttle(5, cells.set_way),
            "occupancy": Throttle(0.6, self._artist.draw),
        }

    def stop(self) -> None:
        self._artist.stop()

    @property
    def drawing(self) -> bool:
        """Something is being drawn in another thread."""
        return self._artist.drawing

    def hurry(self) -> None:
        """Whatever is offered next is due."""
        for layer in self._layers.values():
            layer.hurry()
        self._judged.hurry()
        self._beside.hurry()

    def forget(self, *layers: str) -> None:
        """What is offered to these layers next is new to them."""
        for name in layers:
            self._layers[name].forget()

    def draw(self, snapshot: Snapshot, now_s: float) -> None:
        """All that is new and due."""
        offer, cells, laid = self._layers, snapshot.pose_cells, overlaid(snapshot, self._switches.on)
        if offer["world"].offer(now_s, snapshot.world):
            self.forget("robot", "trail", "living", "movements", "names", "lesson")
            self._judged.forget()
        self._beside.draw(snapshot.beside, now_s, office=snapshot.world is not None)
        offer["living"].offer(now_s, snapshot.living)
        if self._motion is not None:
            self._motion.tell(snapshot, now_s)
            self._motion.draw(now_s)
        if self._pointer.dragging or (self._motion is not None and self._motion.lifts):
            self.forget("robot")  # when it is let go, it goes back to its true place
        else:
            offer["robot"].offer(now_s, snapshot.truth, snapshot.senses)
        offer["movements"].offer(now_s, None if self._pointer.dragging else laid.movements)
        offer["trail"].offer(now_s, snapshot.trail)
        offer["names"].offer(now_s, snapshot.places)
        self._draw_overlays(snapshot, laid, now_s)
        offer["cells"].offer(now_s, cells)
        offer["path"].offer(now_s, cells.path, cells.shape)
        others = snapshot.belief.others if snapshot.belief else ()
        offer["cell_others"].offer(now_s, others, cells.shape)
        offer["glow"].offer(now_s, cells, self._scenery.cells.under)
        if self._replay.draw(now_s):
            self.forget("map", *ON_MAP)
        if not self._replay.runs:
            self._draw_on_map(snapshot, now_s)
        self._judged.draw(snapshot, now_s)
        offer["lesson"].offer(now_s, snapshot.lesson)
        self._pointer.settle(snapshot, self._scenery.map, now_s)

    def _draw_on_map(self, snapshot: Snapshot, now_s: float) -> None:
        offer = self._layers
        offer["map"].offer(now_s, snapshot.map, snapshot.map_turn_rad, snapshot.run)
        offer["times"].offer(now_s, snapshot.times)
        offer["estimate"].offer(now_s, snapshot.estimate)
        offer["others"].offer(now_s, snapshot.belief.others if snapshot.belief else ())
        offer["goal"].offer(now_s, snapshot.goal)
        offer["trip"].offer(now_s, snapshot.trip)
        offer["tags"].offer(now_s, snapshot.tags)
        offer["places"].offer(now_s, snapshot.places)
        offer["closures"].offer(now_s, judged(snapshot, self._switches.on).closures, snapshot.map, snapshot)

    def _draw_map(self, layer: MapLayer, turn_rad: float, run: int) -> None:
        if run != self._run:  # its map lies as if there had been none before
            self._run, self._scenery.map.fit = run, MapFit()
        if self._scenery.map.set_map(layer, turn_rad):
            self.forget("inspected", "lesson", *ON_MAP)
            self._judged.forget()
            self._pointer.moved(self._scenery.map)

    def _draw_overlays(self, snapshot: Snapshot, laid: Overlaid, now_s: float) -> None:
        """Draws the overlays that are switched on, and removes the others."""
        offer, cells = self._layers, snapshot.pose_cells
        offer["cell_floor"].offer(now_s, cells.shape, laid.beneath, laid.goal_memory, laid.inspected)
        offer["zone"].offer(now_s, laid.inspected, cells.shape)
        offer["inspected"].offer(now_s, laid.inspected)
        offer["way"].offer(now_s, cells, laid.goal_memory)
        if not self._artist.drawing:
            offer["occupancy"].offer(now_s, laid.occupancy)


class OccupancyArtist:
    """Draws what the sonars met in a thread of its own, since that may take longer than a frame. `post` brings it back to the
    viewer's thread."""

    def __init__(self, plate: MapPlate, switches: Switches, post: Callable[[Callable[[], None]], None]) -> None:
        self._plate, self._switches, self._post = plate, switches, post
        self._artist = ThreadPoolExecutor(1, "artist")
        self.drawing = False

    def draw(self, layer: OccupancyLayer | None) -> None:
        """If the switch is off by the time the picture is done, it is dropped."""
        if layer is None:
            self._plate.set_occupancy(None)
            return
        self.drawing = True

        def drawn(future: Future[OccupancyPicture]) -> None:
            if not future.cancelled():
                self._post(lambda: self._lay(future))

        self._artist.submit(layer.draw_map).add_done_callback(drawn)

    def stop(self) -> None:
        self._artist.shutdown(cancel_futures=True)

    def _lay(self, future: Future[OccupancyPicture]) -> None:
        self.drawing = False
        if self._switches.is_on("occupancy"):
            self._plate.set_occupancy(future.result())


HALF = (WIDTH / 2, DEPTH / 2)
OUTLINE_Z = 0.012
GHOST_RADIUS = 0.22  # plate units, on the map, where the robot is an arrow


class JudgedLayers:
    """What people alone know, over office and map: the wheels' ghost, the true walls, the error and covariance of the estimate.

    Each has its switch. Where nobody knows the truth, what needs it is not drawn.
    """

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
