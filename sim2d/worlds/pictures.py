"""Draws worlds from above, as PNG files for the documentation.

python -m sim2d.worlds.pictures docs/pictures/worlds
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim2d.world.drawing import draw_world
from sim2d.world.world import Rgb, World
from sim2d.world.world_file import load_world, world_names

_SIDE_PX = 1000  # width of the picture
_RIM_PX = 16
_FINE = 4  # binary places: coordinates are in sixteenths of a pixel
_KINDS = {
    "wall": ((60, 60, 64), 3),
    "partition": ((150, 120, 70), 2),
    "desk": ((70, 130, 180), 2),
    "glass": ((230, 190, 120), 3),
}  # colour BGR, width
_DOOR, _LAMP = (62, 104, 150), (90, 210, 250)
_HOME, _PLACE, _SLOW = (40, 40, 220), (30, 140, 30), (200, 225, 255)


class _Sheet:
    """An empty picture for a world, and the conversion from metres to its pixels."""

    def __init__(self, world: World) -> None:
        x0, y0, x1, y1 = world.bounds
        self.scale = (_SIDE_PX - 2 * _RIM_PX) / max(x1 - x0, y1 - y0)
        self._corner, self._rows = (x0, y0), round((y1 - y0) * self.scale) + 2 * _RIM_PX
        self.image = np.full((self._rows, _SIDE_PX, 3), 255, np.uint8)

    def at(self, points: object) -> NDArray[np.int32]:
        xy = (np.asarray(points, float).reshape(-1, 2) - self._corner) * self.scale + _RIM_PX
        return np.rint(np.column_stack([xy[:, 0], self._rows - xy[:, 1]]) * (1 << _FINE)).astype(np.int32)

    def line(self, ends: object, colour: Rgb, width: int) -> None:
        a, b = self.at(ends).tolist()
        cv2.line(self.image, a, b, colour, width, cv2.LINE_AA, _FINE)


def picture_of(world: World) -> NDArray[np.uint8]:
    """(rows, columns, 3) BGR: walls and panels, slow floors, elements, starts (red) and named places (green)."""
    sheet = _Sheet(world)
    _draw_walls(sheet, world)
    _draw_elements(sheet, world)
    for place in world.places:
        at = sheet.at([(place.x, place.y)])[0]
        _dot(sheet.image, at.tolist(), _PLACE)
        _label(sheet.image, at >> _FINE, place.name)
    for start in world.starts:
        long, heading = 16 / sheet.scale, start.heading_rad
        tip = (start.x + long * math.cos(heading), start.y + long * math.sin(heading))
        _dot(sheet.image, sheet.at([(start.x, start.y)])[0].tolist(), _HOME)
        sheet.line([(start.x, start.y), tip], _HOME, 3)
    return sheet.image


def _draw_walls(sheet: _Sheet, world: World) -> None:
    cv2.fillPoly(sheet.image, [sheet.at(world.outline)], (238, 240, 242), cv2.LINE_AA, _FINE)
    for zone in world.slow_zones:
        cv2.fillPoly(sheet.image, [sheet.at(zone.corners)], _SLOW, cv2.LINE_AA, _FINE)
    is_large = sheet.scale > 12
    for wall in world.walls:
        if wall.stands:
            colour, width = _KINDS.get(wall.kind, _KINDS["wall"])
            sheet.line([(wall.x1, wall.y1), (wall.x2, wall.y2)], colour, width if is_large else 1)
    if is_large:  # else they would be specks
        drawing = draw_world(world)
        for panel, rgb in zip(drawing.panels, drawing.panel_rgb.tolist(), strict=True):
            sheet.line(panel[:4], rgb[::-1], 2)


def _draw_elements(sheet: _Sheet, world: World) -> None:
    image, at = sheet.image, sheet.at
    for door in world.doors:
        sheet.line(door.leaf(0.0), _DOOR, 3)
    for lamp in world.lamps:
        cv2.circle(image, at([(lamp.x, lamp.y)])[0].tolist(), 9 << _FINE, _LAMP, -1, cv2.LINE_AA, _FINE)
    for box in world.boxes:
        cv2.polylines(image, [at(box.corners)], True, _bgr(box.colour), 2, cv2.LINE_AA, _FINE)
    for person in world.people:
        cv2.polylines(image, [at(person.path)], person.loop, _bgr(person.colour), 1, cv2.LINE_AA, _FINE)
        _dot(image, at([person.path[0]])[0].tolist(), _bgr(person.colour))


def _bgr(colour: Rgb) -> Rgb:
    return colour[2], colour[1], colour[0]


def _dot(image: NDArray[np.uint8], at: list[int], colour: tuple[int, int, int]) -> None:
    cv2.circle(image, at, 6 << _FINE, colour, -1, cv2.LINE_AA, _FINE)


def _label(image: NDArray[np.uint8], at: NDArray[np.int32], text: str) -> None:
    font, size = cv2.FONT_HERSHEY_SIMPLEX, 0.45
    width = cv2.getTextSize(text, font, size, 1)[0][0]
    x = min(max(int(at[0]) - width // 2, 2), image.shape[1] - width - 2)
    y = int(at[1]) - 11 if at[1] > 40 else int(at[1]) + 22
    cv2.putText(image, text, (x, y), font, size, (255, 255, 255), 4, cv2.LINE_AA)
    cv2.putText(image, text, (x, y), font, size, (40, 40, 40), 1, cv2.LINE_AA)


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, _ in world_names():
        cv2.imwrite(str(folder / f"{name}.png"), picture_of(load_world(name)), [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
