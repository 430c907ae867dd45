"""The arcs among which a robot on a route chose at one moment, and the one that it drove. ACRA 2006 4.3, figure 4."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import math

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, FancyArrowPatch

from app.experiments.figures.map_panels import plan
from app.experiments.figures.palette import BLUE, FAINT, GREEN, INK, SOFT, VERMILION
from app.trials.figure_options import Maps
from app.trials.trace import Movements, Trace

ROUND_M = 1.2  # of the plan, on each side of the robot


def movements(panel: Axes, trace: Trace, options: Maps) -> None:  # noqa: ARG001
    """A turn on the spot has no arc, and is left out."""
    plan(panel, trace)
    shown = trace.movements
    if shown is None:
        panel.set_xlabel("no choice between free and barred arcs", color=SOFT)
        return
    _robot(panel, shown)
    panel.plot(*shown.route.T, ".-", color=GREEN, lw=1.2, ms=4, zorder=4, label="route ahead")
    panel.plot(
        *shown.aim, "o", ms=6, mfc=GREEN, mec="white", mew=0.6, ls="none", zorder=7, label="point it steers towards"
    )
    barred, free = shown.paths[shown.drives & ~shown.free], shown.paths[shown.drives & shown.free]
    panel.add_collection(
        LineCollection(list(barred), colors=SOFT, linewidths=0.6, linestyles=(0, (3, 2)), zorder=3, label="barred arc")
    )
    panel.add_collection(LineCollection(list(free), colors=BLUE, linewidths=0.7, zorder=5, label="free arc"))
    _chosen(panel, shown)
    x, y = shown.robot.x, shown.robot.y
    panel.set(xlim=(x - ROUND_M, x + ROUND_M), ylim=(y - ROUND_M, y + ROUND_M), aspect="equal")
    panel.set_xlabel(f"{2 * ROUND_M:g} m across, after {shown.time_s / 60:.1f} min", color=SOFT)


def _robot(panel: Axes, shown: Movements) -> None:
    """A disc of its true size, with a stroke where it faces."""
    x, y, heading = shown.robot.x, shown.robot.y, shown.robot.heading_rad
    panel.add_patch(Circle((x, y), shown.radius_m, fc=FAINT, ec=INK, lw=0.8, zorder=2))
    far = x + shown.radius_m * math.cos(heading), y + shown.radius_m * math.sin(heading)
    panel.plot([x, far[0]], [y, far[1]], color=INK, lw=1.2, zorder=2)


def _chosen(panel: Axes, shown: Movements) -> None:
    """An arrow whose head ends where the arc does."""
    way = shown.paths[shown.chosen]
    panel.plot(*way[:-1].T, color=VERMILION, lw=1.8, zorder=6, label="chosen arc")
    head = FancyArrowPatch(way[-2], way[-1], arrowstyle="-|>,head_length=6,head_width=3", shrinkA=0, shrinkB=0,
                           color=VERMILION, lw=0, mutation_scale=1, zorder=6)  # fmt: skip
    panel.add_patch(head)
