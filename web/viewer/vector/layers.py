"""What lies over the plates, on a sheet: where the sonars met something, the goal memory's times, what people alone know, what is
inspected, names of places, and what a lesson has there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import shorten
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from web.messages import CellReport, ExperienceReport, Ghost, Pose, Spread, ViewReport, WhyReport
from web.messages.robot_status import seconds_words
from web.viewer.fits import CellFit, MapFit, error_line, walls_in_map
from web.viewer.marks import cell_marks, graph, robot
from web.viewer.marks.inspected import linked_cells, links_of, spots_of
from web.viewer.marks.judged import MOST, SIGMAS, words_of
from web.viewer.marks.names import last_named
from web.viewer.plates import overlays
from web.viewer.plates.lesson_marks import pins
from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Palette, mix
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

Points = NDArray[np.float64]


def draw_occupancy(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    """Below the map, bent and turned with it."""
    layer, palette = subject.overlaid.occupancy, subject.palette
    if layer is None:
        return []
    picture = layer.draw_map()
    n_y, n_x = picture.probability.shape
    low = np.array(picture.origin_xy_m) - picture.cell_m / 2
    corners = low + np.array([(0, n_y), (n_x, n_y), (0, 0)]) * picture.cell_m
    colours = overlays.occupancy_colours(picture.probability, _floor(n_y, n_x, palette), palette)
    sheet.image(np.ascontiguousarray(colours[::-1]), fit.to_plate(corners))
    return _met(palette)


def draw_beneath(sheet: Sheet, subject: Subject) -> list[Entry]:
    """Below the pose cells, a pixel a cell: the occupancy in their frame, and over it the times to the goal with their scale."""
    beneath, goal, palette = subject.overlaid.beneath, subject.overlaid.goal_memory, subject.palette
    _, n_y, n_x = subject.snapshot.pose_cells.shape
    bare = colours = _floor(n_y, n_x, palette)
    legend: list[Entry] = []
    if beneath is not None:
        colours = overlays.cells_occupied(colours, beneath.cells, palette)
        legend += _met(palette)
    if goal is not None and goal.seconds is not None:
        colours = overlays.cells_timed(colours, goal.seconds, palette)
        longest = float(goal.seconds[np.isfinite(goal.seconds)].max(initial=0.0))
        sheet.scale_bar(palette.ramp, "0 s", f"{seconds_words(longest)} to the goal")
    if colours is not bare:
        known = 255 * (colours != bare).any(2, keepdims=True).astype(np.uint8)  # elsewhere the grid is seen
        x1, y1, x2, y2 = sheet.box
        sheet.image(np.concatenate([colours, known], 2), [(x1, y2), (x2, y2), (x1, y1)])
    return legend


def _floor(n_y: int, n_x: int, palette: Palette) -> np.ndarray:
    return np.broadcast_to(np.array(palette.floor, np.uint8), (n_y, n_x, 3))


def _met(palette: Palette) -> list[Entry]:
    free, occupied = (mix(palette.floor, colour, 0.9) for colour in (palette.free, palette.occupied))
    return [("area", free, "free, as its sonars found it"), ("area", occupied, "where they met something")]


SHADES = 8  # of a path that fades
FAINT = 0.25
STEP_PX = 5.0
CLOSURE_RING = 9.0  # pixels
LEAST_PX = 14.0  # a shorter line would lie beneath the arrow


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
    """The path by odometry alone, (n, 2): dashed, its older parts faint. What leaves the field is left out."""
    thin = meshes.thinned(path, STEP_PX / sheet.scale) if len(path) > 1 else path
    for k, some in enumerate(np.array_split(np.arange(len(thin)), SHADES)):
        part = thin[some[0] : some[-1] + 2] if len(some) else thin[:0]
        inside = sheet.inside(part)
        for piece in np.split(part, np.flatnonzero(inside[1:] != inside[:-1]) + 1) if len(part) else []:
            if sheet.inside(piece)[0]:
                opacity = FAINT + (1 - FAINT) * (k + 1) / SHADES
                sheet.line(piece, robot.pale(palette, palette.robot, robot.PATH_PALE), 2.5, opacity=opacity, dash="8 6")


def draw_ghost(sheet: Sheet, palette: Palette, there: Pose, off_m: float, size: float) -> None:
    """The estimate by odometry alone, and its name; beside the field only its name, at the edge. size: pixels."""
    if off_m < robot.APART_M:
        return
    if sheet.inside([(there.x, there.y)])[0]:
        sheet.arrow(there.x, there.y, there.heading_rad, robot.pale(palette, palette.robot), size)
        sheet.avoid((there.x, there.y), size)
    fill = robot.pale(palette, palette.robot, robot.LABEL_PALE)
    sheet.label((there.x, there.y), robot.words_of(off_m), palette.sheet, up=-size - 17, fill=fill)


def ghost_entry(shown: Ghost | None, palette: Palette) -> list[Entry]:
    colour = robot.pale(palette, palette.robot)
    return [] if shown is None else [("dashes", colour, "as the wheels alone would have it")]


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
    sheet.dot(line[1].tolist(), CLOSURE_RING, None, palette.true_path)
    sheet.dot(line[1].tolist(), 3.5, palette.true_path)
    sheet.avoid(line[1].tolist(), CLOSURE_RING)
    seen = sheet.within(line)
    if (words := words_of(metres)) and len(seen):  # where the line ends, or leaves the field
        sheet.label(seen[0, 1].tolist(), words, palette.sheet, up=27, fill=palette.true_path)
    return [("line", palette.true_path, "to where it truly is")]


def draw_spread(sheet: Sheet, subject: Subject, fit: MapFit) -> list[Entry]:
    spread: Spread | None = subject.judged.spread
    if spread is None:
        return []
    here, turn = subject.snapshot.estimate, spread.turn_rad + fit.turn_rad
    c, s = math.cos(turn), math.sin(turn)
    axes = np.array([spread.along_m, spread.across_m]) * SIGMAS * fit.scale
    middle = fit.to_plate(np.array([[here.x, here.y]]))
    around = meshes.circle(1.0, corners=48) * axes @ np.array([(c, s), (-s, c)]) + middle
    sheet.line(np.vstack([around, around[:1]]), subject.palette.robot, 2)
    return [("oval", subject.palette.robot, "[ours] its doubt: two standard deviations")]


def draw_closures(sheet: Sheet, subject: Subject, places: Points) -> list[Entry]:
    """places: (n, 2) of all experiences on the sheet. The newest says what it did."""
    last = [closure for closure in subject.judged.closures[-graph.MOST :] if closure.end < len(places)]
    palette = subject.palette
    colour = palette.packets[3]
    for closure in last:
        at = places[closure.end].tolist()
        sheet.dot(at, CLOSURE_RING + 2, None, palette.casing, edge=6.5)
        sheet.dot(at, CLOSURE_RING + 2, None, colour, edge=3.5)
        sheet.avoid(at, CLOSURE_RING + 4)
    if last and subject.snapshot.time_s - last[-1].time_s <= graph.TOLD_S:
        sheet.label(places[last[-1].end].tolist(), graph.words_of(last[-1]), palette.sheet, up=30, fill=colour)
    return [("ring", colour, "where a loop was closed")] if last else []


RING, SPOT = 16.0, 10.0  # pixels
MOST_LETTERS = 72  # in the legend


def mark_on_map(sheet: Sheet, subject: Subject, fit: MapFit, places: Points) -> list[Entry]:
    """What is inspected, in the colour of text, as on the stage: a ring and a name at the experience, with its links bright;
    small rings at all that belong to a view or a cell. places: (n, 2) of all experiences on the sheet."""
    report, palette = subject.overlaid.inspected, subject.palette
    if report is None:
        return []
    if isinstance(report, ExperienceReport):
        at = fit.to_plate(np.array([[report.pose.x, report.pose.y]]))[0].tolist()
        sheet.lines(places[links_of(report, len(places))], palette.text, 3)
        sheet.dot(at, RING, None, palette.casing, edge=9)
        sheet.dot(at, RING, None, palette.text, edge=4.5)
        sheet.avoid(at, RING)
        sheet.label(at, f"#{report.id}", palette.sheet, up=34, fill=palette.text)
        return [("ring", palette.text, f"experience {report.id} and its links")]
    spots = places[spots_of(report, len(places))].tolist()
    for place in spots:
        sheet.dot(place, SPOT, None, palette.text, edge=3)
        sheet.avoid(place, SPOT)
    return [("ring", palette.text, _words(report))] if spots else []


def _words(report: ViewReport | CellReport | WhyReport) -> str:
    match report:
        case ViewReport():
            return f"made with view {report.id}"
        case CellReport():
            return f"their zones hold the cells at {report.x}, {report.y}"
        case WhyReport():
            return shorten(f"why: {report.text}", MOST_LETTERS, placeholder=" ...")


def mark_among_cells(sheet: Sheet, subject: Subject) -> list[Entry]:
    """An experience's zone of influence, or a column of cells; and the cells that the view is linked to."""
    report, palette, legend = subject.overlaid.inspected, subject.palette, list[Entry]()
    if isinstance(report, ExperienceReport):
        _draw_zone(sheet, subject, report)
        legend.append(("ring", palette.text, f"zone of experience {report.id}"))
    elif isinstance(report, CellReport):
        corners = _square(report.x, report.y, 1.0)
        sheet.line(np.vstack([corners, corners[:1]]), palette.text, 3)
        legend.append(("ring", palette.text, f"the cells at {report.x}, {report.y}"))
    if isinstance(report, ExperienceReport | ViewReport):
        cells, sizes = linked_cells(report)
        for (_, y, x), size in zip(cells[::-1].tolist(), sizes[::-1].tolist(), strict=True):
            sheet.polygon(_square(x, y, size), palette.text)
        view = report.view if isinstance(report, ExperienceReport) else report.id
        if len(cells):
            legend.append(("area", palette.text, f"cells that view {view} is linked to"))
    return legend


def _draw_zone(sheet: Sheet, subject: Subject, report: ExperienceReport) -> None:
    """A disc; where it leaves the sheet, it goes on at the other side."""
    _, n_y, n_x = subject.snapshot.pose_cells.shape
    for across in (-n_x, 0, n_x):
        for up in (-n_y, 0, n_y):
            middle = report.cell[0] + across, report.cell[1] + up
            around = meshes.circle(report.zone_xy, middle, corners=48)
            if sheet.inside(around).any():
                sheet.polygon(around, subject.palette.text, opacity=0.3)
                sheet.line(np.vstack([around, around[:1]]), subject.palette.text, 2.5)


def _square(x: float, y: float, size: float) -> Points:
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size / 2 + (x, y)


APART_PX = 45.0  # of marks that are nearer to one another only the last is named
MARK_RING = 8.0


def draw_name(sheet: Sheet, place: Sequence[float], name: str, *, known: bool) -> None:
    """Of a place of the office. known: by the map."""
    palette = sheet.palette
    fill = mix(palette.slab, palette.sheet, 0.0 if known else 0.6)
    ink = palette.text if known else palette.text_2
    sheet.label(place, name, ink, fill=fill, rim=ink)


def draw_pins(sheet: Sheet, subject: Subject, plate: Literal["office", "map"], fit: MapFit) -> None:
    """fit: turns the plate's frame as on the sheet."""
    if subject.snapshot.lesson is None:
        return
    words, places = pins(subject.snapshot.lesson, plate)
    on_sheet = fit.to_plate(places)
    for k in last_named(on_sheet, APART_PX / sheet.scale):
        draw_pin(sheet, subject, on_sheet[k].tolist(), words[k])


def draw_pin(sheet: Sheet, subject: Subject, place: list[float], words: str) -> None:
    palette = subject.palette
    sheet.dot(place, MARK_RING, None, palette.casing, edge=6)
    sheet.dot(place, MARK_RING, None, palette.text, edge=3)
    sheet.avoid(place, MARK_RING)
    sheet.label(place, words, palette.sheet, up=-25, fill=palette.text)


def draw_cell_marks(sheet: Sheet, subject: Subject) -> None:
    """Among the pose cells, with a dashed way from where it came, round the torus where that is shorter."""
    lesson, layer = subject.snapshot.lesson, subject.snapshot.pose_cells
    marks = [] if lesson is None else [mark for mark in lesson.marks if mark.plate == "cells"]
    _, n_y, n_x = layer.shape
    fit = CellFit(layer.shape)
    around = np.array([(mark.x, mark.y, mark.heading_rad or 0.0) for mark in marks]).reshape(-1, 3)
    places = (around[:, :2] + 0.5) % (n_x, n_y) - 0.5
    for mark, end in zip(marks, fit.path(around), strict=True):
        if mark.start is not None:
            way = cell_marks.way_between(fit.path(np.array([mark.start]))[0], end)[..., :2] / fit.voxel[:2]
            sheet.lines(way + np.array([n_x / 2 - 0.5, n_y / 2 - 0.5]), subject.palette.text, 2.5)
    for k in last_named(places, APART_PX / sheet.scale):
        draw_pin(sheet, subject, places[k].tolist(), marks[k].words)
