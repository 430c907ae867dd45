"""Builds the immutable Snapshot of a session. Parts that cost much are built at the rates at which people can see them."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar, cast

import numpy as np
import scipy.sparse.csgraph  # noqa: F401 - the goal memory imports it for its first goal; not while the robot drives
from numpy.typing import NDArray

from app.chronicle import Chronicle
from app.config import Value
from app.inspection import inspect
from app.living_layer import LivingView
from app.presets import PRESETS, preset_of
from app.session import Session
from app.tick_stages import Walk
from ratslam_core import Pose2
from sim2d import SONAR_ANGLES_RAD, World, draw_world
from web.messages import (
    Goal,
    GoalMemoryLayer,
    Inspect,
    MapLayer,
    OccupancyLayer,
    OccupancyPicture,
    OfficeEdition,
    Packet,
    Parameter,
    Pose,
    PoseCellLayer,
    Report,
    Senses,
    Snapshot,
    TimesLayer,
    Timing,
    WorldDrawing,
)

MAP_EVERY_S = 0.5  # of wall time
TIMES_EVERY_S = 0.25
OCCUPANCY_EVERY_S = 2.0
GOAL_MEMORY_EVERY_S = 0.5
INSPECT_EVERY_S = 0.25
REST = 30.0  # times what it cost to build a part is waited before it is built again, however large it has grown
STRONGEST = 500
_PRESETS = tuple(PRESETS)


class Snapshots:
    """`build` looks at one session; it changes nothing that the session's future depends on."""

    def __init__(self, session: Session, chronicle: Chronicle, run: int, worlds: tuple[tuple[str, str], ...]) -> None:
        self._session, self._chronicle, self._run, self.worlds = session, chronicle, run, worlds
        self.office: OfficeEdition | None = None
        self._drawn: tuple[object, object] | None = None
        self._world = self._draw_world()
        self._living = LivingView()
        self._map: MapLayer | None = None
        self._times: TimesLayer | None = None
        self._goal_timed: int | None = None
        self._map_due = self._times_due = -math.inf
        self._parameters: tuple[object, tuple[Parameter, ...], str] | None = None
        self._occupancy = Slow(OCCUPANCY_EVERY_S, lambda: _occupancy(session))
        self.inspected = Inspect(type="inspect")  # what is looked at: nothing
        self.walk: Walk | None = None  # through the last tick
        self._inspection = Slow(INSPECT_EVERY_S, self._inspect)
        self._goal_memory = Slow(GOAL_MEMORY_EVERY_S, lambda: _goal_memory(session))

    def refresh(self) -> None:
        """Build everything anew with the next snapshot: a command has changed something."""
        self._map_due = self._times_due = self._goal_memory.due = self._inspection.due = -math.inf

    def build(self, *, running: bool, speed: float, real_time_factor: float, fault: str | None) -> Snapshot:
        session, chronicle = self._session, self._chronicle
        brain, truth = session.brain, session.simulator.truth
        parts = self.parts() | (self.walk.parts if self.walk is not None else {})
        return Snapshot(
            run=self._run,
            tick=session.tick_count,
            time_s=session.time_s,
            mode=session.pilot.mode,
            doing=session.pilot.doing,
            running=running,
            speed=speed,
            real_time_factor=real_time_factor,
            seed=session.seed,
            fault=fault,
            lost=chronicle.lost,
            world=self._draw_world(),
            worlds=self.worlds,
            truth=Pose(truth.x, truth.y, truth.heading_rad),
            trail=_frozen(chronicle.trail),
            estimate=parts["estimate"],
            senses=_senses(session),
            pose_cells=parts["pose_cells"],
            map=parts["map"],
            times=parts["times"],
            goal=_goal(session),
            views=len(brain.local_view),
            experiences=len(brain.experience_map),
            links=brain.experience_map.link_count,
            relocalisations=brain.relocalisations,
            error_map_m=chronicle.error_map_m,
            error_odometry_m=chronicle.error_odometry_m,
            revisit_consistency=session.evaluation.revisit_consistency,
            series=chronicle.series,
            timings=tuple(Timing(part, *ms) for part, ms in session.stopwatch.mean_and_worst_ms.items()),
            events=chronicle.events,
            parameters=self._parameter_rows()[0],
            occupancy=self._occupancy.part(session.tick_count),
            goal_memory=self._goal_memory.part(session.tick_count),
            living=self._living.look(session.simulator),
            inspected=self._inspection.part(session.tick_count),
            active_experience=brain.experience_map.active,
            walk=None if self.walk is None else self.walk.told,
            presets=_PRESETS,
            preset=self._parameter_rows()[1],
            office=self.office,
        )

    def _draw_world(self) -> WorldDrawing:
        """Drawn anew only when walls, places, lens or the robot's size have changed."""
        simulator, params = self._session.simulator, self._session.simulator.params
        world, drawn = simulator.world, self._drawn
        now = (world.name, world.title, world.slow_zones, world.places, params.camera_fov_rad, params.robot_radius_m)
        if drawn is None or drawn[0] is not world.walls or drawn[1] != now:
            self._drawn = (world.walls, now)
            self._world = world_drawing(world, params.robot_radius_m, params.camera_fov_rad)
        return self._world

    def parts(self) -> dict[str, Any]:
        """What a walk through a tick shows as it was at each stage: fields of the snapshot, as they are now."""
        layer, times = self._map_layers()
        estimate = _pose(self._session.brain.experience_map.robot)
        return {
            "pose_cells": _pose_cells(self._session, self._chronicle),
            "map": layer,
            "times": times,
            "estimate": estimate,
        }

    def _map_layers(self) -> tuple[MapLayer, TimesLayer]:
        """Map and times of one moment; rows of both agree."""
        now = time.perf_counter()
        experiences = self._session.brain.experience_map
        if self._map is None or self._times is None or now >= self._map_due:
            poses = experiences.poses.astype(np.float32)
            self._map = MapLayer(
                _frozen(np.arange(len(poses), dtype=np.int32)),
                _frozen(np.ascontiguousarray(poses[:, :2])),
                _frozen(np.ascontiguousarray(poses[:, 2])),
                _frozen(experiences.links.astype(np.int32)),
            )
            self._map_due, self._times_due = now + MAP_EVERY_S, -math.inf
        goal = self._session.pilot.goal
        if self._times is None or now >= self._times_due or goal != self._goal_timed:
            shown = len(self._map.ids)
            source = experiences.active if goal is None else goal
            seconds = experiences.temporal_map.times_to(source)[:shown].astype(np.float32)
            self._times = TimesLayer(goal is not None, _frozen(seconds))
            self._times_due, self._goal_timed = now + TIMES_EVERY_S, goal
        return self._map, self._times

    def _inspect(self) -> Report | None:
        return inspect(self._session, self._chronicle, self.inspected)

    def _parameter_rows(self) -> tuple[tuple[Parameter, ...], str]:
        """All parameters, and the preset that they are."""
        config = self._session.config
        if self._parameters is None or self._parameters[0] is not config:
            rows = [
                Parameter(name=name, value=value, default=cast(Value, item.default), **item.metadata)
                for name, item, value in config.items()
            ]
            self._parameters = (config, tuple(rows), preset_of(config))
        return self._parameters[1:]


Part = TypeVar("Part")


class Slow(Generic[Part]):
    """A part that costs much: built anew when the session has moved on and the time has come."""

    def __init__(self, every_s: float, build: Callable[[], Part]) -> None:
        self.due = -math.inf
        self._every_s, self._build = every_s, build
        self._built: tuple[int, Part] | None = None

    def part(self, tick: int) -> Part:
        began = time.perf_counter()
        if self._built is None or began >= self.due:
            if self._built is None or self._built[0] != tick or self.due == -math.inf:
                self._built = (tick, self._build())
            now = time.perf_counter()
            self.due = now + max(self._every_s, REST * (now - began))
        return self._built[1]


def _occupancy(session: Session) -> OccupancyLayer | None:
    brain = session.brain
    if brain.occupancy is None or brain.map_grid is None:
        return None
    grid, poses = copy.deepcopy(brain.map_grid), brain.experience_map.poses.copy()

    def draw_map() -> OccupancyPicture:
        drawn = grid.draw(poses)
        return OccupancyPicture(_frozen(drawn.probability), drawn.origin_xy_m, drawn.cell_m)

    return OccupancyLayer(_frozen(brain.occupancy.probability), draw_map)


def _goal_memory(session: Session) -> GoalMemoryLayer:
    memory, goal = session.brain.goal_memory, session.pilot.goal
    if goal is None:
        return GoalMemoryLayer(len(memory), None, None, None)
    x, y, _, _ = session.brain.experience_map.cell_state(goal)
    cell = round(x) % memory.shape[2], round(y) % memory.shape[1]
    times = memory.times_to(*cell)
    direction = memory.direction(times, session.brain.pose_cells.winner)
    return GoalMemoryLayer(len(memory), cell, _frozen(times.astype(np.float32)), direction)


def world_drawing(world: World, robot_radius_m: float, camera_fov_rad: float) -> WorldDrawing:
    """What the stage draws of a world."""
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
        sonar_angles_rad=_frozen(np.array(SONAR_ANGLES_RAD, np.float32)),
        slow_zones=tuple(_frozen(np.array(zone.corners, np.float32)) for zone in world.slow_zones),
    )


def _senses(session: Session) -> Senses:
    recognition, local_view = session.estimate.recognition, session.brain.local_view
    best, front_end = recognition.best_view, local_view.front_end
    stored = local_view.stored(best) if best >= 0 else None
    return Senses(
        camera=session.frame.image,
        front_end=local_view.params.front_end,
        seen=_frozen(front_end.picture(local_view.features).copy()),
        seen_words=front_end.words(local_view.features),
        best=None if stored is None else _frozen(front_end.picture(stored).copy()),
        best_words="" if stored is None else front_end.words(stored),
        best_view=best,
        difference=recognition.difference,
        threshold=front_end.threshold(local_view.params),
        active_view=recognition.view,
        recruited=recognition.recruited,
        false_positive=recognition.false_positive,
        false_positives=local_view.false_positives,
        ranges_m=session.frame.ranges_m,
    )


def _pose_cells(session: Session, chronicle: Chronicle) -> PoseCellLayer:
    pose_cells = session.brain.pose_cells
    cells, activity = pose_cells.active
    strongest = np.argsort(-activity, kind="stable")[:STRONGEST]
    packets = tuple(Packet(p.x, p.y, p.heading_rad, p.mass, p.id) for p in pose_cells.packets)
    return PoseCellLayer(
        shape=pose_cells.shape,
        cell_m=pose_cells.params.cell_m,
        cells=_frozen(np.ascontiguousarray(cells[strongest][:, [2, 1, 0]], np.int32)),
        activity=_frozen(activity[strongest]),
        active_cells=len(activity),
        packets=packets,
        path=_frozen(chronicle.path),
        last_snap=chronicle.last_snap,
        total=float(activity.sum(dtype=np.float64)),
        least=float(activity.min()),
    )


def _goal(session: Session) -> Goal | None:
    experiences = session.brain.experience_map
    progress = session.pilot.progress(experiences)
    if progress is None:
        return None
    goal = experiences.pose(progress.experience)
    xy = experiences.poses[progress.route, :2]
    return Goal(
        progress.experience, goal.x, goal.y, progress.state, progress.eta_s, progress.remaining_m,
        _frozen(xy.astype(np.float32)), _frozen(progress.arrival_s.astype(np.float32)),
    )  # fmt: skip


def _pose(pose: Pose2) -> Pose:
    return Pose(pose.x, pose.y, pose.heading_rad)


def _frozen(array: NDArray) -> NDArray:
    array.setflags(write=False)
    return array
