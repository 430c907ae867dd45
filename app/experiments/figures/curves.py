"""A score along an axis: a line for each level of another axis, a panel for each engine, the paper's values as open diamonds."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from app.experiments.figures.canvas import CYCLE, INK, MARKERS, WIDTH_IN, go_by_powers, grid_lines, panels
from app.experiments.figures.material import Drawn, Material
from app.experiments.summary import ENGINE_WORDS, CellSummary
from app.protocol.experiment import FigureSpec, Score
from app.protocol.figure_options import Curves

_HIGH_IN = 2.9
_ROW_IN, _AROUND_IN = (
    0.24,
    1.3,
)  # a level, and what is above and below all of them, where levels lie one below the other
_LONG = 14  # characters; if a label is longer, levels lie one below the other
_ASIDE, _BELOW = 0.055, 0.13  # of a step: lines stand so far beside each other that their intervals can be told apart
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


@dataclass(frozen=True, slots=True)
class _Chart:
    """What all panels share. lying: the levels lie one below the other, and the score goes to the right."""

    options: Curves
    material: Material
    labels: list[str]
    places: list[float]
    lines: list[str]
    lying: bool

    def levels(self, line: str) -> list[dict[int, str]]:
        """The levels of the points of a line, by place of their axis."""
        options, material = self.options, self.material
        fixed, along = material.fixed(options, options.along, options.lines), material.axis(options.along)
        own = {material.axis(options.lines): line} if line else {}
        return [{**fixed, **own, along: label} for label in self.labels]

    def beside(self, number: int) -> NDArray[np.float64]:
        """Where the points of a line stand along the axis."""
        places = np.array(self.places)
        if self.options.spacing == "log":
            return places
        step = float(np.min(np.diff(places))) if len(places) > 1 else 1.0
        return places + (number - (len(self.lines) - 1) / 2) * (_BELOW if self.lying else _ASIDE) * step

    def turned(self, along: Any, score: Any) -> tuple[Any, Any]:
        return (score, along) if self.lying else (along, score)


def draw(spec: FigureSpec, options: Curves, material: Material) -> Drawn:
    engines, score = material.engines(options), material.score(options.score)
    labels = material.labels(options.along, options)
    lines = material.labels(options.lines, options) if options.lines else [""]
    lying = options.spacing == "even" and max(map(len, labels)) > _LONG
    chart = _Chart(options, material, labels, positions(labels, options.spacing), lines, lying)
    width = options.width or (WIDTH_IN if len(engines) > 1 or lying else 4.2)
    height = _AROUND_IN + _ROW_IN * len(labels) * max(1.0, 0.4 * len(lines)) if lying else _HIGH_IN
    figure, axes = panels(1, len(engines), width, height, sharey="row", sharex="row" if lying else False)
    for panel, engine in zip(axes[0], engines, strict=True):
        for number, line in enumerate(lines):
            _line(panel, chart, engine, line, number)
        _look(panel, chart)
        panel.set_title(ENGINE_WORDS[engine])
    finish_score(list(axes[0]), score, options.log, lying=lying)
    _legend(figure, axes[0, 0], chart)
    by = f", by {options.lines}" if options.lines else ""
    caption = material.caption(
        f"{score.label.capitalize()} against {options.along}{by}. {interval_words(score)}",
        options=options, score=options.score, varied=[options.along, options.lines],
    )  # fmt: skip
    return Drawn(spec, figure, caption)


def positions(labels: list[str], spacing: str) -> list[float]:
    """Where levels stand along an axis: side by side, or at the first number in each label."""
    if spacing == "even":
        return [float(place) for place in range(len(labels))]
    found = [_NUMBER.search(label) for label in labels]
    missing = [label for label, number in zip(labels, found, strict=True) if number is None]
    if missing:
        raise ValueError(
            f"spacing = {spacing!r}: there is no number in the level {missing[0]!r}; expected spacing = 'even'"
        )
    return [float(number.group()) for number in found if number is not None]


def _line(panel: Axes, chart: _Chart, engine: str, line: str, number: int) -> None:
    """One line with its intervals, then the paper's values for it."""
    material, score = chart.material, chart.options.score
    colour, marker = CYCLE[number % len(CYCLE)], MARKERS[number % len(MARKERS)]
    levels, places = chart.levels(line), chart.beside(number)
    cells = [material.cell(engine, each) for each in levels]
    drawn = [(place, cell) for place, cell in zip(places, cells, strict=True) if cell is not None and has(cell, score)]
    values = [cell.values[score].value for _, cell in drawn]
    low, high = ([getattr(cell.values[score], end) for _, cell in drawn] for end in ("low", "high"))
    along = [place for place, _ in drawn]
    if not chart.lying:
        panel.plot(along, values, "-", color=colour, zorder=3)
    (panel.hlines if chart.lying else panel.vlines)(along, low, high, color=colour, lw=1.0, alpha=0.75, zorder=2)
    for (place, cell), value in zip(drawn, values, strict=True):
        x, y = chart.turned(place, value)
        panel.plot(x, y, marker, color=colour, zorder=4, gid=f"cell-{material.cells.index(cell)}")
    panel.plot([], [], marker + ("" if chart.lying else "-"), color=colour, label=line or None)
    for place, each in zip(places, levels, strict=True):
        for original in material.originals(score, each):
            x, y = chart.turned(place, original.value)
            panel.plot(x, y, "D", ms=7.5, mfc="none", mec=colour if line else INK, mew=1.1, zorder=4)


def has(cell: CellSummary, score: str) -> bool:
    return score in cell.values and cell.values[score].n > 0


def _look(panel: Axes, chart: _Chart) -> None:
    if chart.lying:
        grid_lines(panel, "both")
        panel.set_yticks(chart.places, chart.labels)
        panel.set_ylim(len(chart.places) - 0.5, -0.5)
        return
    grid_lines(panel)
    words, unit = _without_unit(chart.labels)
    panel.set_xlabel(f"{chart.options.along} ({unit})" if unit else chart.options.along)
    if chart.options.spacing == "log":
        go_by_powers(panel, "x")
    panel.set_xticks(chart.places, words)
    panel.minorticks_off()
    if chart.options.spacing == "even":
        panel.set_xlim(-0.5, len(chart.places) - 0.5)


def finish_score(axes: list[Axes], score: Score, log: bool, *, lying: bool = False) -> None:
    """The axis of a score: rates in per cent from 0 to 100, all else from 0, unless it is logarithmic."""
    words = f"{score.label} ({score.unit})" if score.unit else score.label
    first = axes[0]
    for each in axes if lying else [first]:
        (each.set_xlabel if lying else each.set_ylabel)(words)
    axis = first.xaxis if lying else first.yaxis
    limits, set_limits = (first.get_xlim(), first.set_xlim) if lying else (first.get_ylim(), first.set_ylim)
    if score.rate is not None:
        set_limits(-0.03, 1.05)
        axis.set_major_formatter(PercentFormatter(1.0, decimals=0, symbol=" %"))
    elif log:
        go_by_powers(first, "x" if lying else "y")
    elif limits[0] > -0.1 * limits[1]:
        set_limits(0, limits[1])


def interval_words(score: Score) -> str:
    return "Bars: 95 % intervals (Wilson)." if score.rate is not None else "Medians; bars: 95 % intervals (bootstrap)."


def _legend(figure: Figure, panel: Axes, chart: _Chart) -> None:
    handles, labels = panel.get_legend_handles_labels()
    if any(original.score == chart.options.score for original in chart.material.experiment.original):
        handles.append(Line2D([], [], ls="none", marker="D", ms=6, mfc="none", mec=INK, mew=1.1))
        labels.append("the paper's")
    if labels:
        figure.legend(
            handles, labels, loc="outside lower center", ncols=min(6, len(labels)), title=chart.options.lines or None,
            title_fontsize=7.5,
        )  # fmt: skip


def _without_unit(labels: list[str]) -> tuple[list[str], str]:
    """Labels without the unit that ends each of them, which then stands beside the axis."""
    units = {label.partition(" ")[2] for label in labels}
    unit = units.pop() if len(units) == 1 else ""
    numbers = all(_NUMBER.fullmatch(label.partition(" ")[0]) for label in labels)
    return ([label.partition(" ")[0] for label in labels], unit) if unit and numbers else (labels, "")
