"""The share of trials in which something has happened, against the time or the way until then, with a Wilson band."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from app.experiments.figures.canvas import CYCLE, ENGINE_COLOUR, grid_lines, panels
from app.experiments.figures.material import Drawn, Material, trial_gid
from app.experiments.store import StoredTrial
from app.experiments.summary import ENGINE_WORDS, value_of, wilson
from app.protocol.experiment import FigureSpec, Score
from app.protocol.figure_options import Survival

_SHADE = 0.1  # four bands over each other are still told apart
_STYLES = ("-", "--", ":", "-.")


def draw(spec: FigureSpec, options: Survival, material: Material) -> Drawn:
    figure, axes = panels(1, 1, options.width or 4.6, 3.1)
    panel: Axes = axes[0, 0]
    grid_lines(panel)
    groups = _groups(options, material)
    score = material.score(options.score)
    taken = {words: until(trials, score) for words, trials, _, _ in groups}
    known = [values[-1][0] for values in taken.values() if values]
    end = options.most or 1.05 * max(known, default=1.0)
    for words, trials, colour, line in groups:
        if trials:
            values = taken[words]
            _curve(panel, values, len(trials), end, colour, line, f"{words}: {len(values)} of {len(trials)}")
    unit = options.unit or score.unit
    panel.set(
        xlim=(0, end),
        ylim=(0, 1.02),
        ylabel="share of trials",
        xlabel=f"{score.label} ({unit})" if unit else score.label,
    )
    panel.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0, symbol=" %"))
    figure.legend(loc="outside lower center", ncols=1 if len(groups) < 4 else 2)
    says = f'Share of all trials for which "{score.label}" is at most so much; those that have no such number count as well.'
    caption = material.caption(
        f"{says} Bands: 95 % intervals (Wilson).", options=options, score=options.score, varied=[options.lines]
    )
    return Drawn(spec, figure, caption)


def until(trials: list[StoredTrial], score: Score) -> list[tuple[float, StoredTrial]]:
    """The values of those trials that have one, in order, each with its trial."""
    known = [(value, each) for each in trials if (value := value_of(score, each)) is not None]
    return sorted(known, key=lambda pair: (pair[0], pair[1].id))


def _groups(options: Survival, material: Material) -> list[tuple[str, list[StoredTrial], str, str]]:
    """Words, trials, colour and style of each line."""
    engines = material.engines(options)
    if options.lines == "engine":
        fixed = material.fixed(options)
        return [(ENGINE_WORDS[e], material.of(e, fixed), ENGINE_COLOUR[e], "-") for e in engines]
    fixed, at = material.fixed(options, options.lines), material.axis(options.lines)
    return [
        (f"{label}, {ENGINE_WORDS[engine]}", material.of(engine, {**fixed, at: label}), CYCLE[number % len(CYCLE)],
         _STYLES[line % len(_STYLES)])
        for number, label in enumerate(material.labels(options.lines, options))
        for line, engine in enumerate(engines)
    ]  # fmt: skip


def _curve(
    panel: Axes, known: list[tuple[float, StoredTrial]], count: int, end: float, colour: str, line: str, words: str
) -> None:
    """A step for each trial, with a dot that knows it."""
    values = [value for value, _ in known]
    x = [0.0, *values, max([end, *values[-1:]])]
    done = [*range(len(known) + 1), len(known)]
    bands = [wilson(each, count) for each in done]
    panel.step(x, [band.value for band in bands], where="post", color=colour, ls=line, label=words, zorder=3)
    low, high = [band.low for band in bands], [band.high for band in bands]
    panel.fill_between(x, low, high, step="post", color=colour, alpha=_SHADE, lw=0, zorder=2)
    for number, (value, trial) in enumerate(known, start=1):
        panel.plot(value, number / count, "o", ms=3, color=colour, zorder=4, gid=trial_gid(trial))
