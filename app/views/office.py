"""What the page shows of an office: its world, actors and named places; and in it the robot's odometry, the arcs that
it tried, its goal and the places that were tagged.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from app.session import Session, is_lost
from app.views.arrays import frozen
from app.views.history import TRAIL_S
from disk import encode
from ratslam_core import Pose2
from ratslam_core.pose_graph.transitions import moved_by
from sim2d import SONAR_ANGLES_RAD, Simulator, World, draw_world
from web.messages import Ghost, Goal, KnownPlace, LivingLayer, Movements, Pose, TaggedPlace, Trip, WorldDrawing


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
    """The walls and what they look like, places, slow floors, and the robot's fixed measures."""
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


class ActorsView:
    """The actors of one simulator. Their layer is the same object as long as nothing has moved."""

    def __init__(self) -> None:
        self._seen: tuple[object, str] | None = None
        self._layer: LivingLayer | None = None
        self._world: World | None = None
        self._switches: tuple[str, ...] = ()

    def switches(self, world: World) -> tuple[str, ...]:
        """The parameters of the section `office` that have an effect in this world."""
        if self._world is not world:
            self._world, self._switches = world, _switches(world)
        return self._switches

    def look(self, simulator: Simulator) -> LivingLayer | None:
        """The layer as it is now; None if the world has no actors."""
        world, living = simulator.world, simulator.actors
        if not (world.doors or world.boxes or world.people or world.lamps or world.daylight or world.script):
            return None
        seen = (world, encode(living).digest())
        if self._seen is None or self._seen[0] is not world or self._seen[1] != seen[1]:
            self._seen, self._layer = seen, _layer(simulator)
        return self._layer


def _switches(world: World) -> tuple[str, ...]:
    there = {
        "people": bool(world.people),
        "doors": any(door.period_s > 0 for door in world.doors),
        "lamps": bool(world.lamps),
        "daylight": world.daylight is not None,
        "reflections": any(wall.kind == "glass" for wall in world.walls),
        "door_s": bool(world.doors),
        "patience_least_s": bool(world.people),
        "patience_most_s": bool(world.people),
        "slow_zones": bool(world.slow_zones),
        "boxes": bool(world.boxes),
        "script": bool(world.script),
        "seed": bool(world.people),
    }
    return tuple(name for name, is_there in there.items() if is_there)


def _layer(simulator: Simulator) -> LivingLayer:
    world, living = simulator.world, simulator.actors
    boxes = [box for box, is_there in zip(world.boxes, living.box_present, strict=True) if is_there]
    walkers = living.walkers
    there = np.flatnonzero(walkers.present)
    people = [world.people[i] for i in there]
    rows = [(*walkers.xy[i], walkers.heading[i], p.radius, p.height) for i, p in zip(there, people, strict=True)]
    return LivingLayer(
        door_names=tuple(door.name for door in world.doors),
        doors=_table(living.segments[: len(world.doors)], 4),
        door_wanted=frozen(living.door_wanted),
        door_opening=frozen(living.opening.astype(np.float32)),
        box_names=tuple(box.name for box in boxes),
        boxes=_table([(b.x, b.y, b.width, b.depth, b.height, b.angle_rad) for b in boxes], 6),
        box_rgb=frozen(np.array([b.colour for b in boxes], np.uint8).reshape(-1, 3)),
        person_names=tuple(person.name for person in people),
        people=_table(rows, 5),
        people_rgb=frozen(np.array([p.colour for p in people], np.uint8).reshape(-1, 3)),
        lamp_names=tuple(lamp.name for lamp in world.lamps),
        lamps=_table([(k.x, k.y, k.reach, float(on)) for k, on in zip(world.lamps, living.lit, strict=True)], 4),
        lamp_on=frozen(living.lamp_on.copy()),
        daylight=living.daylight,
    )


def _table(rows: object, width: int) -> NDArray[np.float32]:
    return frozen(np.array(rows, np.float32).reshape(-1, width))


REACH_M = 1.5  # an experience that was truly made this near to a place stands for it


def known_places(session: Session) -> tuple[KnownPlace, ...]:
    """The named places, and where the map has those at which the robot has been: for people, who click on names.

    The names are in the office's frame; the robot gets a place of its own map, as with any click on the map.
    """
    if not session.source.worlds:
        return ()
    poses = session.brain.experience_map.poses
    births = session.evaluation.births(len(poses))
    found: list[KnownPlace] = []
    for place in session.simulator.world.places:
        away = np.hypot(births[:, 0] - place.x, births[:, 1] - place.y)
        near = np.flatnonzero(away <= REACH_M)  # not where an experience was made unknown to us: NaN
        nearest = None if not len(near) else int(near[away[near].argmin()])
        xy = None if nearest is None else (float(poses[nearest, 0]), float(poses[nearest, 1]))
        found.append(KnownPlace(place.name, place.x, place.y, xy))
    return tuple(found)


POINTS = 300  # of the path


def ghost_of(session: Session) -> Ghost | None:
    """The robot as it would be if it believed its wheels alone: odometry from the start pose on, without an observation
    or a correction. None without truth: then nobody knows where the run began."""
    if session.truth is None:
        return None
    evaluation = session.evaluation
    ticks = int(TRAIL_S / session.frame.dt)
    path = evaluation.odometry_path(ticks, max(1, ticks // POINTS))
    office, map_ = evaluation.began(session.brain.experience_map)
    return Ghost(shown(evaluation.odometry), frozen(path.astype(np.float32)), shown(office), shown(map_))


def shown(pose: Pose2) -> Pose:
    """A pose of the engine as one that is shown."""
    return Pose(pose.x, pose.y, pose.heading_rad)


def movements_of(session: Session) -> Callable[[], Movements] | None:
    """Draws the local movements that the robot tried in this tick, in any thread, if somebody wants to see them.

    None: it chose no arc. They begin where it chose, a tick ago; its odometry since then tells where that was.
    """
    look = session.pilot.look_at_choice()
    if look is None:
        return None
    truth = session.simulator.truth
    start = Pose2(truth.x, truth.y, truth.heading_rad).compose(moved_by(session.odometry).inverse())

    def draw() -> Movements:
        found = look()
        c, s = np.cos(start.heading_rad), np.sin(start.heading_rad)
        paths = found.paths @ np.array([(c, s), (-s, c)]) + (start.x, start.y)
        return Movements(
            frozen(paths.astype(np.float32)),
            frozen(found.length_m.astype(np.float32)),
            frozen(found.turned_rad.astype(np.float32)),
            start.heading_rad,
            frozen(found.speed > 0),
            frozen(np.isfinite(found.cost)),
            found.chosen,
        )

    return draw


def goal_view(session: Session) -> Goal | None:
    """The goal and the route to it, with the times at which the robot should pass its experiences."""
    experiences = session.brain.experience_map
    progress = session.pilot.progress(experiences)
    if progress is None:
        return None
    goal = experiences.pose(progress.experience)
    xy = experiences.poses[progress.route, :2]
    return Goal(
        progress.experience, goal.x, goal.y, progress.state, progress.eta_s, progress.remaining_m,
        frozen(xy.astype(np.float32)), frozen(progress.arrival_s.astype(np.float32)),
        frozen(experiences.poses[list(session.pilot.goals), :2].astype(np.float32)),
        is_lost(session), session.pilot.mode == "goal", progress.why,
    )  # fmt: skip


BESIDE_M = 1.5  # a label reaches about so far


def trip_view(session: Session) -> Trip | None:
    found = session.pilot.trip(session.brain.experience_map) if session.source.driven else None
    if found is None:
        return None
    (x, y), reason, openings = found
    robot = session.brain.experience_map.robot
    return Trip(x, y, reason, frozen(openings.astype(np.float32)), math.hypot(x - robot.x, y - robot.y) < BESIDE_M)


def tags_view(session: Session) -> tuple[TaggedPlace, ...]:
    poses = session.brain.experience_map.poses
    return tuple(
        TaggedPlace(name, experience, float(poses[experience, 0]), float(poses[experience, 1]))
        for name, experience in session.tags.items()
    )
