"""What moves and changes in the office, on a sheet: the night, lamps and their light, doors, boxes, people."""

from __future__ import annotations

import numpy as np

from web.messages import LivingLayer
from web.viewer.marks.actors import DARKEST, DOOR_RGB, LIT, NIGHT, POOL, SHINE, unlit
from web.viewer.primitives import meshes
from web.viewer.vector.sheet import Sheet

LAMP, LEAST = 6.0, 5.0  # pixels
NOSE = 0.45  # share of a person's radius


def draw_light(sheet: Sheet, layer: LivingLayer | None, bounds: tuple[float, float, float, float]) -> None:
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


def draw_living(sheet: Sheet, layer: LivingLayer | None) -> None:
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
