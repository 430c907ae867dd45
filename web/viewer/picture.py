"""A picture of the stage as SVG, from a snapshot: what stands on the page until the viewer has drawn its first frame.

The plates are seen from the very camera of the view, so that the viewer's own picture takes its place without a jump. Office, map
and packets are drawn as lines and dots, what lies on the floors as areas; colours come from the page, which knows its theme.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection

import numpy as np
from numpy.typing import NDArray

from web.messages import ExperienceReport, Inspect, Pose, SetGoal, Snapshot
from web.switches import Name
from web.viewer.camera_views import SHEET, At, Camera, View, camera_for, ray_through, seen_by, stands
from web.viewer.fits import DEPTH, HEIGHT, SIDE, WIDTH, CellFit, MapFit, OfficeFit, Overlaid, overlaid, refit
from web.viewer.marks.inspected import links_of, spots_of
from web.viewer.marks.robot import ENLARGED, SMALLEST
from web.viewer.plates.map_plate import NODE_Z, nearest, on_sheet
from web.viewer.plates.plate import CORNER, point_on_plane
from web.viewer.pointer import BESIDE_MAP, NOTHING_THERE, OTHER_BRAIN
from web.viewer.primitives import meshes
from web.viewer.primitives.palette import BRAINS, Palette, Rgb, mix
from web.viewer.vector.subject import snapshot_of_second

Points = NDArray[np.float64]
UNITS = 1000.0  # of the picture's height
WALL_HIGH, MOST_WALLS, MOST_DOTS = 0.6, 1200, 900
SURE = 0.15  # how far from one half a probability is shown
TIMES = 12  # shades of the goal memory
Shades = tuple[NDArray[np.int64], list[Rgb]]  # (n_y, n_x) which of the colours each cell has, -1: none


def picture(snapshot: Snapshot, view: View, aspect: float, palette: Palette, on: Collection[Name]) -> str:
    """The stage as it is now; aspect: width over height of the canvas; on: the switches that are on."""
    office, beside = snapshot.world is not None, snapshot.beside
    at = stands(office=office, two=beside is not None)
    brains = [(snapshot, overlaid(snapshot, on))]
    if beside is not None:
        second = snapshot_of_second(snapshot, beside)
        brains.append((second, overlaid(second, ())))
    sketch = _Sketch(camera_for(view, aspect, office, beside is not None), palette)
    for k, (cells_at, map_at) in enumerate(zip(at.cells, at.maps, strict=True)):
        rim = palette.rim if beside is None else BRAINS[palette.dark][k]
        sketch.sheet(cells_at, rim)
        sketch.sheet(map_at, rim)
    if office:
        sketch.sheet(at.office, palette.rim)
    for (seen, laid), where in zip(brains, at.cells, strict=True):
        _cells(sketch, seen, laid, where)
    if office:
        _office(sketch, snapshot, at.office)
    for (seen, laid), where in zip(brains, at.maps, strict=True):
        _map(sketch, seen, where, laid)
    return sketch.text(aspect)


def meant(
    snapshot: Snapshot, view: View, aspect: float, at: tuple[float, float], inspecting: bool
) -> SetGoal | Inspect | str:
    """What a click on this picture asks for, or why it asks for nothing. at: as in `ray_through`."""
    office, two = snapshot.world is not None, snapshot.beside is not None
    origin, direction = ray_through(camera_for(view, aspect, office, two), at)
    ray = np.array(origin), np.array(direction)
    plates = [point_on_plane(*ray, (*where, 0.0), NODE_Z) for where in stands(office=office, two=two).maps]
    if two and plates[1] is not None and on_sheet(plates[1]):
        return OTHER_BRAIN
    if plates[0] is None or not on_sheet(plates[0]):
        return NOTHING_THERE
    if abs(plates[0][0]) > WIDTH / 2 or abs(plates[0][1]) > DEPTH / 2:
        return BESIDE_MAP
    fit = refit(MapFit(), snapshot.map.extent_xy, snapshot.map_turn_rad)
    x, y = fit.to_map(np.array([plates[0]]))[0].tolist()
    if not inspecting:
        return SetGoal(type="set_goal", x=x, y=y)
    return Inspect(type="inspect", experience=nearest(snapshot.map, (x, y), fit))


class _Sketch:
    def __init__(self, camera: Camera, palette: Palette) -> None:
        self.camera, self.palette = camera, palette
        self._parts: list[str] = []
        half = float(np.linalg.norm(camera.look_at - camera.position)) * math.tan(camera.fov_rad / 2)
        self._zoom = UNITS / 2 / half

    def sheet(self, at: At, rim: Rgb) -> None:
        width, depth, centre_y = SHEET
        outline = meshes.rounded_rectangle(width, depth, CORNER, centre=(0.0, centre_y)) + at
        self.area(meshes.lifted(outline, -0.055), self.palette.sheet, rim)

    def area(self, points: Points, fill: tuple[int, int, int], rim: tuple[int, int, int] | None = None) -> None:
        line = "" if rim is None else f' stroke="{_hex(rim)}" stroke-width="1.5"'
        self._parts.append(f'<path fill="{_hex(fill)}"{line} d="{self._way(points)}Z"/>')

    def areas(self, quads: Points, fill: tuple[int, int, int], rim: tuple[int, int, int]) -> None:
        """(n, k, 3) of one colour, the farthest first."""
        if len(quads):
            order = np.argsort(-quads[:, :, 1].mean(1), kind="stable")
            way = "".join(f"{self._way(quad)}Z" for quad in quads[order])
            self._parts.append(f'<path fill="{_hex(fill)}" stroke="{_hex(rim)}" stroke-width=".6" d="{way}"/>')

    def lines(self, segments: Points, colour: tuple[int, int, int], width: float) -> None:
        """(n, 2, 3)"""
        if len(segments):
            way = "".join(self._way(segment) for segment in segments)
            self._parts.append(f'<path fill="none" stroke="{_hex(colour)}" stroke-width="{width}" d="{way}"/>')

    def dots(self, points: Points, colours: NDArray[np.uint8], radius: float) -> None:
        """(n, 3) with (n, 3) colours; radius: in the scene."""
        if not len(points):
            return
        seen, larger = seen_by(self.camera, points)
        for (x, y), size, colour in zip(self._placed(seen), larger, colours.tolist(), strict=True):
            r = max(radius * float(size) * self._zoom, 1.0)
            self._parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:.1f}" fill="{_hex(tuple(colour))}"/>')

    def text(self, aspect: float) -> str:
        box = f"{-UNITS * aspect / 2:.0f} {-UNITS / 2:.0f} {UNITS * aspect:.0f} {UNITS:.0f}"
        return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">{"".join(self._parts)}</svg>'

    def _way(self, points: Points) -> str:
        placed = self._placed(seen_by(self.camera, points)[0])
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in placed)

    def _placed(self, seen: Points) -> list[list[float]]:
        return (seen * (self._zoom, -self._zoom)).tolist()


def _office(sketch: _Sketch, snapshot: Snapshot, at: At) -> None:
    world, palette = snapshot.world, sketch.palette
    assert world is not None
    fit = OfficeFit(world.bounds)
    half = np.array(fit.size_m) * fit.scale / 2
    floor = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half + at
    sketch.area(meshes.lifted(floor, -0.03), palette.floor)
    walls = np.asarray(world.walls, np.float64)
    lengths = np.hypot(*(walls[:, 2:] - walls[:, :2]).T)
    walls = walls[np.argsort(-lengths, kind="stable")[:MOST_WALLS]]
    ends = fit.to_plate(walls.reshape(-1, 2)).reshape(-1, 2, 2) + at
    low = np.concatenate([ends, np.zeros((len(ends), 2, 1))], 2)
    high = low[:, ::-1] + (0.0, 0.0, WALL_HIGH * fit.relief)
    sketch.areas(np.concatenate([low, high], 1), palette.wall, palette.floor)
    truth = snapshot.truth
    if truth is not None:
        middle = meshes.lifted(fit.to_plate(np.array([[truth.x, truth.y]])) + at, 0.2)
        radius = max(ENLARGED * fit.scale * world.robot_radius_m, SMALLEST)
        sketch.dots(middle, np.array([palette.robot], np.uint8), radius)


def _map(sketch: _Sketch, snapshot: Snapshot, at: At, laid: Overlaid) -> None:
    palette, layer = sketch.palette, snapshot.map
    floor = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (WIDTH / 2, DEPTH / 2) + at
    sketch.area(meshes.lifted(floor, -0.03), palette.floor)
    if not len(layer.xy):
        return
    fit = refit(MapFit(), layer.extent_xy, snapshot.map_turn_rad)
    places = meshes.lifted(fit.to_plate(layer.xy) + at, 0.05)
    if laid.occupancy is not None:
        met = laid.occupancy.draw_map()
        low = np.array(met.origin_xy_m) - met.cell_m / 2
        _floor(sketch, _met(met.probability, palette), lambda xy: _on_floor(fit.to_plate(xy * met.cell_m + low)) + at)
    every = -(-len(places) // MOST_DOTS)
    sketch.lines(places[layer.links][: 2 * MOST_DOTS], palette.link, 1.0)
    seconds = snapshot.times.seconds[: len(places)]
    longest = float(seconds[np.isfinite(seconds)].max(initial=1.0))
    colours = np.zeros((len(places), 3), np.uint8)
    colours[: len(seconds)] = palette.times(seconds, longest)
    sketch.dots(places[::every], colours[::every], 0.04)
    if snapshot.goal is not None:
        route = meshes.lifted(fit.to_plate(snapshot.goal.route_xy) + at, 0.16)
        sketch.lines(np.stack([route[:-1], route[1:]], 1), palette.route, 4.0)
        flag = meshes.lifted(fit.to_plate(np.array([[snapshot.goal.x, snapshot.goal.y]])) + at, 0.2)
        sketch.dots(flag, np.array([palette.goal], np.uint8), 0.3)
    _inspected(sketch, laid, places)
    sketch.area(_arrow(snapshot.estimate, fit, at), palette.robot)


def _on_floor(places: Points) -> Points:
    """(n, 2) on the map's plate, none beside its floor."""
    return np.clip(places, (-WIDTH / 2, -DEPTH / 2), (WIDTH / 2, DEPTH / 2))


def _arrow(pose: Pose, fit: MapFit, at: At) -> Points:
    turn = pose.heading_rad + fit.turn_rad
    c, s = math.cos(turn), math.sin(turn)
    shape = np.array([(0.5, 0.0), (-0.4, 0.3), (-0.2, 0.0), (-0.4, -0.3)]) @ np.array([[c, s], [-s, c]])
    return meshes.lifted(shape + fit.to_plate(np.array([[pose.x, pose.y]])) + at, 0.22)


def _inspected(sketch: _Sketch, laid: Overlaid, places: Points) -> None:
    """Rings, and the links of an experience. places: (n, 3) of all."""
    report, ink = laid.inspected, sketch.palette.text
    if report is None:
        return
    if isinstance(report, ExperienceReport):
        sketch.lines(places[links_of(report, len(places))], ink, 2.5)
        rows = [report.id] if report.id < len(places) else []
    else:
        rows = spots_of(report, len(places))
    for place in places[rows]:
        sketch.lines(meshes.closed_line(meshes.circle(0.26, place[:2].tolist()), 0.1).astype(np.float64), ink, 2.5)


def _floor(sketch: _Sketch, shades: Shades, placed: Callable[[Points], Points]) -> None:
    """Areas, cell by cell, but those of one shade beside one another at once. placed: from cells to the floor."""
    shade, colours = shades
    for k, colour in enumerate(colours):
        runs: list[Points] = []
        for y, row in enumerate(shade == k):
            edges = np.flatnonzero(np.diff(np.concatenate([[0], row, [0]]).astype(np.int8))).reshape(-1, 2)
            runs += [np.array([(a, y), (b, y), (b, y + 1), (a, y + 1)], np.float64) for a, b in edges.tolist()]
        if runs:
            quads = placed(np.concatenate(runs))
            sketch.areas(meshes.lifted(quads, -0.02).reshape(-1, 4, 3), colour, colour)


def _met(probability: NDArray[np.float32], palette: Palette) -> Shades:
    """Where the sonars found the floor free, and where they met something."""
    sure = np.digitize(probability, (0.5 - SURE, 0.5 + SURE))
    return np.where(sure == 1, -1, sure // 2), [
        mix(palette.floor, colour, 0.9) for colour in (palette.free, palette.occupied)
    ]


def _cells(sketch: _Sketch, snapshot: Snapshot, laid: Overlaid, at: At) -> None:
    palette, layer = sketch.palette, snapshot.pose_cells
    fit, stands = CellFit(layer.shape), np.array((*at, 0.0))
    foot = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (SIDE / 2)
    sketch.area(meshes.lifted(foot, -0.03) + stands, palette.floor)
    size = np.array(layer.shape[:0:-1]) / SIDE
    if laid.beneath is not None:
        _floor(sketch, _met(laid.beneath.cells, palette), lambda xy: xy / size - SIDE / 2 + at)
    if laid.goal_memory is not None and laid.goal_memory.seconds is not None:
        _floor(sketch, _timed(laid.goal_memory.seconds, palette), lambda xy: xy / size - SIDE / 2 + at)
    low, high = meshes.lifted(foot, 0.0) + stands, meshes.lifted(foot, HEIGHT) + stands
    edges = np.concatenate([meshes.closed_line(foot, z).astype(np.float64) for z in (0.0, HEIGHT)]) + stands
    sketch.lines(np.concatenate([edges, np.stack([low, high], 1)]), palette.glass_edge, 1.5)
    packets = layer.packets[: len(palette.packets)]
    for packet, colour in zip(packets, palette.packets, strict=False):
        sketch.dots(fit.packet(packet)[None] + stands, np.array([colour], np.uint8), 0.3)


def _timed(seconds: NDArray[np.float32], palette: Palette) -> Shades:
    """The goal memory's times in steps, bright near the goal."""
    known = np.isfinite(seconds)
    share = np.where(known, seconds, 0.0) / max(float(seconds[known].max(initial=0.0)), 1e-6)
    colours = palette.times(np.linspace(0, 1, TIMES, dtype=np.float32), 1.0)
    shade = np.where(known, np.rint(share * (TIMES - 1)).astype(np.int64), -1)
    return shade, [mix(palette.floor, tuple(colour), 0.85) for colour in colours.tolist()]


def _hex(colour: tuple[int, ...]) -> str:
    return "#" + "".join(f"{part:02x}" for part in colour)
