"""What people alone know, on a sheet: the true walls under the map, the wheels' ghost, error and doubt, closed loops."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import Ghost, Pose, Spread
from web.viewer.fits.judged import error_line, walls_in_map
from web.viewer.fits.map_fit import MapFit
from web.viewer.marks import closures, doubt, ghost
from web.viewer.marks.outline import MOST
from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Palette, mix
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

SHADES = 8  # of a path that fades
FAINT = 0.25
STEP_PX = 5.0
RING = 9.0  # pixels
LEAST_PX = 14.0  # a shorter line would lie beneath the arrow
Points = NDArray[np.float64]


def draw_walls(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    """fit: turns the map as on the sheet."""
    world, frame = subject.judged.walls_of, subject.snapshot.map_in_office
    if world is None or frame is None:
        return []
    palette = subject.palette
    colour = mix(palette.floor, palette.wall, 0.75)
    walls = sheet.within(fit.to_plate(walls_in_map(world, frame).reshape(-1, 2)).reshape(-1, 2, 2))
    lengths = np.hypot(*(walls[:, 1] - walls[:, 0]).T)
    sheet.lines(walls[np.sort(np.argsort(-lengths, kind="stable")[:MOST])], colour, 1.8)
    return [("line", colour, "the true walls, laid under the map")]


def draw_path(sheet: Sheet, palette: Palette, path: Points) -> None:
    """The way that the wheels alone tell, (n, 2): dashed, its older parts faint. What leaves the field is left out."""
    thin = meshes.thinned(path, STEP_PX / sheet.scale) if len(path) > 1 else path
    for k, some in enumerate(np.array_split(np.arange(len(thin)), SHADES)):
        part = thin[some[0] : some[-1] + 2] if len(some) else thin[:0]
        inside = sheet.inside(part)
        for piece in np.split(part, np.flatnonzero(inside[1:] != inside[:-1]) + 1) if len(part) else []:
            if sheet.inside(piece)[0]:
                opacity = FAINT + (1 - FAINT) * (k + 1) / SHADES
                sheet.line(piece, ghost.pale(palette, palette.robot, ghost.PATH_PALE), 2.5, opacity=opacity, dash="8 6")


def draw_ghost(sheet: Sheet, palette: Palette, there: Pose, off_m: float, size: float) -> None:
    """The robot that believes its wheels alone, and its name; beside the field only its name, at the edge. size: pixels."""
    if off_m < ghost.APART_M:
        return
    if sheet.inside([(there.x, there.y)])[0]:
        sheet.arrow(there.x, there.y, there.heading_rad, ghost.pale(palette, palette.robot), size)
        sheet.avoid((there.x, there.y), size)
    fill = ghost.pale(palette, palette.robot, ghost.LABEL_PALE)
    sheet.label((there.x, there.y), ghost.words_of(off_m), palette.sheet, up=-size - 17, fill=fill)


def ghost_entry(shown: Ghost | None, palette: Palette) -> list[Entry]:
    return (
        [] if shown is None else [("dashes", ghost.pale(palette, palette.robot), "as the wheels alone would have it")]
    )


def draw_error(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    """From the estimate to where the robot truly is."""
    truth, frame, palette = subject.judged.truth, subject.snapshot.map_in_office, subject.palette
    if truth is None or frame is None:
        return []
    line, metres = error_line(subject.snapshot.estimate, truth, frame)
    line = fit.to_plate(line)
    if sheet.scale * fit.scale * metres < LEAST_PX:
        return []
    sheet.line(line, palette.true_path, 4)
    sheet.dot(line[1].tolist(), RING, None, palette.true_path)
    sheet.dot(line[1].tolist(), 3.5, palette.true_path)
    sheet.avoid(line[1].tolist(), RING)
    seen = sheet.within(line)
    if (words := doubt.words_of(metres)) and len(seen):  # where the line ends, or leaves the field
        sheet.label(seen[0, 1].tolist(), words, palette.sheet, up=27, fill=palette.true_path)
    return [("line", palette.true_path, "to where it truly is")]


def draw_spread(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    spread: Spread | None = subject.judged.spread
    if spread is None:
        return []
    here, turn = subject.snapshot.estimate, spread.turn_rad + fit.turn_rad
    c, s = math.cos(turn), math.sin(turn)
    axes = np.array([spread.along_m, spread.across_m]) * doubt.SIGMAS * fit.scale
    around = meshes.circle(1.0, corners=48) * axes @ np.array([(c, s), (-s, c)]) + fit.to_plate(
        np.array([[here.x, here.y]])
    )
    sheet.line(np.vstack([around, around[:1]]), subject.palette.robot, 2)
    return [("oval", subject.palette.robot, "[ours] its doubt: two standard deviations")]


def draw_closures(sheet: Sheet, subject: Subject, places: Points) -> list[Entry]:
    """places: (n, 2) of all experiences on the sheet. The newest says what it did."""
    last = [closure for closure in subject.judged.closures[-closures.MOST :] if closure.end < len(places)]
    palette = subject.palette
    colour = palette.packets[3]
    for closure in last:
        at = places[closure.end].tolist()
        sheet.dot(at, RING + 2, None, palette.casing, edge=6.5)
        sheet.dot(at, RING + 2, None, colour, edge=3.5)
        sheet.avoid(at, RING + 4)
    if last and subject.snapshot.time_s - last[-1].time_s <= closures.TOLD_S:
        sheet.label(places[last[-1].end].tolist(), closures.words_of(last[-1]), palette.sheet, up=30, fill=colour)
    return [("ring", colour, "where a loop was closed")] if last else []
