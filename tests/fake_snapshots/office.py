"""The made-up office as it is drawn, and where the robot fits in it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from sim2d import FreeSpace, Start, Wall, World
from sim2d.world.robot_fit import RobotFit
from web.messages import WorldDrawing

from .frozen import frozen

SONAR_RAD = np.radians([-90, -50, -30, -10, 10, 30, 50, 90]).astype(np.float32)
FOV_RAD = math.radians(90)
DESKS = [(2.0, 5.4, 3.6, 6.0), (1.6, 2.1, 2.8, 2.7), (2.8, 2.1, 4.0, 2.7), (6.4, 5.0, 8.1, 5.7), (6.35, 2.6, 7.0, 3.3)]
DESKS += [(6.35, 1.8, 7.0, 2.5)]
PARTITIONS = [(1.5, 5.3, 3.9, 5.3), (1.5, 2.0, 4.1, 2.0), (2.8, 2.0, 2.8, 3.4), (7.2, 5.7, 7.2, 6.7)]
PARTITIONS += [(6.3, 1.7, 6.3, 3.8), (6.3, 2.55, 8.2, 2.55)]
_PALETTE = [(230, 159, 0), (86, 180, 233), (0, 158, 115), (240, 228, 66), (0, 114, 178), (213, 94, 0), (204, 121, 167)]


@lru_cache(maxsize=1)
def office() -> WorldDrawing:
    rows: list[tuple[float, float, float, float]] = [(0, 0, 10, 0), (10, 0, 10, 8), (10, 8, 0, 8), (0, 8, 0, 0)]
    heights, kinds = [2.5] * 4, ["wall"] * 4
    for row in PARTITIONS:
        rows.append(row)
        heights.append(1.4)
        kinds.append("partition")
    for x1, y1, x2, y2 in DESKS:
        rows += [(x1, y1, x2, y1), (x2, y1, x2, y2), (x2, y2, x1, y2), (x1, y2, x1, y1)]
        heights += [0.75] * 4
        kinds += ["desk"] * 4
    panels, colours = [], []
    for k, x in enumerate((0.8, 2.1, 3.4, 4.7, 6.0, 7.3)):
        panels.append((x, 8, x + (0.5 if k == 3 else 0.8), 8, 1.0, 1.9))
        colours.append(_PALETTE[k])
    panels += [(8.4, 8, 9.3, 8, 0.0, 2.1), (0, 6.6, 0, 7.5, 0.0, 2.1)]
    colours += [(139, 84, 30), (139, 84, 30)]
    for k, y in enumerate((0.6, 1.7, 3.4, 4.6, 5.7)):
        panels += [(10, y, 10, y + 0.7, 0.9, 1.9), (0, y, 0, y + 0.7, 0.9, 1.9)]
        colours += [_PALETTE[5 - k], _PALETTE[(k + 3) % 7]]
    return WorldDrawing(
        name="office",
        title="Office, 10 x 8 m",
        bounds=(0.0, 0.0, 10.0, 8.0),
        walls=frozen(np.array(rows, np.float32)),
        wall_height_m=frozen(np.array(heights, np.float32)),
        wall_kind=tuple(kinds),
        panels=frozen(np.array(panels, np.float32)),
        panel_rgb=frozen(np.array(colours, np.uint8)),
        places=(("printer", 9.1, 7.2), ("kitchen", 0.8, 0.8), ("desk of Ada", 4.9, 3.9)),
        robot_radius_m=0.2,
        camera_fov_rad=FOV_RAD,
        sonar_angles_rad=frozen(SONAR_RAD.copy()),
    )


@lru_cache(maxsize=1)
def office_fit() -> RobotFit:
    """The same check of fit as in a real session, over the same walls."""
    drawn = office()
    walls = [
        Wall(*map(float, row), kind, float(height), (0, 0, 0), outer=i < 4)
        for i, (row, kind, height) in enumerate(zip(drawn.walls, drawn.wall_kind, drawn.wall_height_m, strict=True))
    ]
    start = Start("here", 5.0, 0.8, 0.0)
    return RobotFit(FreeSpace(World("office", drawn.title, "", tuple(walls), (start,), ()), drawn.robot_radius_m))
