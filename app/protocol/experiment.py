"""An experiment as a file: world, robot, engines, protocol, axes, scores, figures (docs/experiments.md tells how to write
one); and one trial of it, chosen by engine, levels and seed."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import AfterValidator, Field, model_validator

from app.code_version import code_version
from app.config import Config
from app.config.presets import values_of
from app.protocol.figure_options import check_figures
from app.protocol.files import read_part
from app.protocol.measures import Goals, Kidnaps, Measure, Waited, measure_of, measures_for, number_in
from app.protocol.steps import Line, Part, Step, Text, Values, WorldName
from app.protocol.trial import Trial, text_of
from disk.limits import AXES, CELLS, TRIAL_S, TRIALS
from disk.words import one_line
from web.messages.commands import EngineName, Label

Labelled = Annotated[Label, Field(min_length=1)]
_CATALOGUE = Path(__file__).with_name("experiments")


class EngineSpec(Part):
    """An engine: a preset, and what is set over it."""

    preset: Line = "ours"
    set: Values = {}


class Level(Part):
    """One setting on an axis."""

    label: Labelled
    set: Values = {}
    world: WorldName | None = None  # instead of the experiment's


class Axis(Part):
    """Something that is varied. Every level of each axis meets every level of the others."""

    name: Labelled
    levels: Annotated[list[Level], Field(min_length=1, max_length=CELLS)]

    @model_validator(mode="after")
    def _told_apart(self) -> Axis:
        _require_different([level.label for level in self.levels], f"axis {self.name!r}: two levels are labelled")
        return self


class Score(Part):
    """A column of the table: a number of each trial, or a rate, such as goals reached of all goals."""

    label: Labelled
    score: Line | None = None
    rate: tuple[Line, Line] | None = None
    unit: Label = ""

    @model_validator(mode="after")
    def _one_of(self) -> Score:
        if (self.score is None) == (self.rate is None):
            raise ValueError(f"score {self.label!r}: give either score = NAME or rate = [HOW MANY, OF HOW MANY]")
        return self

    @property
    def readings(self) -> tuple[str, ...]:
        """By their names (measures.py)."""
        return (str(self.score),) if self.rate is None else self.rate


class Original(Part):
    """What the paper found, to be drawn beside ours: the value of a score at these levels."""

    score: Labelled  # its label
    levels: list[Labelled] = []
    value: float
    source: Line


class Claim(Part):
    """What the paper says, as a condition on a score, and by whose rules it holds here. The verdict stands in the file with
    its reason, so that a result that changes it is noticed (`ratslam experiment verdicts`)."""

    says: Line
    score: Labelled  # its label
    levels: list[Labelled] = []  # at these levels the value is ...
    least: float = -math.inf
    most: float = math.inf
    minus: list[Labelled] = []  # ... or its difference from the value at these other levels is ...
    falls_along: Labelled | None = None  # ... or it falls along this axis (trend of a rate)
    agrees: list[EngineName] = []  # by whose rules it holds
    why: Line = ""  # the cause where it does not

    @model_validator(mode="after")
    def _a_condition(self) -> Claim:
        bounded = self.least > -math.inf or self.most < math.inf
        if bounded == (self.falls_along is not None):
            raise ValueError(f"claim {self.says!r}: give least or most, or else falls_along = AXIS")
        return self


class FigureSpec(Part):
    """A figure. What each kind shows, and its options: figure_options.py.

    paper: the figure of the paper that it stands beside, axis by axis.
    """

    kind: Line
    title: Annotated[str, Field(max_length=160), AfterValidator(one_line)] = ""
    paper: Annotated[str, Field(max_length=400), AfterValidator(one_line)] = ""
    options: dict[str, Any] = {}


class Quick(Part):
    """The same experiment made short, to see that it works: so many trials, and this share of every duration."""

    trials: Annotated[int, Field(ge=1)] = 1
    share: Annotated[float, Field(gt=0, le=1)] = 0.05
    levels: Annotated[int, Field(ge=1)] = 1  # of each axis, the first and, if more than one, the last


class Experiment(Part):
    """An experiment. `trials` makes its trials."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,39}$")]
    title: Line
    paper: Line  # and figure, table or section
    asks: Text  # what the experiment asks, in a sentence
    found: Text  # what the paper found, in a sentence
    world: WorldName = "office"
    trials: Annotated[int, Field(ge=1, le=TRIALS)] = 5
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 1  # of the first trial; the next one has the next
    set: Values = {}  # for every engine
    engines: dict[EngineName, EngineSpec]
    axes: Annotated[list[Axis], Field(max_length=AXES)] = []
    protocol: Annotated[list[Step], Field(min_length=1)]
    scores: Annotated[list[Score], Field(min_length=1)]
    original: list[Original] = []
    claims: list[Claim] = []
    figures: Annotated[list[FigureSpec], Field(max_length=100)] = []
    quick: Quick = Quick()
    watch: list[Label] = []  # the levels at which "Watch it" begins; left out: the first of each axis

    @model_validator(mode="before")
    @classmethod
    def _without_measures(cls, tree: object) -> object:
        if isinstance(tree, dict) and "measures" in tree:
            raise ValueError("measures: what the scores need is measured; leave this line out")
        return cast(object, tree)

    @model_validator(mode="after")
    def _consistent(self) -> Experiment:
        if not self.engines:
            raise ValueError("engines: give [engines.paper], [engines.ours] or others")
        _require_different([axis.name for axis in self.axes], "axes: two are named")
        _require_different([score.label for score in self.scores], "scores: two are labelled")
        self._require_room()
        for kind, parts in (("original", self.original), ("claim", self.claims)):
            for part in parts:
                if part.score not in {score.label for score in self.scores}:
                    raise ValueError(f"{kind}: there is no score labelled {part.score!r}")
        for claim in self.claims:
            self._require_levels(claim)
        return self

    def _require_levels(self, claim: Claim) -> None:
        """Of every axis one, unless it is the one along which the score falls: then a claim is about one cell of an engine."""
        for levels in (claim.levels, claim.minus) if claim.minus else (claim.levels,):
            for axis in self.axes:
                known = {level.label for level in axis.levels}
                if len(known & set(levels)) != (0 if axis.name == claim.falls_along else 1):
                    raise ValueError(f"claim {claim.says!r}: give one level of {axis.name}: {', '.join(sorted(known))}")
        if claim.falls_along is not None:
            axes = {axis.name for axis in self.axes}
            rated = next(score for score in self.scores if score.label == claim.score).rate is not None
            if claim.falls_along not in axes or not rated:
                raise ValueError(f"claim {claim.says!r}: falls_along is one of the axes, and its score a rate")

    def _require_room(self) -> None:
        """The product of all axes is known before anything of it is made."""
        cells = math.prod(len(axis.levels) for axis in self.axes)
        if cells > CELLS:
            raise ValueError(f"axes: their levels make {cells:,} cells; there may be {CELLS:,}")
        if (seconds := self.seconds()) > TRIAL_S:
            raise ValueError(f"protocol: a trial takes {seconds:.3g} simulated s; it may take {TRIAL_S:.3g}")

    @property
    def readings(self) -> list[str]:
        """That its scores are, or are rates of."""
        return [name for score in self.scores for name in score.readings]

    def _check_scores(self) -> None:
        visits = sum(step.count_visits() for step in self.protocol)
        kidnaps = sum(step.count_kidnaps() for step in self.protocol)
        most: dict[type[Measure], tuple[str, int]] = {
            Goals: ("visits", visits),
            Kidnaps: ("kidnaps", kidnaps),
            Waited: ("conditions", 0),
        }
        for score in self.scores:
            for name in score.readings:
                try:
                    what, count = most.get(measure_of(name), ("", 1))
                except ValueError as error:
                    raise ValueError(f"score {score.label!r}: {error}") from None
                if count < (number_in(name) or 1):
                    raise ValueError(f"score {score.label!r}: {name!r} is of {what}; the protocol has {count}")

    def _check_watch(self) -> None:
        if self.watch and len(self.watch) != len(self.axes):
            raise ValueError(f"watch: {len(self.watch)} levels; give one of each of the {len(self.axes)} axes")
        for axis, level in zip(self.axes, self.watch, strict=False):
            if level not in (known := [each.label for each in axis.levels]):
                raise ValueError(f"watch: {axis.name} has no level {level!r}; expected one of: {', '.join(known)}")

    def cells(self, quick: bool = False) -> list[tuple[Level, ...]]:
        """Every combination of levels."""
        return list(itertools.product(*(self._levels(axis, quick) for axis in self.axes)))

    def _levels(self, axis: Axis, quick: bool) -> list[Level]:
        if not quick or len(axis.levels) <= self.quick.levels:
            return axis.levels
        return [axis.levels[0], *axis.levels[len(axis.levels) - self.quick.levels + 1 :]][: self.quick.levels]

    def how_many(self, trials: int | None = None, quick: bool = False) -> Counter[str]:
        """The number of trials that `make_trials` makes, by engine."""
        count = (trials or (self.quick.trials if quick else self.trials)) * len(self.cells(quick))
        return Counter(dict.fromkeys(self.engines, count))

    def make_trials(
        self, engines: list[EngineName] | None = None, trials: int | None = None, quick: bool = False
    ) -> list[Trial]:
        """All trials, seed by seed, so that every cell has some as early as possible.

        engines: all by default. trials: in each cell.
        """
        count = trials or (self.quick.trials if quick else self.trials)
        in_all = count * len(self.cells(quick)) * len(engines or self.engines)
        if in_all > TRIALS:
            raise ValueError(
                f"{self.name}: {in_all:,} trials in all cells; there may be {TRIALS:,}, so give --trials N"
            )
        protocol = tuple(step.shortened(self.quick.share) if quick else step for step in self.protocol)
        measures = tuple(kind.__name__ for kind in measures_for(self.readings) if not kind.always)
        texts = {world: self._text_of(world) for world in {self.world_of(cell) for cell in self.cells(quick)}}
        return [
            Trial(
                self.name, engine, tuple(level.label for level in cell), self.seed + number, self.world_of(cell),
                texts[self.world_of(cell)], self.values(engine, cell), protocol, measures, code_version(), quick,
            )
            for number in range(count)
            for cell in self.cells(quick)
            for engine in engines or list(self.engines)
        ]  # fmt: skip

    def world_of(self, cell: tuple[Level, ...]) -> str:
        """The world of a cell: that of a level, or else the experiment's."""
        return next((level.world for level in cell if level.world is not None), self.world)

    def _text_of(self, world: str) -> str:
        from sim2d.importers import open_world

        return text_of(open_world(world, robot_radius_m=Config().with_values(self.set).robot.robot_radius_m))

    def values(self, engine: EngineName, cell: tuple[Level, ...]) -> Values:
        """The parameters of an engine in a cell; ValueError if the experiment has no such engine."""
        if engine not in self.engines:
            raise ValueError(f"{self.name} has no engine {engine!r}; it has: {', '.join(self.engines)}")
        spec = self.engines[engine]
        values: Values = {**values_of(spec.preset), **self.set, **spec.set}
        for level in cell:
            values.update(level.set)
        return values

    def check(self) -> None:
        """ValueError says what does not fit together: a parameter, a place, a world, a score, a figure."""
        check_figures(self)
        self._check_scores()
        self._check_watch()
        self.make_trials()
        for trial in self.make_trials(trials=1):
            trial.begin()

    def seconds(self, quick: bool = False) -> float:
        """About how long one trial is, in simulated seconds."""
        share = self.quick.share if quick else 1.0
        return sum((step.shortened(share) if quick else step).about_s() for step in self.protocol)


def _require_different(labels: list[str], what: str) -> None:
    twice = next((label for number, label in enumerate(labels) if label in labels[:number]), None)
    if twice is not None:
        raise ValueError(f"{what} {twice!r}")


# ------------------------------------------------------------ files


def read_experiment(path: Path) -> Experiment:
    """An experiment from its file. ValueError names the file, the line, and what is wrong there."""
    return read_part(path, Experiment)


def names() -> list[str]:
    """The experiments that come with the program, in the order in which they are to be read."""
    return [experiment.name for experiment in catalogue()]


def catalogue() -> Iterator[Experiment]:
    """The experiments that come with the program, in the order of the papers."""
    for path in sorted(_CATALOGUE.glob("*.toml")):
        yield read_experiment(path)


def find_experiment(name: str) -> Experiment:
    """An experiment by name, or from a file. ValueError lists the names there are."""
    if name.endswith(".toml"):
        return read_experiment(Path(name))
    for path in _CATALOGUE.glob(f"*-{name}.toml"):
        experiment = read_experiment(path)
        if experiment.name == name:
            return experiment
    raise ValueError(
        f"unknown experiment {name!r}; expected a file that ends in .toml, or one of: {', '.join(names())}"
    )


OURS: EngineName = "ours"


def chosen_trial(
    experiment: Experiment,
    engine: EngineName | None = None,
    levels: Sequence[str] | None = None,
    seed: int | None = None,
    quick: bool = False,
) -> Trial:
    """The trial; what is left out is as the experiment begins. ValueError names an engine or level that there is not."""
    engine = engine or (OURS if OURS in experiment.engines else next(iter(experiment.engines)))
    wanted = first_levels(experiment) if levels is None else tuple(levels)
    check_levels(experiment, wanted)
    axes = [
        axis.model_copy(update={"levels": [each for each in axis.levels if each.label == label]})
        for axis, label in zip(experiment.axes, wanted, strict=True)
    ]
    found = experiment.model_copy(update={"axes": axes}).make_trials([engine], 1)[0]
    if quick:
        steps = tuple(step.shortened(experiment.quick.share) for step in found.protocol)
        found = replace(found, protocol=steps, quick=True)
    return found if seed is None else replace(found, seed=seed)


def first_levels(experiment: Experiment) -> tuple[str, ...]:
    """Those at which the experiment is watched if nobody says otherwise: of each axis, by label."""
    return tuple(experiment.watch) or tuple(axis.levels[0].label for axis in experiment.axes)


def check_levels(experiment: Experiment, levels: Sequence[str]) -> None:
    """ValueError names a level that an axis does not have, or says how many there must be."""
    axes = experiment.axes
    if len(levels) != len(axes):
        names = ", ".join(axis.name for axis in axes) or "it has no axes"
        raise ValueError(f"{experiment.name} takes {len(axes)} levels ({names}), got {len(levels)}")
    for axis, level in zip(axes, levels, strict=True):
        known = [each.label for each in axis.levels]
        if level not in known:
            raise ValueError(f"{axis.name} has no level {level!r}; expected one of: {', '.join(known)}")
