"""One panel of a map, each kind a function: it draws a trace on axes in metres of the office, or in pose cells."""

# matplotlib and SciPy tell the types of their own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from __future__ import annotations

import math
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label, maximum_filter

from app.experiments.figures.canvas import (
    BLUE,
    ENGINE_COLOUR,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    SOFT,
    VERMILION,
    WALL,
)
from app.protocol.figure_options import Maps
from app.protocol.trace import APART_M, Grid, Movements, Trace

_Array = NDArray[np.float64]
MARGIN_M = 0.4
MANY_LINKS = 6000  # more are drawn as a picture
FEW_SNAPS = 12  # so many are lettered
ROUND_M = 1.2  # of the plan, on each side of the robot
LEAD = 0.1  # of the longest time: two ways whose times differ by less take the same time
BELOW = 0.05  # of the longest time: what is no lower than this under the highest time around is at the watershed
LEAST_CELLS = 4  # fewer are no plateau: they have room for no robot
TOGETHER = 3  # cells; groups that are nearer have one ring
_FREE, _TAKEN = to_rgb(SKY), to_rgb(SOFT)


def _plan(panel: Axes, trace: Trace) -> None:
    """Walls and boxes; the panel is as large as the office."""
    panel.add_collection(
        LineCollection(list(trace.plan.walls.reshape(-1, 2, 2)), colors=WALL, linewidths=0.8, zorder=1)
    )
    panel.add_collection(PolyCollection(list(trace.plan.boxes), facecolors="none", edgecolors=WALL, linewidths=0.5))
    x1, y1, x2, y2 = trace.plan.bounds
    panel.set(xlim=(x1 - MARGIN_M, x2 + MARGIN_M), ylim=(y1 - MARGIN_M, y2 + MARGIN_M), aspect="equal")
    panel.update_datalim([(x1, y1), (x2, y2)])


def _goals(panel: Axes, trace: Trace) -> None:
    """A star where a goal truly is, a ring where the map has put the experience that was tagged there, and who was reached."""
    reached = {visit.name: visit.reached for visit in trace.visits}
    for goal in trace.goals:
        ok = reached.get(goal.name)
        colour = INK if ok is None else GREEN if ok else ORANGE
        words = "goal" if ok is None else "goal, reached" if ok else "goal, not reached"
        panel.plot(goal.x, goal.y, "*", ms=8, mfc=colour, mec="white", mew=0.4, ls="none", zorder=6, label=words)
        if goal.experience is not None:
            x, y, _ = trace.map.poses[goal.experience]
            panel.plot([goal.x, x], [goal.y, y], "-", color=colour, lw=0.6, zorder=5)
            panel.plot(
                x, y, "o", ms=5, mfc="none", mec=colour, mew=0.9, ls="none", zorder=6, label="its place in the map"
            )


def _links(panel: Axes, trace: Trace, colour: str) -> None:
    """One line with gaps, since a file with a path for each link would be ten times as large."""
    ends = trace.map.poses[trace.map.links, :2]
    gaps = np.full((len(ends), 1, 2), np.nan)
    line = np.concatenate([ends, gaps], axis=1).reshape(-1, 2)
    panel.plot(*line.T, color=colour, lw=0.7, zorder=2, rasterized=len(ends) > MANY_LINKS)


def experience_map(panel: Axes, trace: Trace, options: Maps) -> None:
    _plan(panel, trace)
    colour = ENGINE_COLOUR[trace.trial.engine]
    _links(panel, trace, colour)
    panel.plot(*trace.map.poses[:, :2].T, ".", ms=1.8, color=colour, zorder=3)
    if options.marks:
        _goals(panel, trace)


def paths(panel: Axes, trace: Trace, options: Maps) -> None:
    _plan(panel, trace)
    panel.plot(*trace.odometry_path.T, color=ORANGE, lw=0.7, zorder=2, label="odometry alone")
    panel.plot(*trace.true_path.T, color=INK, lw=1.4, zorder=3, label="truth")
    sent = _on_the_way(trace)
    if np.isfinite(sent).any():
        panel.plot(*sent.T, color=VERMILION, lw=1.4, zorder=3, label="truth, sent to a goal")
    panel.plot(*trace.mapped_path.T, color=BLUE, lw=0.7, zorder=4, label="as the map tells it")
    if options.marks:
        _goals(panel, trace)


def _on_the_way(trace: Trace) -> _Array:
    """(n, 2): where the robot truly was in each row; NaN while it was not sent to a goal."""
    sent = np.zeros(len(trace.time_s), bool)
    for visit in trace.visits:
        sent |= (trace.time_s >= visit.began_s) & (trace.time_s <= visit.began_s + visit.time_s)
    return np.where(sent[:, None], trace.truth[:, :2], np.nan)


def _cells_frame(panel: Axes, trace: Trace) -> None:
    _, n_y, n_x = trace.cells_shape
    panel.set(
        xlim=(-0.5, n_x - 0.5),
        ylim=(-0.5, n_y - 0.5),
        aspect="equal",
        xlabel=f"{n_x} x {n_y} cells of {trace.cell_m:g} m",
    )


def pose_cells(panel: Axes, trace: Trace, options: Maps) -> None:
    """The line is broken where the packet leaves through one face and comes in through the other, and where it snaps."""
    _cells_frame(panel, trace)
    path = broken_path(trace)
    panel.plot(*path.T, color=ENGINE_COLOUR[trace.trial.engine], lw=0.8, zorder=3)
    before, after = _in_faces(trace.snaps[:, 1:3], trace), _in_faces(trace.snaps[:, 4:6], trace)
    few = len(before) <= FEW_SNAPS
    jumps = np.stack([before, after], axis=1)
    lines = LineCollection(list(jumps), colors=SOFT, linewidths=0.5 if few else 0.3, linestyles=(0, (3, 2)), zorder=2,
                           label="snap")  # fmt: skip
    if len(before):
        panel.add_collection(lines)
    for start, end in jumps if few and options.marks else ():
        panel.annotate("S", start, fontsize=6, color=INK, ha="center", va="center", zorder=5)
        panel.annotate("F", end, fontsize=6, color=INK, ha="center", va="center", zorder=5)


def broken_path(trace: Trace) -> _Array:
    """x, y of the winning packet in each row, with a row of NaN wherever the line must not be drawn."""
    _, n_y, n_x = trace.cells_shape
    path = _in_faces(trace.cells[:, :2], trace)
    far = (np.abs(np.diff(path, axis=0)) > np.array([n_x, n_y]) / 2).any(axis=1)
    snapped = np.diff(np.searchsorted(trace.snaps[:, 0], trace.time_s + 1e-9, side="right")) > 0
    return np.insert(path, np.flatnonzero(far | snapped) + 1, np.nan, axis=0)


def _in_faces(points: _Array, trace: Trace) -> _Array:
    """The middle of the first cell is at 0, so the network reaches from half a cell before it."""
    _, n_y, n_x = trace.cells_shape
    return (points + 0.5) % (n_x, n_y) - 0.5


def map_grid(panel: Axes, trace: Trace, options: Maps) -> None:
    _plan(panel, trace)
    grid = trace.map.occupancy
    if grid is None:
        return
    frame = trace.map.in_office
    turn = Affine2D().rotate(frame.heading_rad).translate(frame.x, frame.y)
    limits = panel.get_xlim(), panel.get_ylim()
    panel.imshow(_tinted(grid), origin="lower", extent=_extent(grid), transform=turn + panel.transData, zorder=0)
    panel.set(xlim=limits[0], ylim=limits[1], aspect="equal")
    if options.marks:
        _goals(panel, trace)


def occupancy(panel: Axes, trace: Trace, options: Maps) -> None:  # noqa: ARG001
    grid = trace.map.cells_occupancy
    if grid is not None:
        panel.imshow(_tinted(grid), origin="lower", extent=_extent(grid), zorder=0)
    _cells_frame(panel, trace)


def _tinted(grid: Grid) -> _Array:
    """(n_y, n_x, 4): free is tinted, taken is dark, and what nobody knows lets the page through."""
    sure = (np.clip(grid.values, 0.0, 1.0) - 0.5) * 2
    colour = np.where((sure > 0)[..., None], _TAKEN, _FREE)
    return np.dstack([colour, np.abs(sure) * np.where(sure > 0, 1.0, 0.45)])


def _extent(grid: Grid) -> tuple[float, float, float, float]:
    (x, y), half = grid.origin, grid.cell / 2
    n_y, n_x = grid.values.shape
    return x - half, x + n_x * grid.cell - half, y - half, y + n_y * grid.cell - half


def temporal_map(panel: Axes, trace: Trace, options: Maps) -> None:
    _plan(panel, trace)
    _links(panel, trace, FAINT)
    known = np.isfinite(trace.map.times_s)
    x, y, _ = trace.map.poses[known].T
    drawn = panel.scatter(x, y, c=trace.map.times_s[known], s=7, cmap="viridis_r", linewidths=0, zorder=3)
    _seconds(panel, drawn)
    if options.marks:
        _goals(panel, trace)


def _seconds(panel: Axes, drawn: object) -> None:
    figure = panel.get_figure(root=True)
    assert figure is not None
    bar = figure.colorbar(drawn, ax=panel, shrink=0.7, pad=0.02, aspect=25)  # type: ignore[arg-type]
    bar.set_label("seconds to the goal")
    bar.outline.set_visible(False)  # type: ignore[union-attr]


def representations(panel: Axes, trace: Trace, options: Maps) -> None:
    _plan(panel, trace)
    _links(panel, trace, FAINT)
    panel.plot(*trace.map.poses[:, :2].T, ".", ms=1.2, color=WALL, zorder=3)
    groups = (
        (trace.map.multiple, "multiple representation", "o", BLUE),
        (trace.map.collisions, "hash collision", "s", PURPLE),
    )
    for found, words, marker, colour in groups:
        for group in found:
            x, y, _ = trace.map.poses[list(group)].T
            panel.plot(x, y, marker + ":", ms=4, mfc="none", color=colour, lw=0.4, mew=0.8, zorder=4,
                       label=f"{words}s" if options.marks else None)  # fmt: skip
    panel.set_xlabel(f"{len(trace.map.multiple)} multiple, {len(trace.map.collisions)} collisions", color=SOFT)


def goal_memory(panel: Axes, trace: Trace, options: Maps) -> None:  # noqa: ARG001
    """The goal memory's temporal map over the pose cells, and its plateaus. IROS 2005 V.D, figure 9 and point C."""
    times, lead = trace.map.goal_times, trace.map.goal_lead
    if times is not None and lead is not None:
        drawn = panel.imshow(
            np.ma.masked_invalid(times.values), origin="lower", extent=_extent(times), cmap="viridis_r", zorder=0
        )
        _seconds(panel, drawn)
        _rings(panel, plateau(times.values, lead.values, APART_M / trace.cell_m))
    _cells_frame(panel, trace)


def plateau(times_s: _Array, lead_s: _Array, apart: float) -> NDArray[np.bool_]:
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


def movements(panel: Axes, trace: Trace, options: Maps) -> None:  # noqa: ARG001
    """The arcs among which a robot on a route chose at one moment, and the one that it drove. ACRA 2006 4.3, figure 4.

    A turn on the spot has no arc, and is left out.
    """
    _plan(panel, trace)
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
