"""Draws the floor plans in this folder: `python -m tests.data.make`. One building of our own, in the formats of plans.

Sixteen offices along a corridor, with pillars in the corridor and slanted desks: 56 by 16 m. `building.vectormap.json`
has the walls as lines. `building.yaml` with its picture is what a robot's mapper would make of it: turned, with noise,
the outside unknown. `drawing.png` is the plan as a draughtsman's picture.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
LENGTH_M, DEPTH_M, CORRIDOR_M, ROOMS, DOOR_M = 56.0, 16.0, 2.4, 8, 1.0  # rooms on each side
TURN_RAD, RESOLUTION_M, MARGIN_M = math.radians(8), 0.05, 1.0
UNKNOWN = 205
Line = tuple[float, float, float, float]


def building() -> list[Line]:
    """Walls, desks and pillars as lines in metres, (0, 0) at the lower left."""
    low, high, wide = (DEPTH_M - CORRIDOR_M) / 2, (DEPTH_M + CORRIDOR_M) / 2, LENGTH_M / ROOMS
    lines: list[Line] = [(0, 0, LENGTH_M, 0), (LENGTH_M, 0, LENGTH_M, DEPTH_M)]
    lines += [(LENGTH_M, DEPTH_M, 0, DEPTH_M), (0, DEPTH_M, 0, 0)]
    for k in range(ROOMS):
        left, right = k * wide, (k + 1) * wide
        for wall_y, outer_y in ((low, 0.0), (high, DEPTH_M)):
            door = left + 0.8 + 0.6 * k
            lines += [(left, wall_y, door, wall_y), (door + DOOR_M, wall_y, right, wall_y)]
            if k:
                lines.append((left, wall_y, left, outer_y))
            middle_y = (wall_y + outer_y) / 2
            lines += box((left + right) / 2 + 0.7, middle_y, 1.6, 0.8, 0.3 * k + (outer_y > 0))
        lines += box((left + right) / 2, DEPTH_M / 2 + 0.3 * (-1) ** k, 0.4, 0.4, math.pi / 4)
    return [tuple(round(float(value), 3) for value in line) for line in lines]  # type: ignore[misc]


def box(x: float, y: float, width: float, depth: float, angle: float) -> list[Line]:
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    corners = np.array([(-width, -depth), (width, -depth), (width, depth), (-width, depth)]) / 2 @ turn.T + (x, y)
    return [(*a, *b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]


def drawn(lines: list[Line], metres_a_pixel: float, turn_rad: float, outside: int, ink_px: int) -> NDArray[np.uint8]:
    """White floor, black lines, row 0 at the top."""
    turn = np.array([[math.cos(turn_rad), -math.sin(turn_rad)], [math.sin(turn_rad), math.cos(turn_rad)]])
    ends = np.array(lines).reshape(-1, 2) @ turn.T
    ends -= ends.min(axis=0) - MARGIN_M
    columns, rows = np.ceil((ends.max(axis=0) + MARGIN_M) / metres_a_pixel).astype(int).tolist()
    picture = np.full((rows, columns), 254, np.uint8)
    pixels = np.floor(ends / metres_a_pixel).astype(int).reshape(-1, 2, 2)
    for (x1, y1), (x2, y2) in pixels.tolist():
        cv2.line(picture, (x1, rows - 1 - y1), (x2, rows - 1 - y2), 0, ink_px)
    cv2.floodFill(picture, None, (0, 0), outside)  # type: ignore[arg-type]
    return picture


def scanned(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture as a mapper would see it: stray pixels here and there, and walls that are not quite straight."""
    rng = np.random.default_rng(5)
    dots = (rng.random(picture.shape) < 0.0005) & (picture == 254)
    near_wall = cv2.dilate((picture == 0).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    frayed = near_wall & (picture == 254) & (rng.random(picture.shape) < 0.02)
    return np.where(dots | frayed, 0, picture).astype(np.uint8)


def main() -> None:
    lines = building()
    items = [{"p0": {"x": a, "y": b}, "p1": {"x": c, "y": d}} for a, b, c, d in lines]
    rows = ",\n".join(json.dumps(item) for item in items)
    (HERE / "building.vectormap.json").write_text(f"[\n{rows}\n]\n", encoding="utf-8")
    cv2.imwrite(str(HERE / "building.png"), scanned(drawn(lines, RESOLUTION_M, TURN_RAD, UNKNOWN, 3)))
    (HERE / "building.yaml").write_text(
        f"image: building.png\nresolution: {RESOLUTION_M}\norigin: [-12.5, 3.25, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        encoding="utf-8",
    )
    cv2.imwrite(str(HERE / "drawing.png"), drawn(lines, 2 * RESOLUTION_M, 0.0, 0, 2))


if __name__ == "__main__":
    main()
