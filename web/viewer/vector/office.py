"""The office from above as a vector picture: walls, furniture, what lives in it, and the robot with its path, what it senses and
tries, and its ghost.
"""

from __future__ import annotations

import math

import numpy as np

from web.messages import LivingLayer, WorldDrawing
from web.viewer.fits import DEPTH, WIDTH, MapFit, OfficeFit, wheels_alone, wheels_path
from web.viewer.marks import movements
from web.viewer.marks.actors import DARKEST, DOOR_RGB, LIT, NIGHT, POOL, SHINE, unlit
from web.viewer.marks.names import MOST
from web.viewer.plates.office_plate import OFFICE, TRUE_PATH
from web.viewer.plates.sight import echoes_at, fan_of_view, solid_runs
from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Palette, Rgb, mix
from web.viewer.vector.layers import draw_ghost, draw_name, draw_path, draw_pins, ghost_entry
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

LAMP, LEAST = 6.0, 5.0  # pixels
NOSE = 0.45  # share of a person's radius
ECHO = 4.0  # pixels
_WIDTHS = {"wall": 6.0, "partition": 4.0, "desk": 2.0, "glass": 2.0}
JUMP_M = 1.2  # a kidnap leaves no line
LEAST_ROOM_M, ROOM = 0.1, 0.014  # around the walls, the latter as a share of the office: for a robot at its edge
SLOW = 0.22


def draw_office(subject: Subject) -> str:
    snapshot, palette = subject.snapshot, subject.palette
    world, truth = snapshot.world, snapshot.truth
    if world is None:
        raise ValueError("a recording without a true path has no office to be drawn")
    ghost = subject.judged.ghost
    _, told = OFFICE if world.is_office else TRUE_PATH
    field = _field(world, np.zeros((0, 2)) if ghost is None else wheels_path(ghost)[0])
    sheet = Sheet(palette, world.title, told, field)
    size = max(9.0, 1.2 * world.robot_radius_m * sheet.scale)
    _draw_floor(sheet, world)
    _draw_light(sheet, snapshot.living, world.bounds)
    for rows, outline in solid_runs(world):
        kind = world.wall_kind[rows[0]]
        if kind != "glass":
            sheet.polygon(outline, palette.desk if kind == "desk" else palette.partition)
    seen = _draw_view(sheet, subject)
    _draw_walls(sheet, world)
    _draw_living(sheet, snapshot.living)
    for part in _unbroken(np.asarray(snapshot.trail, np.float64), JUMP_M if world.is_office else np.inf):
        sheet.line(part, palette.true_path, 2.5, opacity=0.8)
    legend: list[Entry] = [("line", palette.true_path, "where it drove in the last two minutes"), *seen]
    if world.slow_zones:
        legend.append(("area", mix(palette.floor, palette.packets[0], SLOW), "floor on which it is slow"))
    legend += _draw_movements(sheet, subject, size)
    legend += _draw_sonar(sheet, subject)
    if truth is not None:
        sheet.avoid((truth.x, truth.y), size)
    for place in snapshot.places[:MOST]:
        draw_name(sheet, (place.x, place.y), place.name, known=place.map_xy is not None)
    draw_pins(sheet, subject, "office", MapFit(1.0))
    if ghost is not None and truth is not None:
        draw_path(sheet, palette, wheels_path(ghost)[0])
        in_office, _, off_m = wheels_alone(ghost, truth)
        draw_ghost(sheet, palette, in_office, off_m, size)
    if truth is not None:
        sheet.arrow(truth.x, truth.y, truth.heading_rad, palette.robot, size)
    wide, deep = OfficeFit(world.bounds).size_m
    sheet.foot(subject.moment, f"{wide:.1f} x {deep:.1f} m")
    sheet.legend(legend + ghost_entry(ghost, palette))
    return sheet.svg()


def _field(world: WorldDrawing, path: np.ndarray) -> tuple[float, float, float, float]:
    """The office with room around it, and what of the ghost's path (n, 2) is on the plate's floor beside it."""
    fit = OfficeFit(world.bounds)
    seen = path[np.all(np.abs(fit.to_plate(path)) <= (WIDTH / 2, DEPTH / 2), axis=1)]
    both = np.vstack([np.reshape(world.bounds, (2, 2)), seen])
    room = max(LEAST_ROOM_M, ROOM * max(fit.size_m))
    return (*(both.min(0) - room).tolist(), *(both.max(0) + room).tolist())


def _draw_floor(sheet: Sheet, world: WorldDrawing) -> None:
    """Its grid, from its lower left corner, and where it is slippery."""
    x1, y1, x2, y2 = world.bounds
    step = OfficeFit(world.bounds).grid_step_m
    lines = [[(x1 + k * step, y1), (x1 + k * step, y2)] for k in range(1, math.ceil((x2 - x1) / step))]
    lines += [[(x1, y1 + k * step), (x2, y1 + k * step)] for k in range(1, math.ceil((y2 - y1) / step))]
    sheet.lines(lines, sheet.palette.grid, 1.2)
    for zone in world.slow_zones:
        sheet.polygon(zone, sheet.palette.packets[0], opacity=SLOW)


def _draw_light(sheet: Sheet, layer: LivingLayer | None, bounds: tuple[float, float, float, float]) -> None:
    """On the floor: the less daylight, the darker, but not below the lamps that shine."""
    if layer is None:
        return
    x1, y1, x2, y2 = bounds
    dark = DARKEST * (1.0 - min(max(layer.daylight, 0.0), 1.0))
    pools = [meshes.circle(POOL * reach, (x, y)) for x, y, reach, on in layer.lamps.tolist() if on]
    if dark > 0:
        sheet.polygon([(x1, y1), (x2, y1), (x2, y2), (x1, y2)], NIGHT, opacity=dark, holes=pools)
    for pool in pools:
        sheet.polygon(pool, LIT, opacity=SHINE)


def _draw_view(sheet: Sheet, subject: Subject) -> list[Entry]:
    world, truth = subject.snapshot.world, subject.snapshot.truth
    living, palette = subject.snapshot.living, subject.palette
    if world is None or truth is None or not world.is_office:
        return []
    leaves = np.zeros((0, 4)) if living is None else living.doors.astype(np.float64)
    opaque = np.array([kind != "glass" for kind in world.wall_kind], bool)
    walls = np.vstack([np.asarray(world.walls, np.float64)[opaque], leaves])
    rim = fan_of_view(walls, truth, world.camera_fov_rad)
    sheet.polygon(np.vstack([[(truth.x, truth.y)], rim]), palette.wedge, opacity=palette.wedge_opacity)
    sheet.line([rim[0], (truth.x, truth.y), rim[-1]], palette.wedge, 1.5)
    return [("area", mix(palette.floor, palette.wedge, palette.wedge_opacity), "what its camera sees")]


def _draw_walls(sheet: Sheet, world: WorldDrawing) -> None:
    kinds = np.array(world.wall_kind)
    for kind in dict.fromkeys(world.wall_kind):
        segments = world.walls[kinds == kind].reshape(-1, 2, 2)
        wide = max(1.5, _WIDTHS.get(kind, 4.0) * min(1.0, sheet.scale / 80))
        sheet.lines(segments, _wall_colour(kind, sheet.palette), wide)
    for (ax, ay, bx, by, *_), rgb in zip(world.panels.tolist(), world.panel_rgb.tolist(), strict=True):
        sheet.lines([[(ax, ay), (bx, by)]], tuple(rgb), max(1.0, 3 * min(1.0, sheet.scale / 80)))


def _wall_colour(kind: str, palette: Palette) -> Rgb:
    return {"partition": palette.partition, "desk": palette.desk, "glass": palette.glass}.get(kind, palette.wall)


def _draw_living(sheet: Sheet, layer: LivingLayer | None) -> None:
    if layer is None:
        return
    sheet.lines(layer.doors.reshape(-1, 2, 2), DOOR_RGB, 5.0)
    for (x, y, width, depth, _, angle), rgb in zip(layer.boxes.tolist(), layer.box_rgb.tolist(), strict=True):
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, depth / 2)
        c, s = np.cos(angle), np.sin(angle)
        sheet.polygon(corners @ np.array([(c, s), (-s, c)]) + (x, y), tuple(rgb))
    for (x, y, heading, radius, _), rgb in zip(layer.people.tolist(), layer.people_rgb.tolist(), strict=True):
        size = max(radius * sheet.scale, LEAST)
        sheet.dot((x, y), size, tuple(rgb), sheet.palette.text, edge=1.5)
        ahead = size / sheet.scale * np.array([np.cos(heading), np.sin(heading)])
        sheet.dot((np.array([x, y]) + ahead).tolist(), NOSE * size, tuple(rgb), sheet.palette.text, edge=1.5)
    for x, y, _, on in layer.lamps.tolist():
        sheet.dot((x, y), LAMP, LIT if on else unlit(sheet.palette), sheet.palette.rim, edge=1.5)


def _unbroken(path: np.ndarray, jump: float) -> list[np.ndarray]:
    """The parts of a path between jumps."""
    if len(path) < 2:
        return []
    return np.split(path, np.flatnonzero(np.hypot(*np.diff(path, axis=0).T) > jump) + 1)


def _draw_movements(sheet: Sheet, subject: Subject, size: float) -> list[Entry]:
    """size: of the robot, pixels."""
    if subject.overlaid.movements is None:
        return []
    tried, palette = subject.overlaid.movements(), subject.palette
    bright, grey = movements.shades(palette)
    ways = [movements.arc_on_plate(tried, k, MapFit(1.0), size / sheet.scale) for k in range(len(tried.free))]
    for k in movements.drawn_along(tried):
        free = bool(tried.free[k])
        sheet.line(ways[k], bright if free else grey, 1.2, dash="" if free else "4 3")
    for way, free in zip(ways, tried.free.tolist(), strict=True):
        sheet.dot(way[-1].tolist(), 1.8, bright if free else grey)
    sheet.way(ways[tried.chosen], palette.robot, 4.5)
    return [("line", bright, "movements it tries; dashed: an echo is too close; bold: it goes")]


def _draw_sonar(sheet: Sheet, subject: Subject) -> list[Entry]:
    world, truth, ranges_m = subject.snapshot.world, subject.snapshot.truth, subject.snapshot.senses.ranges_m
    if world is None or truth is None or not world.is_office:
        return []
    echoes = echoes_at(truth, world.sonar_angles_rad, ranges_m)
    sheet.lines([[(truth.x, truth.y), echo] for echo in echoes], subject.palette.sonar, 1.5)
    for echo in echoes.tolist():
        sheet.dot(echo, ECHO, subject.palette.sonar)
    return [("line", subject.palette.sonar, "its sonars' echoes")] if len(echoes) else []
