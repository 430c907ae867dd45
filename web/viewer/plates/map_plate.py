"""The experience map's plate: the map that the robot has built, coloured by the time to the goal (or from the robot)."""

from __future__ import annotations

import math

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import (
    Closure,
    Goal,
    Hypothesis,
    KnownPlace,
    MapLayer,
    OccupancyPicture,
    Pose,
    Report,
    Snapshot,
    TaggedPlace,
    TimesLayer,
    Trip,
)
from web.messages.robot_status import goal_status, seconds_words
from web.viewer.camera_views import MAP_AT, SHEET
from web.viewer.fits import DEPTH, WIDTH, MapFit, refit
from web.viewer.marks.graph import ClosureMarks, Links, Nodes
from web.viewer.marks.hypotheses import Hypotheses
from web.viewer.marks.inspected import MapMark
from web.viewer.marks.names import PlaceNames, TagMarks
from web.viewer.marks.robot import pale
from web.viewer.marks.route import GoalFlag, Route
from web.viewer.plates.overlays import map_floor
from web.viewer.plates.plate import FLOOR_Z, TEXT_Z, Plate
from web.viewer.primitives import images, meshes
from web.viewer.primitives.labels import ROBOT, Sign, add_mesh, add_picture
from web.viewer.primitives.palette import Palette

ORIGIN = (*MAP_AT, 0.0)
NODE_Z, LINK_Z, ARROW_Z = 0.05, 0.03, 0.22
ROBOT_SIZE = (0.9, 0.7)  # as it is seen, whatever its heading
BAR = (2.7, 0.26)
BAR_X = 3.65
GRID_LINES = 48
TIME_STEPS = 64  # shades of the map: a dot whose time changes by less than one is not sent again
NEAR = 0.5
NO_MAP = "no map yet: the robot has not moved"


class MapPlate(Plate):
    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str = "map") -> None:
        super().__init__(scene, palette, name, ORIGIN, beside_title=BAR[0] + 0.3)
        self.fit = MapFit()
        self._layer: MapLayer | None = None
        floor = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (WIDTH / 2, DEPTH / 2)
        add_mesh(scene, f"{self.root}/floor", meshes.flat_polygon(floor, FLOOR_Z), palette.lit(palette.floor))
        self._picture: OccupancyPicture | None = None
        self._occupancy = add_picture(
            scene,
            f"{self.root}/occupancy",
            images.sky(palette.floor, palette.floor),
            WIDTH,
            DEPTH,
            position=(0, 0, FLOOR_Z + 0.005),
            format="jpeg",
            jpeg_quality=88,
            visible=False,
        )
        self._grid = scene.add_line_segments(
            f"{self.root}/grid", meshes.NOWHERE, palette.drawn(palette.grid), thickness=0.025
        )
        self._links = Links(scene, f"{self.root}/links", palette.drawn(palette.link))
        self._nodes = Nodes(scene, f"{self.root}/nodes", 0.075)
        self._arrow = scene.add_frame(f"{self.root}/arrow", show_axes=False, visible=False)
        add_mesh(scene, f"{self.root}/arrow/casing", meshes.heading_arrow(1.22, 0.0), palette.lit(palette.casing))
        add_mesh(scene, f"{self.root}/arrow/body", meshes.heading_arrow(1.0, 0.02), palette.lit(palette.robot))
        self._others = Hypotheses(scene, palette, f"{self.root}/other", self.labels)
        self._route = Route(scene, palette, f"{self.root}/route", self.labels)
        self._flag = GoalFlag(scene, palette, f"{self.root}/flag", self.labels)
        self._trip = TagMarks(scene, palette, f"{self.root}/trip", self.labels)
        self._openings = Nodes(scene, f"{self.root}/openings", 0.05)
        self._tags = TagMarks(scene, palette, f"{self.root}/tags", self.labels)
        self.names = PlaceNames(scene, palette, f"{self.root}/name", self.labels)
        self.closures = ClosureMarks(scene, palette, f"{self.root}/closure", self.labels)
        self._clicked = scene.add_frame(f"{self.root}/clicked", show_axes=False, visible=False)
        for k, radius in enumerate((0.16, 0.34)):
            add_mesh(scene, f"{self.root}/clicked/ring_{k}", meshes.ring(radius, 0.06, 0.09), palette.lit(palette.goal))
        self._bar = add_picture(
            scene,
            f"{self.root}/bar",
            images.colour_bar(palette.ramp),
            *BAR,
            position=(BAR_X, self.front + 1.08, TEXT_Z),
        )
        self._bar_ends = [
            Sign(scene, f"{self.root}/bar_{k}", 0.34 * palette.letters, anchor=a)
            for k, a in enumerate(("left", "right"))
        ]
        self.mark = MapMark(scene, palette, self.root, self.labels)
        self._empty = Sign(scene, f"{self.root}/empty", 0.42 * palette.letters, anchor="centre")
        self._draw_grid()
        self.set_heading("Experience map", "what it built")

    def set_map(self, layer: MapLayer, turn_rad: float) -> bool:
        """Draws nodes and links. True when the whole map has moved on the plate, so that all else on it must follow."""
        self._layer = layer
        before, self.fit = self.fit, refit(self.fit, layer.extent_xy, turn_rad)
        places = meshes.stepped(self.fit.to_plate(layer.xy))
        self._draw(places, layer.links)
        if len(layer.xy):
            self._empty.hide()
        else:
            self._empty.show(images.text(NO_MAP, self.palette.text_2, 64), (0, 0, 0))
        if self.fit.scale != before.scale:
            self._draw_grid()
        if self.fit is not before and self._picture is not None:
            self.set_occupancy(self._picture)
        return self.fit is not before

    def _draw(self, places: NDArray[np.float64], links: NDArray[np.integer]) -> None:
        self._nodes.place(meshes.lifted(places, NODE_Z))
        self._links.show(meshes.lifted(places, LINK_Z), links)

    def show_replay(self, xy: NDArray[np.float64], links: NDArray[np.integer], words: str) -> None:
        """Shows the map as it was once, in place of the present one, until `set_map` and the others are called again."""
        places = meshes.stepped(self.fit.to_plate(xy))
        self._draw(places, links)
        self._arrow.visible = False
        self.set_goal(None)
        self.set_heading("Experience map", words)

    def _draw_grid(self) -> None:
        """Draws a line per metre of the map (per five in large ones), from the middle of the plate."""
        step = self.fit.scale * grid_step_m(self.fit.scale)
        lines: list[list[list[float]]] = []
        for half, reach, flip in ((WIDTH / 2, DEPTH / 2, False), (DEPTH / 2, WIDTH / 2, True)):
            count = int(half / step)
            for at in np.arange(-count, count + 1) * step:
                ends = [[at, -reach, FLOOR_Z + 0.01], [at, reach, FLOOR_Z + 0.01]]
                lines.append([[y, x, z] for x, y, z in ends] if flip else ends)
        self._grid.points = meshes.some(np.array(lines, np.float32), GRID_LINES)

    def set_occupancy(self, picture: OccupancyPicture | None) -> None:
        """Shows below the map what the sonars met; None: nothing."""
        self._picture = picture
        if picture is not None:
            been = np.zeros((0, 2)) if self._layer is None else self._layer.xy
            self._occupancy.image = images.upright(map_floor(picture, self.fit, self.palette, been))
        self._occupancy.visible = picture is not None

    def set_times(self, times: TimesLayer) -> None:
        """Colours the nodes, and sets the numbers of the scale."""
        finite = times.seconds[np.isfinite(times.seconds)]
        longest = round_up(float(finite.max(initial=1.0)))
        self._nodes.paint(self.palette.times(_in_steps(times.seconds, longest), longest))
        ink = self.palette.text_2
        left, right, at = BAR_X - BAR[0] / 2, BAR_X + BAR[0] / 2, self.front + 0.62
        self._bar_ends[0].show(images.text("0 s", ink, 64), (left, at, TEXT_Z))
        self._bar_ends[1].show(images.text(seconds_words(longest), ink, 64), (right, at, TEXT_Z))
        words = "what it built - colour: " + ("time to goal" if times.to_goal else "time from robot")
        mapped = self._layer is None or not len(self._layer.visited_xy)
        self.set_heading("Experience map", words if mapped else "none, as in 2004: the packet's place")

    def set_robot(self, estimate: Pose) -> None:
        self._put(self._arrow, estimate, ARROW_Z)
        x, y, z = self._arrow.position.tolist()
        self.labels.fix(self, [((x, y, z), *ROBOT_SIZE)], ROBOT)

    def set_others(self, others: tuple[Hypothesis, ...]) -> None:
        """Shows the hypotheses beside the pose estimate."""
        places = self.fit.to_plate(np.array([(other.x, other.y) for other in others]).reshape(-1, 2))
        headings = [other.heading_rad + self.fit.turn_rad for other in others]
        self._others.show(places, headings, [other.share for other in others])

    def _put(self, frame: viser.FrameHandle, pose: Pose, z: float) -> None:
        x, y = self.fit.to_plate(np.array([[pose.x, pose.y]]))[0]
        half = (pose.heading_rad + self.fit.turn_rad) / 2
        frame.position = (float(x), float(y), z)
        frame.wxyz = (math.cos(half), 0.0, 0.0, math.sin(half))
        frame.visible = True

    def set_goal(self, goal: Goal | None) -> None:
        if goal is None:
            self._route.hide()
            self._flag.hide()
            return
        at = self.fit.to_plate(np.array([[goal.x, goal.y]]))[0]
        self._flag.show(at, promise(goal), meshes.stepped(self.fit.to_plate(goal.places_xy)))
        self._route.show(self.fit.to_plate(goal.route_xy), goal.route_arrival_s, at)

    def set_trip(self, trip: Trip | None) -> None:
        """Shows where the robot explores, and why, and what else it might have chosen."""
        openings = np.zeros((0, 2), np.float32) if trip is None else trip.openings_xy
        marks = [] if trip is None or trip.beside else [trip]
        at = np.array([(mark.x, mark.y) for mark in marks]).reshape(-1, 2)
        places = meshes.stepped(self.fit.to_plate(openings))
        places = places[(np.abs(places) <= (WIDTH / 2, DEPTH / 2)).all(axis=1)]
        self._openings.place(meshes.lifted(places, NODE_Z))
        self._openings.paint(np.tile(np.array(pale(self.palette, self.palette.goal), np.uint8), (len(places), 1)))
        self._trip.show([mark.reason for mark in marks], meshes.stepped(self.fit.to_plate(at)))

    def set_tags(self, tags: tuple[TaggedPlace, ...]) -> None:
        places = self.fit.to_plate(np.array([(tag.x, tag.y) for tag in tags]).reshape(-1, 2))
        self._tags.show([tag.name for tag in tags], meshes.stepped(places))

    def set_places(self, places: tuple[KnownPlace, ...]) -> None:
        """Shows the names of those places of the office that the map knows, where it has them."""
        known = [(place.name, place.map_xy) for place in places if place.map_xy is not None]
        at = meshes.stepped(self.fit.to_plate(np.array([xy for _, xy in known]).reshape(-1, 2)))
        self.names.show([name for name, _ in known], [True] * len(known), at)

    def set_closures(self, closures: tuple[Closure, ...], layer: MapLayer, snapshot: Snapshot) -> None:
        self.closures.show(closures, self.fit.to_plate(layer.xy), snapshot.time_s)

    def show_click(self, place: tuple[float, float] | None) -> None:
        """Shows the marker of a goal that has been requested (map frame) but is not set yet; None hides it."""
        self._clicked.visible = place is not None
        if place is not None:
            x, y = self.fit.to_plate(np.array([place]))[0]
            self._clicked.position = (float(x), float(y), 0.0)

    def set_inspected(self, report: Report | None) -> None:
        self.mark.show(report, self._layer, self.fit)

    def nearest(self, place: tuple[float, float]) -> int | None:
        return None if self._layer is None else nearest(self._layer, place, self.fit)

    def map_place(self, plate_xy: tuple[float, float]) -> tuple[float, float] | None:
        """The map-frame place under a point of the plate; None beside the floor."""
        if abs(plate_xy[0]) > WIDTH / 2 or abs(plate_xy[1]) > DEPTH / 2:
            return None
        x, y = self.fit.to_map(np.array([plate_xy]))[0]
        return float(x), float(y)


def nearest(layer: MapLayer, place: tuple[float, float], fit: MapFit) -> int | None:
    """The experience nearest to a place of the map, None when none is within half a unit of it on the plate."""
    if not len(layer.xy):
        return None
    away = np.hypot(*(layer.xy - place).T) * fit.scale
    return int(layer.ids[away.argmin()]) if away.min() < NEAR else None


def on_sheet(plate_xy: tuple[float, float]) -> bool:
    """Whether a point is on the plate, floor or not."""
    width, depth, centre_y = SHEET
    return abs(plate_xy[0]) <= width / 2 and abs(plate_xy[1] - centre_y) <= depth / 2


def grid_step_m(scale: float) -> int:
    """Metres between the lines of the grid: fewer in large maps. scale: plate units a metre."""
    return 1 if scale > 0.35 else 5 if scale > 0.08 else 25


def _in_steps(seconds: NDArray[np.float32], longest: float) -> NDArray[np.float32]:
    return np.asarray(np.rint(seconds * (TIME_STEPS / longest)) * (longest / TIME_STEPS), np.float32)


def promise(goal: Goal) -> str:
    """When it will be there, or how it stands with it."""
    status = goal_status(goal)
    words = "? s" if status.short == "goal" else status.short
    why = goal.why if words.startswith("no route") else ""
    return status.seconds or (f"{words}: {why}" if why else words)


def round_up(seconds: float) -> float:
    """Rounded up to 5, 10, 30 or 60 s, so that colours do not change with every new node."""
    step = 5 if seconds < 40 else 10 if seconds < 120 else 30 if seconds < 600 else 60
    return math.ceil(seconds / step) * step
