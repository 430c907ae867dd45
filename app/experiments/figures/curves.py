"""A score along an axis: a line for each level of another axis, a panel for each engine, the paper's values as open diamonds."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from app.experiments.figures.canvas import WIDTH_IN, grid_lines, panels
from app.experiments.figures.material import Drawn, Material
from app.experiments.figures.palette import CYCLE, INK, MARKERS
from app.experiments.summary import CellSummary
from app.experiments.words import ENGINE_WORDS
from app.trials.experiment import FigureSpec, Score
from app.trials.figure_options import Curves

_HIGH_IN = 2.9
_ASIDE = 0.055  # lines stand so far beside each other that their intervals can be told apart, of a step
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def draw(spec: FigureSpec, options: Curves, material: Material) -> Drawn:
    engines, score = material.engines(options), material.score(options.score)
    labels = material.labels(options.along)
    lines = material.labels(options.lines) if options.lines else [""]
    places = positions(labels, options.spacing)
    width = options.width or (WIDTH_IN if len(engines) > 1 else 4.2)
    figure, axes = panels(1, len(engines), width, _HIGH_IN, sharey="row")
    for panel, engine in zip(axes[0], engines, strict=True):
        for number, line in enumerate(lines):
            aside = (number - (len(lines) - 1) / 2) * _ASIDE * _step(places)
            _line(panel, options, material, engine, line, number, np.array(places) + aside)
        _look(panel, options, places, labels)
        panel.set_title(ENGINE_WORDS[engine])
        panel.set_xlabel(options.along)
    finish_score(list(axes[0]), score, options.log)
    _legend(figure, axes[0, 0], options, material)
    says = (
        f"{score.label.capitalize()} against {options.along}" + (f", by {options.lines}" if options.lines else "") + "."
    )
    caption = material.caption(
        f"{says} {interval_words(score)}", options=options, score=options.score, varied=[options.along, options.lines]
    )
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


def _step(places: list[float]) -> float:
    return float(np.min(np.diff(places))) if len(places) > 1 else 1.0


def _line(
    panel: Axes, options: Curves, material: Material, engine: str, line: str, number: int, places: np.ndarray
) -> None:
    """One line with its intervals, then the paper's values for it."""
    colour, marker = CYCLE[number % len(CYCLE)], MARKERS[number % len(MARKERS)]
    fixed = material.fixed(options, options.along, options.lines)
    along = material.axis(options.along)
    levels = [
        {**fixed, along: label, **({material.axis(options.lines): line} if line else {})}
        for label in material.labels(options.along)
    ]
    if options.spacing == "log":
        places = np.array(positions(material.labels(options.along), "log"))
    cells = [material.cell(engine, each) for each in levels]
    drawn = [(place, cell) for place, cell in zip(places, cells, strict=True) if has(cell, options.score)]
    x = [place for place, _ in drawn]
    estimates = [cell.values[options.score] for _, cell in drawn if cell is not None]
    y = [e.value for e in estimates]
    panel.plot(x, y, "-", color=colour, zorder=3)
    for (place, cell), value in zip(drawn, y, strict=True):
        gid = f"cell-{material.cells.index(cell)}" if cell is not None else None
        panel.plot(place, value, marker, color=colour, zorder=4, gid=gid)
    panel.plot([], [], marker + "-", color=colour, label=line or None)
    panel.vlines(x, [e.low for e in estimates], [e.high for e in estimates], color=colour, lw=1.0, alpha=0.75, zorder=2)
    for place, each in zip(places, levels, strict=True):
        for original in material.originals(options.score, each):
            panel.plot(place, original.value, "D", ms=7.5, mfc="none", mec=colour if line else INK, mew=1.1, zorder=4)


def has(cell: CellSummary | None, score: str) -> bool:
    return cell is not None and score in cell.values and cell.values[score].n > 0


def _look(panel: Axes, options: Curves, places: list[float], labels: list[str]) -> None:
    grid_lines(panel)
    if options.spacing == "log":
        panel.set_xscale("log")
    panel.set_xticks(places, labels)
    panel.minorticks_off()
    if options.spacing == "even":
        panel.set_xlim(-0.5, len(places) - 0.5)


def finish_score(axes: list[Axes], score: Score, log: bool) -> None:
    """The axis of a score: rates in per cent from 0 to 100, all else from 0, unless it is logarithmic."""
    first = axes[0]
    first.set_ylabel(f"{score.label} ({score.unit})" if score.unit else score.label)
    if score.rate is not None:
        first.set_ylim(-0.03, 1.05)
        first.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0, symbol=" %"))
    elif log:
        first.set_yscale("log")
    elif first.get_ylim()[0] >= 0 or first.get_ylim()[0] > -0.1 * first.get_ylim()[1]:
        first.set_ylim(bottom=0)


def interval_words(score: Score) -> str:
    return "Bars: 95 % intervals (Wilson)." if score.rate is not None else "Medians; bars: 95 % intervals (bootstrap)."


def _legend(figure: Figure, panel: Axes, options: Curves, material: Material) -> None:
    handles, labels = panel.get_legend_handles_labels()
    if any(original.score == options.score for original in material.experiment.original):
        handles.append(Line2D([], [], ls="none", marker="D", ms=6, mfc="none", mec=INK, mew=1.1))
        labels.append("the paper's")
    if not labels:
        return
    figure.legend(
        handles, labels, loc="outside lower center", ncols=len(labels),
        title=options.lines or None, title_fontsize=7.5,
    )  # fmt: skip
