"""The office from above as a vector picture: walls, furniture, what lives in it, the robot, its path and senses, its ghost."""

from __future__ import annotations

import math

import numpy as np

from web.messages import WorldDrawing
from web.viewer.fits.judged import wheels_alone, wheels_path
from web.viewer.fits.map_fit import MapFit
from web.viewer.fits.office_fit import DEPTH, WIDTH, OfficeFit
from web.viewer.marks.place_names import MOST
from web.viewer.plates.office_plate import OFFICE, TRUE_PATH
from web.viewer.plates.sight import solid_runs
from web.viewer.primitives.palette import Palette, Rgb, mix
from web.viewer.vector.judged import draw_ghost, draw_path, ghost_entry
from web.viewer.vector.living import draw_light, draw_living
from web.viewer.vector.names import draw_name, draw_pins
from web.viewer.vector.senses import draw_movements, draw_sonar, draw_view
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

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
    sheet = Sheet(
        palette, world.title, told, _field(world, np.zeros((0, 2)) if ghost is None else wheels_path(ghost)[0])
    )
    size = max(9.0, 1.2 * world.robot_radius_m * sheet.scale)
    _draw_floor(sheet, world)
    draw_light(sheet, snapshot.living, world.bounds)
    for rows, outline in solid_runs(world):
        kind = world.wall_kind[rows[0]]
        if kind != "glass":
            sheet.polygon(outline, palette.desk if kind == "desk" else palette.partition)
    seen = draw_view(sheet, subject)
    _draw_walls(sheet, world)
    draw_living(sheet, snapshot.living)
    for part in _unbroken(np.asarray(snapshot.trail, np.float64), JUMP_M if world.is_office else np.inf):
        sheet.line(part, palette.true_path, 2.5, opacity=0.8)
    legend: list[Entry] = [("line", palette.true_path, "where it drove in the last two minutes"), *seen]
    if world.slow_zones:
        legend.append(("area", mix(palette.floor, palette.packets[0], SLOW), "floor on which it is slow"))
    legend += draw_movements(sheet, subject, size)
    legend += draw_sonar(sheet, subject)
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


def _unbroken(path: np.ndarray, jump: float) -> list[np.ndarray]:
    """The parts of a path between jumps."""
    if len(path) < 2:
        return []
    return np.split(path, np.flatnonzero(np.hypot(*np.diff(path, axis=0).T) > jump) + 1)
