"""Channels of a run over time, one above the other; thin lines with words mark what happened."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from app.experiments.figures.canvas import (
    BLUE,
    CYCLE,
    ENGINE_COLOUR,
    FAINT,
    INK,
    SOFT,
    VERMILION,
    WIDTH_IN,
    go_by_powers,
    grid_lines,
    panels,
)
from app.experiments.figures.material import Drawn, Material, Pick, trial_gid
from app.protocol.course import Moment
from app.protocol.experiment import FigureSpec
from app.protocol.figure_options import Series
from app.protocol.trace import Trace

_Array = NDArray[np.float64]
_WORDS = {
    "packets": "share of activity",
    "off": "off by (m)",
    "map error": "map error (m)",
    "residual": "residual (m)",
    "views": "views",
    "experiences": "experiences",
    "active experience": "experience",
    "x": "x' (cells)",
    "y": "y' (cells)",
    "heading": "θ' (°)",
}
_SAYS = {
    "packets": "the packets of pose-cell activity, the strongest first",
    "off": "how far the robot is from where it believes itself to be",
    "map error": "root mean square error of the whole map so far",
    "residual": "by how much the map and its links disagree",
    "views": "views recruited so far",
    "experiences": "experiences made so far",
    "active experience": "the active experience",
    "x": "the winning packet's x'",
    "y": "the winning packet's y'",
    "heading": "the winning packet's θ'",
}
_SECONDS_PER_MINUTE = 60.0
_LONG_S = 600.0  # longer runs are drawn in minutes
_MOST_MOMENTS = 14
_FROM_ZERO = {"off", "map error", "residual", "views", "experiences"}
_APART = 0.03  # of the width; words nearer to each other than this would lie over one another


def wanted(options: Series, material: Material) -> list[Pick]:
    """The trials that are shown; each is run again."""
    return material.pick(options, options.each)


def draw(spec: FigureSpec, options: Series, material: Material) -> Drawn:
    picks = wanted(options, material)
    columns = _columns(picks, options)
    rows = len(options.channels)
    width = options.width or (WIDTH_IN if len(columns) > 1 else 5.2)
    figure, axes = panels(rows, len(columns), width, 0.75 + 1.15 * rows, sharex="col", sharey="row")
    for column, together in enumerate(columns):
        traces = [material.trace(pick) for pick in together]
        clock = _Clock(traces, options)
        colours = CYCLE if len(together) > 1 else (ENGINE_COLOUR[together[0].engine],)
        for row, channel in enumerate(options.channels):
            panel: Axes = axes[row, column]
            for number, (pick, trace) in enumerate(zip(together, traces, strict=True)):
                label = pick.column_words if len(together) > 1 else None
                _channel(panel, trace, channel, clock, colours[number % len(colours)], label)
            panel.set_xlim(clock.least, clock.most)
            if options.log and channel != "packets":
                go_by_powers(panel, "y")
            grid_lines(panel)
            if len(together) == 1:
                _mark(panel, traces[0], clock, words=row == 0)
                panel.patch.set_gid(trial_gid(together[0].trial) if row == 0 else None)
            if column == 0:
                panel.set_ylabel(_WORDS[channel])
        room = _words_room(traces[0], clock) if len(together) == 1 else None
        axes[0, column].set_title(_heading(together, picks), pad=room)
        axes[-1, column].set_xlabel(clock.words)
    _finish(figure, axes, options)
    says = "From above: " + "; ".join(_SAYS[channel] for channel in options.channels) + "."
    return Drawn(spec, figure, material.caption(says, picks=picks, options=options))


def _columns(picks: list[Pick], options: Series) -> list[list[Pick]]:
    """The trials of each column of panels: one, or, where lines can be told apart, all levels of an axis by one engine."""
    if options.each in ("engine", "seed") or "packets" in options.channels:
        return [[pick] for pick in picks]
    return [[pick for pick in picks if pick.engine == engine] for engine in dict.fromkeys(p.engine for p in picks)]


def _finish(figure: Figure, axes: NDArray[np.object_], options: Series) -> None:
    figure.align_ylabels(list(axes[:, 0]))
    for panel, channel in zip(axes[:, 0], options.channels, strict=True):
        if channel in _FROM_ZERO and not options.log:
            panel.set_ylim(bottom=0)
    handles, labels = axes[-1, 0].get_legend_handles_labels()
    if labels and options.channels[-1] != "packets":
        figure.legend(handles, labels, loc="outside lower center", ncols=min(6, len(labels)), title=options.each)


class _Clock:
    """Seconds or minutes, from the start or from a moment."""

    def __init__(self, traces: list[Trace], options: Series) -> None:
        begin, end = 0.0, max(float(trace.time_s[-1]) for trace in traces)
        self.zero, self.words = 0.0, "time"
        moments = traces[0].moments if len(traces) == 1 else ()
        since = [m for m in moments if options.after and m.words.startswith(options.after)]
        if since:
            self.zero, self.words = since[0].time_s, f"time after: {since[0].words}"
            begin = self.zero - options.before
        if options.seconds:
            end = min(end, self.zero + options.seconds)
        self.unit = _SECONDS_PER_MINUTE if end - begin > _LONG_S else 1.0
        self.words += " (min)" if self.unit > 1 else " (s)"
        self.least, self.most = (float(self.of(np.array(t))) for t in (begin, max(end, begin + 1.0)))

    def of(self, time_s: _Array) -> _Array:
        return (time_s - self.zero) / self.unit

    def within(self, time_s: float) -> bool:
        return self.least <= float(self.of(np.array(time_s))) <= self.most


def _channel(panel: Axes, trace: Trace, channel: str, clock: _Clock, colour: str, label: str | None) -> None:
    time = clock.of(trace.time_s)
    if channel == "packets":
        for number in reversed(range(trace.mass.shape[1])):
            mass = np.where(trace.mass[:, number] > 0, trace.mass[:, number], np.nan)
            drawn = INK if number == 0 else CYCLE[number]
            panel.plot(time, mass, color=drawn, lw=1.2 if number == 0 else 0.9)
        panel.set_ylim(0, 1.02)
        return
    if channel == "map error":
        panel.plot(clock.of(trace.error_time_s), trace.error_m, color=colour, lw=1.2, label=label)
        return
    drawstyle = "steps-post" if channel == "active experience" else "default"
    panel.plot(time, _VALUES[channel](trace), color=colour, lw=1.0, drawstyle=drawstyle, label=label)


def _turns(trace: Trace) -> _Array:
    """The heading in degrees, with a gap wherever it goes round."""
    degrees = np.degrees(np.mod(trace.cells[:, 2], math.tau))
    degrees[1:][np.abs(np.diff(degrees)) > 180] = np.nan
    return degrees


def _gaps(values: _Array, ring: int) -> _Array:
    """A coordinate of the packet, with a gap wherever it leaves through a face."""
    values = values.copy()
    values[1:][np.abs(np.diff(values)) > ring / 2] = np.nan
    return values


_VALUES: dict[str, Callable[[Trace], _Array]] = {
    "off": lambda t: t.off_m,
    "residual": lambda t: t.residual,
    "views": lambda t: t.views.astype(np.float64),
    "experiences": lambda t: t.experiences.astype(np.float64),
    "active experience": lambda t: t.active.astype(np.float64),
    "x": lambda t: _gaps(t.cells[:, 0], t.cells_shape[2]),
    "y": lambda t: _gaps(t.cells[:, 1], t.cells_shape[1]),
    "heading": _turns,
}


# ------------------------------------------------------------ moments


def shown_moments(trace: Trace, clock: _Clock) -> list[Moment]:
    """What happened in the time that is shown, without the end, and not more than can be read."""
    seen = [m for m in trace.moments if m.words != "the end" and clock.within(m.time_s)]
    if len(seen) > _MOST_MOMENTS:
        seen = [m for m in seen if m.ok is not None or m.words == "kidnapped"][:_MOST_MOMENTS]
    return seen


def _mark(panel: Axes, trace: Trace, clock: _Clock, *, words: bool) -> None:
    span, written = clock.most - clock.least, -math.inf
    for moment in shown_moments(trace, clock):
        at = float(clock.of(np.array(moment.time_s)))
        colour = SOFT if moment.ok is None else BLUE if moment.ok else VERMILION
        panel.axvline(at, color=colour if words or moment.ok is False else FAINT, lw=0.6, zorder=1)
        if words and at - written >= _APART * span:
            written = at
            short = _short(moment)
            panel.annotate(
                short, (at, 1.0), xytext=(0, 2), xycoords=panel.get_xaxis_transform(), textcoords="offset points",
                rotation=90, ha="center", va="bottom", fontsize=6, color=colour, annotation_clip=False,
            ).set_in_layout(False)  # fmt: skip


def _short(moment: Moment) -> str:
    """The words without their numbers, which the page tells."""
    words = moment.words
    for beginning in ("recovered", "not recovered"):
        if words.startswith(beginning):
            return beginning
    if words.endswith("left out"):
        return "point left out"
    name, colon, _ = words.partition(": ")
    if colon:
        return f"{name} {'reached' if moment.ok else 'not reached'}"
    return words.partition(",")[0].replace(" is tagged", " tagged")


def _words_room(trace: Trace, clock: _Clock) -> float:
    """Points between the panel and its heading, so that the words fit between."""
    longest = max((len(_short(m)) for m in shown_moments(trace, clock)), default=0)
    return 8 + 3.4 * longest


def _heading(together: list[Pick], picks: list[Pick]) -> str:
    """The engine, if there are several, and the level or seed, if the column shows one only."""
    words = [together[0].column_words] if len(together) == 1 and together[0].column_words else []
    if len({each.engine for each in picks}) > 1 and together[0].engine_words not in words:
        words.append(together[0].engine_words)
    return ", ".join(words)
