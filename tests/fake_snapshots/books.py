"""What is kept of a session: series, events and parameters."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from web.messages import Event, Parameter, Series

from .experience_map import NODES
from .frozen import frozen


@lru_cache(maxsize=4)
def series_until(second: int) -> Series:
    time_s = np.linspace(0, max(second, 1), min(600, second + 2))
    return Series(
        time_s=frozen(time_s),
        map_error_m=frozen(0.22 + 0.05 * np.sin(time_s / 9)),
        odometry_error_m=frozen(0.2 + 0.005 * time_s),
        views=frozen(600 * (1 - np.exp(-time_s / 90))),
        experiences=frozen(NODES * (1 - np.exp(-time_s / 120))),
        residual_mm=frozen(3 + np.sin(time_s / 7)),
        residual_mrad=frozen(4 + 1.0 * np.sin(time_s / 5)),
    )


@lru_cache(maxsize=8)
def event_log(snaps: int, goal: bool) -> tuple[Event, ...]:
    events = [Event(k, k * 40.0 + 8, "snap", f"snapped 5.6 m, snap {k}") for k in range(1, snaps + 1)]
    return tuple(([Event(0, 2.0, "goal", "goal set: printer")] if goal else []) + events)


@lru_cache(maxsize=1)
def parameter_list() -> tuple[Parameter, ...]:
    paper = "ACRA 2004"
    return (
        Parameter(
            "local_view.threshold", 8.0, 8.0, "s_m", "grey", 0.0, 64.0, "a view counts as known below", paper, True
        ),
        Parameter("local_view.width", 12, 12, "w", "px", 4, 64, "columns of a stored view", paper, False),
        Parameter("pose_cells.injection", 0.1, 0.1, "delta", "", 0.0, 1.0, "strength of visual input", paper, True),
        Parameter("pose_cells.inhibition", 0.002, 0.002, "phi", "", 0.0, 0.1, "global inhibition", paper, True),
        Parameter("pose_cells.cells", 64, 64, "n_x", "cells", 8, 128, "cells along x' and y'", paper, False),
        Parameter(
            "experience_map.correction", 0.5, 0.5, "alpha", "", 0.0, 1.0, "share of an error put right", paper, True
        ),
        Parameter("pilot.speed", 0.3, 0.3, "v", "m/s", 0.05, 0.5, "cruising speed", "ours", True),
        Parameter("pilot.wander", True, True, "", "", None, None, "explore when there is no goal", "ours", True),
        Parameter("views.kind", "sad", "sad", "", "", None, None, "how views are compared", "ours", False),
    )
