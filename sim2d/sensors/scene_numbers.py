"""Scene numbers from the true pose, as in the papers' own simulator. ACRA 2005 section 5, ACRA 2006 section 5.1."""

from __future__ import annotations

import math

from numba import njit


@njit(cache=True, nogil=True)
def scene_number(
    x: float, y: float, heading_rad: float, bounds: tuple[float, float, float, float], cell_m: float, angle_rad: float
) -> int:
    """A number from 0: equal for two poses in the same square of the floor and the same sector of heading, else
    different.

    x, y (m) inside `bounds` (least x, least y, most x, most y). A sector is `angle_rad` wide, or a little less so that
    a whole number of them fits into a turn.
    """
    x_from, y_from, x_to, y_to = bounds
    columns, rows = max(1, math.ceil((x_to - x_from) / cell_m)), max(1, math.ceil((y_to - y_from) / cell_m))
    sectors = math.ceil(2 * math.pi / angle_rad - 1e-9)
    column = min(max(int((x - x_from) // cell_m), 0), columns - 1)
    row = min(max(int((y - y_from) // cell_m), 0), rows - 1)
    sector = int(heading_rad % (2 * math.pi) / (2 * math.pi) * sectors) % sectors
    return (sector * rows + row) * columns + column
