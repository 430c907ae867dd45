"""Each trial a dot, by level and engine; beside them the median, or the rate, with its interval."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import itertools
import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from app.experiments.figures.canvas import ENGINE_COLOUR, FAINT, INK, WIDTH_IN, grid_lines, panels
from app.experiments.figures.curves import finish_score, has, interval_words
from app.experiments.figures.material import Drawn, Material, trial_gid
from app.experiments.store import StoredTrial
from app.experiments.summary import ENGINE_WORDS, value_of
from app.protocol.experiment import FigureSpec, Score
from app.protocol.figure_options import Dots

_HIGH_IN = 3.0
_LEGEND_IN = 1.3  # that a mark of the legend takes, with its words
_SPREAD = 0.26  # of the room of a group: dots lie beside each other so far
_GOLDEN = (
    math.sqrt(5) - 1
) / 2  # its multiples, without their whole parts, fill a stretch evenly, however many there are
_MIDDLE = 0.36  # how far to the right of its dots an interval stands


def draw(spec: FigureSpec, options: Dots, material: Material) -> Drawn:
    engines, score = material.engines(options), material.score(options.score)
    places = _places(options, material)
    count = len(places) * len(engines)
    figure, axes = panels(1, 1, options.width or min(WIDTH_IN, 2.0 + 0.62 * count), _HIGH_IN)
    panel: Axes = axes[0, 0]
    grid_lines(panel)
    drawn = False
    for number, (_, levels) in enumerate(places):
        for at, engine in enumerate(engines):
            _group(panel, score, material, engine, levels, float(number * len(engines) + at))
        for original in material.originals(options.score, levels):
            middle = number * len(engines) + (len(engines) - 1) / 2
            panel.plot(middle, original.value, "D", ms=8, mfc="none", mec=INK, mew=1.1, zorder=6)
            drawn = True
    _ticks(panel, options, [words for words, _ in places], engines)
    finish_score([panel], score, options.log)
    _legend(figure, engines, originals=drawn)
    varied = [options.by] if options.by else [axis.name for axis in material.experiment.axes]
    says = f"{score.label.capitalize()} of each trial" + (f", by {options.by}" if options.by else "") + "."
    caption = material.caption(f"{says} {interval_words(score)}", options=options, score=options.score, varied=varied)
    return Drawn(spec, figure, caption)


def _places(options: Dots, material: Material) -> list[tuple[str, dict[int, str]]]:
    """What stands beside each other: the levels of one axis, or every combination of all; in words, and by place of axis."""
    if options.by:
        fixed, at = material.fixed(options, options.by), material.axis(options.by)
        return [(label, {**fixed, at: label}) for label in material.labels(options.by, options)]
    axes = [axis.name for axis in material.experiment.axes]
    combined = itertools.product(*(material.labels(name, options) for name in axes))
    return [(",\n".join(labels), dict(enumerate(labels))) for labels in combined]


def _group(panel: Axes, score: Score, material: Material, engine: str, levels: dict[int, str], place: float) -> None:
    """The trials of one engine at one level, and their interval to the right of them."""
    for number, trial in enumerate(material.of(engine, levels)):
        value = value_of(score, trial)
        if value is not None:
            dot(panel, place + _beside(number), value, ENGINE_COLOUR[engine], trial)
    cell = material.cell(engine, levels)
    if cell is not None and has(cell, score.label):
        estimate = cell.values[score.label]
        panel.vlines(place + _MIDDLE, estimate.low, estimate.high, color=INK, lw=1.1, zorder=4)
        panel.plot(place + _MIDDLE, estimate.value, "_", ms=8, mew=1.8, color=INK, zorder=5)


def dot(panel: Axes, x: float, y: float, colour: str, trial: StoredTrial) -> None:
    """A dot that knows its trial: the page finds it by this id."""
    panel.plot(x, y, "o", ms=4.2, mfc=colour, mec="none", alpha=0.65, zorder=3, gid=trial_gid(trial))


def _beside(number: int) -> float:
    return (number * _GOLDEN % 1.0 - 0.5) * 2 * _SPREAD


def _ticks(panel: Axes, options: Dots, labels: list[str], engines: list[str]) -> None:
    count = len(engines)
    if len(labels) > 1 or options.by:
        middles = [number * count + (count - 1) / 2 for number in range(len(labels))]
        panel.set_xticks(middles, labels)
        panel.set_xlabel(options.by)
    else:
        panel.set_xticks(range(count), [ENGINE_WORDS[engine] for engine in engines])
    for edge in range(1, len(labels)):
        panel.axvline(edge * count - 0.5, color=FAINT, lw=0.5)
    panel.set_xlim(-0.6, len(labels) * count - 0.3)


def _legend(figure: Figure, engines: list[str], *, originals: bool) -> None:
    def mark(marker: str, face: str, edge: str, size: float, label: str) -> Line2D:
        return Line2D([], [], ls="none", marker=marker, mfc=face, mec=edge, ms=size, label=label)

    marks = [mark("o", ENGINE_COLOUR[engine], "none", 4.5, ENGINE_WORDS[engine]) for engine in engines]
    marks.append(mark("_", INK, INK, 8, "median or rate"))
    if originals:
        marks.append(mark("D", "none", INK, 5.5, "the paper's"))
    fit = int(figure.get_figwidth() / _LEGEND_IN)
    figure.legend(handles=marks, loc="outside lower center", ncols=min(len(marks), max(fit, 2)))
