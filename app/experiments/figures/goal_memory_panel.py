"""The goal memory's temporal map over the pose cells, and its plateaus. IROS 2005 V.D, figure 9 and point C."""

# matplotlib and SciPy tell the types of their own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from __future__ import annotations

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label, maximum_filter

from app.experiments.figures.map_panels import cells_frame, extent, seconds
from app.experiments.figures.palette import VERMILION
from app.trials.figure_options import Maps
from app.trials.final_map import APART_M
from app.trials.trace import Trace

LEAD = 0.1  # of the longest time: two ways whose times differ by less take the same time
BELOW = 0.05  # of the longest time: what is no lower than this under the highest time around is at the watershed
LEAST_CELLS = 4  # fewer are no plateau: they have room for no robot
TOGETHER = 3  # cells; groups that are nearer have one ring


def goal_memory(panel: Axes, trace: Trace, options: Maps) -> None:  # noqa: ARG001
    times, lead = trace.map.goal_times, trace.map.goal_lead
    if times is not None and lead is not None:
        drawn = panel.imshow(
            np.ma.masked_invalid(times.values), origin="lower", extent=extent(times), cmap="viridis_r", zorder=0
        )
        seconds(panel, drawn)
        _rings(panel, plateau(times.values, lead.values, APART_M / trace.cell_m))
    cells_frame(panel, trace)


def plateau(times_s: NDArray[np.float64], lead_s: NDArray[np.float64], apart: float) -> NDArray[np.bool_]:
    """The cells from which two ways take the same time and around which none within `apart` cells takes longer. (n_y, n_x).

    Since times grow from the goal on both ways round until they meet, a plateau is where they are highest. Elsewhere
    two ways may begin with nearly the same time, too, beside the goal or where the packet once jumped.
    """
    known = np.isfinite(times_s)
    if not known.any():
        return known
    longest = float(times_s[known].max())
    reach = np.arange(-int(apart), int(apart) + 1)
    around = maximum_filter(
        np.where(known, times_s, -np.inf), footprint=np.hypot(reach[:, None], reach) <= apart, mode="wrap"
    )
    return known & (lead_s < LEAD * longest) & (times_s >= around - BELOW * longest)


def _rings(panel: Axes, cells: NDArray[np.bool_]) -> None:
    """A dot in each cell, and a ring about each group, since a cell is small on the page."""
    near = label(binary_dilation(cells, np.ones((3, 3)), TOGETHER))
    groups, count = cast("tuple[NDArray[np.int32], int]", near)
    for group in range(1, count + 1):
        y, x = np.nonzero(cells & (groups == group))
        if len(x) < LEAST_CELLS:
            continue
        panel.plot(x, y, "s", ms=1.2, color=VERMILION, mew=0, ls="none", zorder=3)
        panel.plot(x.mean(), y.mean(), "o", ms=11, mfc="none", mec=VERMILION, mew=1.0, ls="none", zorder=4,
                   label="plateau: both ways take the same time")  # fmt: skip
