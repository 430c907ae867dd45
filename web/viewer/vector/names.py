"""Names of places on a sheet, and what a lesson has there: what happened, where it happened, and what was predicted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from web.viewer.fits.cell_fit import CellFit
from web.viewer.fits.map_fit import MapFit
from web.viewer.marks import cell_marks
from web.viewer.marks.tags import last_named
from web.viewer.plates.lesson_marks import pins
from web.viewer.primitives.palette import mix
from web.viewer.vector.sheet import Sheet
from web.viewer.vector.subject import Subject

APART_PX = 45.0  # of marks that are nearer to one another only the last is named
RING = 8.0


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
    sheet.dot(place, RING, None, palette.casing, edge=6)
    sheet.dot(place, RING, None, palette.text, edge=3)
    sheet.avoid(place, RING)
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
