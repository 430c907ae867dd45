"""What the robot senses and tries in the office, on a sheet: its camera's view, its sonars' echoes, its candidate movements."""

from __future__ import annotations

import numpy as np

from web.viewer.fits.map_fit import MapFit
from web.viewer.marks import movements
from web.viewer.plates.sight import fan_of_view
from web.viewer.primitives.palette import mix
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

ECHO = 4.0  # pixels


def draw_view(sheet: Sheet, subject: Subject) -> list[Entry]:
    world, truth, living, palette = (
        subject.snapshot.world,
        subject.snapshot.truth,
        subject.snapshot.living,
        subject.palette,
    )
    if world is None or truth is None or not world.is_office:
        return []
    leaves = np.zeros((0, 4)) if living is None else living.doors.astype(np.float64)
    opaque = np.array([kind != "glass" for kind in world.wall_kind], bool)
    walls = np.vstack([np.asarray(world.walls, np.float64)[opaque], leaves])
    rim = fan_of_view(walls, truth, world.camera_fov_rad)
    sheet.polygon(np.vstack([[(truth.x, truth.y)], rim]), palette.wedge, opacity=palette.wedge_opacity)
    sheet.line([rim[0], (truth.x, truth.y), rim[-1]], palette.wedge, 1.5)
    return [("area", mix(palette.floor, palette.wedge, palette.wedge_opacity), "what its camera sees")]


def draw_sonar(sheet: Sheet, subject: Subject) -> list[Entry]:
    world, truth, ranges_m = subject.snapshot.world, subject.snapshot.truth, subject.snapshot.senses.ranges_m
    if world is None or truth is None or not world.is_office:
        return []
    heard = np.isfinite(ranges_m)
    angles, reach = truth.heading_rad + world.sonar_angles_rad[heard], ranges_m[heard]
    echoes = np.column_stack([truth.x + reach * np.cos(angles), truth.y + reach * np.sin(angles)])
    sheet.lines([[(truth.x, truth.y), echo] for echo in echoes], subject.palette.sonar, 1.5)
    for echo in echoes.tolist():
        sheet.dot(echo, ECHO, subject.palette.sonar)
    return [("line", subject.palette.sonar, "its sonars' echoes")] if len(echoes) else []


def draw_movements(sheet: Sheet, subject: Subject, size: float) -> list[Entry]:
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
