"""The office from above as a vector picture: walls, furniture, doors, people, the robot, its path and what it sees, its ghost."""

from __future__ import annotations

import numpy as np

from web.messages import Snapshot
from web.viewer.fits.judged import wheels_alone, wheels_path
from web.viewer.fits.map_fit import MapFit
from web.viewer.plates.sight import fan_of_view, solids
from web.viewer.primitives.palette import Palette, Rgb, mix
from web.viewer.vector.judged import draw_ghost, draw_path, ghost_entry
from web.viewer.vector.lesson import draw_pins
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

_WIDTHS = {"wall": 6.0, "partition": 4.0, "desk": 2.0, "glass": 2.0}
JUMP_M = 1.2  # a kidnap leaves no line


def draw_office(subject: Subject) -> str:
    snapshot, palette = subject.snapshot, subject.palette
    world, truth = snapshot.world, snapshot.truth
    if world is None:
        raise ValueError("a recording without a true path has no office to be drawn")
    x1, y1, x2, y2 = world.bounds
    told = (
        "the true world - the robot cannot know this" if world.is_office else "the true path, as the recording has it"
    )
    sheet = Sheet(palette, world.title, told, (x1 - 0.1, y1 - 0.1, x2 + 0.1, y2 + 0.1))
    for zone in world.slow_zones:
        sheet.polygon(zone, palette.packets[0], opacity=0.22)
    for outline in solids(world):
        sheet.polygon(outline, palette.desk)
    _draw_view(sheet, snapshot)
    kinds = np.array(world.wall_kind)
    for kind in dict.fromkeys(world.wall_kind):
        segments = world.walls[kinds == kind].reshape(-1, 2, 2)
        sheet.lines(
            segments, _wall_colour(kind, palette), max(1.5, _WIDTHS.get(kind, 4.0) * min(1.0, sheet.scale / 80))
        )
    for (ax, ay, bx, by, *_), rgb in zip(world.panels.tolist(), world.panel_rgb.tolist(), strict=True):
        sheet.lines([[(ax, ay), (bx, by)]], tuple(rgb), max(1.0, 3 * min(1.0, sheet.scale / 80)))
    _draw_living(sheet, snapshot, palette)
    for part in _unbroken(np.asarray(snapshot.trail, np.float64), JUMP_M if world.is_office else np.inf):
        sheet.line(part, palette.true_path, 2.5, opacity=0.8)
    size = max(9.0, 1.2 * world.robot_radius_m * sheet.scale)
    legend: list[Entry] = [("line", palette.true_path, "where it drove in the last two minutes")]
    if truth is not None:
        sheet.avoid((truth.x, truth.y), size)
    known = {place.name for place in snapshot.places if place.map_xy is not None}
    for name, x, y in world.places:
        sheet.label((x, y), name, palette.text if name in known else mix(palette.floor, palette.text, 0.75))
    draw_pins(sheet, subject, "office", MapFit(1.0))
    ghost = subject.judged.ghost
    if ghost is not None and truth is not None:
        draw_path(sheet, palette, wheels_path(ghost)[0])
        in_office, _, off_m = wheels_alone(ghost, truth)
        draw_ghost(sheet, palette, in_office, off_m, size)
    if truth is not None:
        sheet.arrow(truth.x, truth.y, truth.heading_rad, palette.robot, size)
        if world.is_office:
            legend.append(("area", mix(palette.floor, palette.wedge, palette.wedge_opacity), "what its camera sees"))
    sheet.foot(subject.moment, f"{x2 - x1:.1f} x {y2 - y1:.1f} m")
    sheet.legend(legend + ghost_entry(ghost, palette))
    return sheet.svg()


def _draw_view(sheet: Sheet, snapshot: Snapshot) -> None:
    world, truth, palette = snapshot.world, snapshot.truth, sheet.palette
    if world is None or truth is None or not world.is_office:
        return
    leaves = np.zeros((0, 4)) if snapshot.living is None else snapshot.living.doors.astype(np.float64)
    opaque = np.array([kind != "glass" for kind in world.wall_kind], bool)
    walls = np.vstack([np.asarray(world.walls, np.float64)[opaque], leaves])
    rim = fan_of_view(walls, truth, world.camera_fov_rad)
    sheet.polygon(np.vstack([[(truth.x, truth.y)], rim]), palette.wedge, opacity=palette.wedge_opacity)


def _draw_living(sheet: Sheet, snapshot: Snapshot, palette: Palette) -> None:
    layer = snapshot.living
    if layer is None:
        return
    sheet.lines(layer.doors.reshape(-1, 2, 2), palette.packets[0], 5.0)
    for (x, y, width, depth, _, angle), rgb in zip(layer.boxes.tolist(), layer.box_rgb.tolist(), strict=True):
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, depth / 2)
        c, s = np.cos(angle), np.sin(angle)
        sheet.polygon(corners @ np.array([(c, s), (-s, c)]) + (x, y), tuple(rgb))
    for (x, y, _, radius, _), rgb in zip(layer.people.tolist(), layer.people_rgb.tolist(), strict=True):
        sheet.dot((x, y), radius * sheet.scale, tuple(rgb), palette.text)


def _wall_colour(kind: str, palette: Palette) -> Rgb:
    return {"partition": palette.partition, "desk": palette.desk, "glass": palette.glass}.get(kind, palette.wall)


def _unbroken(path: np.ndarray, jump: float) -> list[np.ndarray]:
    """The parts of a path between jumps."""
    if len(path) < 2:
        return []
    return np.split(path, np.flatnonzero(np.hypot(*np.diff(path, axis=0).T) > jump) + 1)
