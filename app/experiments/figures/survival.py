"""The share of kidnaps that the robot has recovered from, against the time or the way since, with a Wilson band."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from app.experiments.figures.canvas import grid_lines, panels
from app.experiments.figures.material import Drawn, Material
from app.experiments.figures.palette import CYCLE, ENGINE_COLOUR
from app.experiments.intervals import wilson
from app.experiments.stored_trial import StoredTrial
from app.experiments.words import ENGINE_WORDS
from app.trials.experiment import FigureSpec
from app.trials.figure_options import Survival

_Array = NDArray[np.float64]
_SUFFIX = {"seconds": "s", "metres": "m"}
_STYLES = ("-", "--", ":", "-.")


def draw(spec: FigureSpec, options: Survival, material: Material) -> Drawn:
    figure, axes = panels(1, 1, options.width or 4.6, 3.1)
    panel: Axes = axes[0, 0]
    grid_lines(panel)
    groups = _groups(options, material)
    taken = {words: recoveries(trials, options.against) for words, trials, _, _ in groups}
    known = [times[-1] for times, _ in taken.values() if len(times)]
    end = options.most or 1.05 * max(known, default=1.0)
    for words, _, colour, line in groups:
        times, count = taken[words]
        if count:
            _curve(panel, times, count, end, colour, line, f"{words}, {len(times)} of {count}")
    panel.set(xlim=(0, end), ylim=(0, 1.02), ylabel="recovered", xlabel=f"{options.against} since the kidnap")
    panel.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0, symbol=" %"))
    figure.legend(loc="outside lower center", ncols=1 if len(groups) < 4 else 2)
    says = f"Share of all kidnaps recovered from, against {options.against} since. Bands: 95 % intervals (Wilson)."
    return Drawn(
        spec, figure, material.caption(says, options=options, score=_score_label(material), varied=[options.lines])
    )


def recoveries(trials: list[StoredTrial], against: str) -> tuple[_Array, int]:
    """Sorted times (s) or ways (m) of those kidnaps that were recovered from, and how many kidnaps there were."""
    found: list[float] = []
    count = 0
    for trial in trials:
        kidnaps = round(trial.scores.get("kidnaps", 0.0))
        count += kidnaps
        names = (f"kidnap_{number}_{_SUFFIX[against]}" for number in range(1, kidnaps + 1))
        found += [trial.scores[name] for name in names if name in trial.scores]
    return np.sort(np.array(found, np.float64)), count


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
        for number, label in enumerate(material.labels(options.lines))
        for line, engine in enumerate(engines)
    ]  # fmt: skip


def _curve(panel: Axes, times: _Array, count: int, end: float, colour: str, line: str, words: str) -> None:
    x = np.concatenate([[0.0], times, [max(end, times[-1] if len(times) else end)]])
    done = np.concatenate([np.arange(len(times) + 1), [len(times)]])
    bands = [wilson(int(k), count) for k in done]
    panel.step(x, done / count, where="post", color=colour, ls=line, label=words, zorder=3)
    low, high = [band.low for band in bands], [band.high for band in bands]
    panel.fill_between(x, low, high, step="post", color=colour, alpha=0.14, lw=0, zorder=2)


def _score_label(material: Material) -> str:
    """The label of the score that is the share of kidnaps recovered from, if there is one."""
    return next((s.label for s in material.experiment.scores if s.rate == ("recovered", "kidnaps")), "")
