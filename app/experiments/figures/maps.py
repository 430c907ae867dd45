"""Small multiples of what trials have left behind: maps over the plan, paths, pose cells, occupancy."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.experiments.figures import map_panels
from app.experiments.figures.canvas import SOFT, WIDTH_IN, frame, panels
from app.experiments.figures.material import Drawn, Material, Pick, trial_gid
from app.experiments.summary import ENGINE_WORDS
from app.protocol.experiment import FigureSpec
from app.protocol.figure_options import Maps
from app.protocol.trace import APART_M, Trace

_SHOW = {
    "experience map": map_panels.experience_map,
    "pose cells": map_panels.pose_cells,
    "path": map_panels.paths,
    "occupancy": map_panels.occupancy,
    "map grid": map_panels.map_grid,
    "representations": map_panels.representations,
    "temporal map": map_panels.temporal_map,
    "goal memory": map_panels.goal_memory,
    "movements": map_panels.movements,
}
_IN_CELLS = {"pose cells", "occupancy", "goal memory"}
_SAYS = {
    "experience map": "Experiences (dots) and links (lines) at the end, laid over the plan",
    "pose cells": "The winning packet's way through the pose cells, whose faces are joined; a snap goes from S to F",
    "path": "The true path, coloured while the robot was sent to a goal; the path as the map tells it at the end; and odometry"
    " alone, over the plan",
    "map grid": "Where the sonars met something, bent with the map and laid over the plan",
    "occupancy": "Where the sonars met something, in the pose cells' own frame, as the papers draw it",
    "representations": "Places that several states of the pose cells stand for, and states that stand for several places",
    "temporal map": "Seconds from each experience to the goal, over the links of the experience map",
    "goal memory": "Seconds from each pose cell to the goal, as the goal memory has learnt them. On a plateau two ways"
    f" that come {APART_M:g} m apart take times that differ by less than a tenth of the longest time, and no cell"
    f" within {APART_M:g} m is much farther",
    "movements": "The arcs that the robot tried at one moment on a route, that at which the number of free arcs times the number"
    " of barred ones was largest. The route lies as the map has it about the robot; where echoes are in the way, the robot"
    " steers towards a point beside it",
}
_HEADING_IN, _BETWEEN_IN, _LEGEND_IN = 0.25, 0.1, 0.3  # room over the first row, under each, and under the last
_BELOW_IN = 0.2  # under a panel that tells how large what it shows is
_WORDS_BELOW = {*_IN_CELLS, "movements"}
_BAR = 0.8  # a colour bar leaves this share of the width to its panel
_WITH_BAR = {"temporal map", "goal memory"}
_MOST_HIGH_IN = 8.5
_LONG = 0.5  # plans that are less high than this, for their width
_BEYOND = 0.3  # of the office's size: where odometry leads farther out, it is cut off


def wanted(options: Maps, material: Material) -> list[Pick]:
    """The trials that are shown, row by row; each is run again."""
    return material.pick(options, options.each)


def draw(spec: FigureSpec, options: Maps, material: Material) -> Drawn:
    picks = _one_below_the_other(wanted(options, material), options, material)
    rows, columns = max(p.row for p in picks) + 1, max(p.column for p in picks) + 1
    figure, axes = _figure(options, _shape(options, material, picks), rows, columns)
    for pick in picks:
        panel: Axes = axes[pick.row, pick.column]
        trace = material.trace(pick)
        _SHOW[options.show](panel, trace, options)
        if pick.row == 0 or options.each == "engine":
            panel.set_title(pick.column_words)
        panel.patch.set_gid(trial_gid(pick.trial))
        if pick.column == 0 and rows > 1 and options.each != "engine":
            panel.set_ylabel(ENGINE_WORDS[pick.engine], color=SOFT)
        frame(panel)
    if options.show == "path":
        x1, y1, x2, y2 = _stretch([material.trace(pick) for pick in picks])
        for pick in picks:
            axes[pick.row, pick.column].set(xlim=(x1, x2), ylim=(y1, y2))
    _legend(figure, axes)
    return Drawn(spec, figure, material.caption(_SAYS[options.show] + ".", picks=picks, options=options))


def _one_below_the_other(picks: list[Pick], options: Maps, material: Material) -> list[Pick]:
    """Engines stand side by side, unless the plan is so long that each needs the whole width."""
    if options.each != "engine" or options.show in _IN_CELLS or _shape(options, material, picks) > _LONG:
        return picks
    return [replace(pick, row=pick.column, column=0) for pick in picks]


def _shape(options: Maps, material: Material, picks: list[Pick]) -> float:
    """How high panels are for their width."""
    traces = [material.trace(pick) for pick in picks]
    if options.show == "movements":
        return 1.0
    if options.show in _IN_CELLS:
        return max(t.cells_shape[1] / t.cells_shape[2] for t in traces)
    if options.show == "path":
        x1, y1, x2, y2 = _stretch(traces)
        return (y2 - y1) / (x2 - x1)
    x1, y1, x2, y2 = (np.array([t.plan.bounds for t in traces])).T
    return float(np.max((y2 - y1) / (x2 - x1)))


def _figure(options: Maps, shape: float, rows: int, columns: int) -> tuple[Figure, np.ndarray]:
    """A figure as high as its panels need to be for what they show, which is as wide as it is."""
    most = {1: 4.6 if shape > _LONG else 6.4, 2: 6.4}.get(columns, WIDTH_IN)
    width = options.width or most
    panel = width / columns * shape * (_BAR if options.show in _WITH_BAR else 1.0)
    below = _BETWEEN_IN + (_BELOW_IN if options.show in _WORDS_BELOW else 0.0) + _BETWEEN_IN
    height = rows * (panel + below) + _HEADING_IN + _LEGEND_IN
    if height > _MOST_HIGH_IN:
        width, height = width * _MOST_HIGH_IN / height, _MOST_HIGH_IN
    return panels(rows, columns, width, height)


def _stretch(traces: list[Trace]) -> tuple[float, float, float, float]:
    """Of the offices and what lies round them, as much as all the paths need: x, y of one corner and the other, m."""
    bounds = np.array([trace.plan.bounds for trace in traces])
    (x1, y1), (x2, y2) = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
    beyond = _BEYOND * max(x2 - x1, y2 - y1)
    paths = np.concatenate([trace.odometry_path for trace in traces])
    low = np.clip(paths.min(axis=0), (x1 - beyond, y1 - beyond), (x1, y1)) - map_panels.MARGIN_M
    high = np.clip(paths.max(axis=0), (x2, y2), (x2 + beyond, y2 + beyond)) + map_panels.MARGIN_M
    return (*low.tolist(), *high.tolist())


def _legend(figure: Figure, axes: np.ndarray) -> None:
    """One legend for all panels, below them."""
    known = {}
    for panel in axes.flat:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            known.setdefault(label, handle)
    for panel in axes.flat:
        if not panel.has_data():
            panel.set_axis_off()
    if known:
        figure.legend(
            known.values(), known.keys(), loc="outside lower center", ncols=min(3 + (axes.shape[1] > 2) * 2, len(known))
        )
