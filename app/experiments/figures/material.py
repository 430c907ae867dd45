"""What figures are made of: an experiment, its trials with their scores, the summary of each cell, and some trials run again."""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass, field

from matplotlib.figure import Figure

from app.code_version import code_version
from app.experiments.store import StoredTrial
from app.experiments.summary import ENGINE_WORDS, CellSummary, summarise, value_of, words_of
from app.protocol.experiment import Experiment, FigureSpec, Original, Score
from app.protocol.figure_options import OneTrial, Options
from app.protocol.trace import Trace


@dataclass(frozen=True, slots=True)
class Pick:
    """A trial that a panel shows."""

    row: int
    column: int
    engine: str
    column_words: str
    trial: StoredTrial

    @property
    def engine_words(self) -> str:
        return ENGINE_WORDS[self.engine]


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """A figure with its caption."""

    spec: FigureSpec
    figure: Figure
    caption: str


@dataclass(slots=True)
class Material:
    """Trials and summaries in the order of the experiment's cells. traces: by trial id."""

    experiment: Experiment
    trials: list[StoredTrial]
    traces: dict[str, Trace] = field(default_factory=dict[str, Trace])
    cells: list[CellSummary] = field(init=False)

    def __post_init__(self) -> None:
        self.trials = [trial for trial in self.trials if not trial.error]
        self.cells = summarise(self.experiment, self.trials)

    # ------------------------------------------------------------ engines and levels

    def engines(self, options: Options) -> list[str]:
        """The engines that a figure shows, of those that have trials."""
        wanted = options.engines or list(self.experiment.engines)
        there = {trial.engine for trial in self.trials}
        return [engine for engine in self.experiment.engines if engine in wanted and engine in there]

    def axis(self, name: str) -> int:
        """The place of an axis among the axes."""
        return [axis.name for axis in self.experiment.axes].index(name)

    def labels(self, name: str, options: Options | None = None) -> list[str]:
        """The levels of an axis that have trials, in order; if some are in `at`, only those."""
        at = self.axis(name)
        there = {trial.levels[at] for trial in self.trials}
        labels = [level.label for level in self.experiment.axes[at].levels if level.label in there]
        chosen = [label for label in labels if options is not None and label in options.at]
        return chosen or labels

    def fixed(self, options: Options, *varied: str) -> dict[int, str]:
        """The levels of the axes that a figure does not vary: those of `at`, else the first."""
        return {
            number: self.labels(axis.name, options)[0]
            for number, axis in enumerate(self.experiment.axes)
            if axis.name not in varied and self.labels(axis.name)
        }

    def of(self, engine: str, levels: dict[int, str]) -> list[StoredTrial]:
        """The trials of an engine at these levels, by place of their axis; in the order of their seeds."""
        chosen = [t for t in self.trials if t.engine == engine and all(t.levels[a] == b for a, b in levels.items())]
        return sorted(chosen, key=lambda trial: trial.seed)

    def cell(self, engine: str, levels: dict[int, str]) -> CellSummary | None:
        """The summary of one cell, if it has trials."""
        for cell in self.cells:
            if cell.engine == engine and all(cell.levels[a] == b for a, b in levels.items()):
                return cell
        return None

    def score(self, label: str) -> Score:
        return next(score for score in self.experiment.scores if score.label == label)

    def originals(self, label: str, levels: dict[int, str]) -> list[Original]:
        """What the paper found of a score, so far as it is for these levels."""
        return [o for o in self.experiment.original if o.score == label and set(levels.values()) >= set(o.levels)]

    # ------------------------------------------------------------ single trials

    def pick(self, options: OneTrial, each: str) -> list[Pick]:
        """The trials that panels show: a row for each engine, a column for each level, seed or engine."""
        engines = self.engines(options)
        if each == "engine":
            fixed = self.fixed(options)
            return [
                Pick(0, column, engine, ENGINE_WORDS[engine], self._one(options, self.of(engine, fixed)))
                for column, engine in enumerate(engines)
            ]
        picks: list[Pick] = []
        for row, engine in enumerate(engines):
            if each == "seed":
                several = self.of(engine, self.fixed(options))[: options.most]
                picks += [Pick(row, column, engine, f"seed {t.seed}", t) for column, t in enumerate(several)]
                continue
            fixed, at = self.fixed(options, each), self.axis(each)
            for column, label in enumerate(self.labels(each, options)):
                found = self.of(engine, {**fixed, at: label})
                if found:
                    picks.append(Pick(row, column, engine, label, self._one(options, found)))
        return picks

    def trace(self, pick: Pick) -> Trace:
        return self.traces[pick.trial.id]

    def _one(self, options: OneTrial, trials: list[StoredTrial]) -> StoredTrial:
        if options.pick == "first":
            return trials[0]
        score = self.score(options.score)
        known = [(value, trial) for trial in trials if (value := value_of(score, trial)) is not None]
        if not known:
            return trials[0]
        middle = statistics.median_low(value for value, _ in known)
        return next(trial for value, trial in known if value == middle)

    # ------------------------------------------------------------ words

    def caption(
        self,
        says: str,
        *,
        options: Options,
        picks: list[Pick] | None = None,
        score: str = "",
        varied: Sequence[str] = (),
    ) -> str:
        """The paper's figure, what is drawn, the seeds, how many, the version, and the original's numbers.

        picks: of a figure of single trials; varied: the axes along which a figure of scores goes.
        """
        parts = [f"{self.experiment.paper}.", says]
        parts += self._fixed_words(picks) if picks else self._at_words(self.fixed(options, *varied))
        parts.append(f"{_seeds([p.trial for p in picks] if picks else self.trials)};")
        if picks is None:
            parts.append(f"{self._count()};")
        elif isinstance(options, OneTrial):
            parts.append(
                "each the first seed of its cell;"
                if options.pick == "first"
                else f"each the median by {options.score};"
            )
        parts.append(f"version {self.trials[0].version or code_version()}.")
        found = [o for o in self.experiment.original if o.score == score]
        if found:
            parts.append("Original: " + "; ".join(self._original(o) for o in found) + ".")
        return " ".join(parts)

    def _fixed_words(self, picks: list[Pick]) -> list[str]:
        trials, words = [pick.trial for pick in picks], list[str]()
        for number, axis in enumerate(self.experiment.axes):
            shown = {trial.levels[number] for trial in trials}
            if len(shown) == 1 and len(axis.levels) > 1:
                words.append(f"{axis.name} {shown.pop()}")
        return [f"At {', '.join(words)}."] if words else []

    def _at_words(self, levels: dict[int, str]) -> list[str]:
        words = [f"{self.experiment.axes[at].name} {label}" for at, label in levels.items()]
        return [f"At {', '.join(words)}."] if words else []

    def _count(self) -> str:
        counts = sorted({cell.n for cell in self.cells})
        if counts[0] == counts[-1]:
            return f"n = {counts[0]} in each cell"
        return f"n = {counts[0]} to {counts[-1]} in a cell"

    def _original(self, original: Original) -> str:
        where = f" at {', '.join(original.levels)}" if original.levels else ""
        return f"{words_of(self.score(original.score), original.value)}{where} ({original.source})"


def trial_gid(trial: StoredTrial) -> str:
    """The id of what stands for one trial in a figure: the page finds it by this."""
    return f"trial-{trial.id}"


def _seeds(trials: list[StoredTrial]) -> str:
    seeds = sorted({trial.seed for trial in trials})
    if len(seeds) == 1:
        return f"Seed {seeds[0]}"
    if seeds[-1] - seeds[0] == len(seeds) - 1:
        return f"Seeds {seeds[0]} to {seeds[-1]}"
    return f"Seeds {', '.join(map(str, seeds))}"
