"""What lies on the floors of a sheet: where the sonars met something, and the goal memory's times. A pixel is a cell."""

from __future__ import annotations

import numpy as np

from web.messages.told import seconds_words
from web.viewer.fits.map_fit import MapFit
from web.viewer.plates import overlays
from web.viewer.primitives.palette import Palette, mix
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject


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
    """Below the pose cells: the occupancy in their frame, and over it the times to the goal with their scale."""
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
