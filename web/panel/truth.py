"""Truth: how far map and odometry are from the robot's true place, and how far the map is from its own links."""

from __future__ import annotations

import math

import numpy as np

from web.messages import Series, Snapshot
from web.panel.part import Content
from web.panel.words import number, table

COLUMNS = ("time_s", "map_error_m", "odometry_error_m", "views", "experiences", "residual_mm", "residual_mrad")


def numbers(snapshot: Snapshot) -> Content:
    again = snapshot.revisit_consistency
    rows = [
        ("map error, after alignment", number(snapshot.error_map_m, "m", 2)),
        ("odometry alone", number(snapshot.error_odometry_m, "m", 2)),
    ]
    if snapshot.coverage is not None:
        rows.append(("floor covered, to within a metre", f"{100 * snapshot.coverage:.0f} %"))
    rows.append(("revisits within half a metre", "no revisits yet" if again is None else f"{100 * again:.0f} %"))
    return Content({"table": table("Error against the true world", rows)})


def series(series: Series) -> Content:
    """The columns of the plots, and by how much map and links disagree now."""
    if len(series.time_s) < 2:
        return Content({"residual": None})
    now = f"{series.residual_mm[-1]:.1f} mm and {math.degrees(series.residual_mrad[-1] / 1000):.2f}°"
    return Content({"residual": now}, {name: getattr(series, name).astype(np.float32) for name in COLUMNS})
