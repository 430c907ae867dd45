"""The kinds of figures and the options of each, as an experiment's file gives them. docs/experiments.md tells how to use them.

They are checked here, where an experiment is read, and drawn in experiments/figures, which alone knows matplotlib.
"""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from web.messages.commands import EngineName

if TYPE_CHECKING:
    from app.protocol.experiment import Experiment, FigureSpec

Shown = Literal[
    "experience map", "pose cells", "path", "occupancy", "map grid", "representations", "temporal map", "goal memory",
    "movements",
]  # fmt: skip
Channel = Literal[
    "packets", "off", "map error", "residual", "views", "experiences", "active experience", "x", "y", "heading"
]  # fmt: skip
Each = str  # an axis by name, "engine" or "seed"


class Options(BaseModel):
    """What every kind takes.

    at: levels, by label. Of an axis that a figure does not vary, the one that is shown, else the first; of one that it
    varies, those that are shown, else all.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    at: list[str] = []
    engines: list[EngineName] = []  # all of the experiment's, if none is named
    width: Annotated[float, Field(gt=0, le=30)] = 0.0  # of the figure, inches; 0: as the kind has it


class Curves(Options):
    """A score along an axis, a line for each level of another, a panel for each engine."""

    score: str
    along: str
    lines: str = ""
    spacing: Literal["even", "linear", "log"] = "even"  # "even": level beside level; else by the numbers in the labels
    log: bool = False  # of the score


class Dots(Options):
    """Each trial a dot, by level and engine, with the median or the rate and its interval.

    by: an axis; left out, every combination of levels has its place.
    """

    score: str
    by: str = ""
    log: bool = False


class OneTrial(Options):
    """Figures of single trials. pick: which trial of a cell; "first" is that with the first seed, whatever came of it."""

    pick: Literal["first", "median"] = "first"
    score: str = ""  # by which "median" is taken
    most: Annotated[int, Field(ge=1, le=24)] = 4  # panels, for each = "seed"


class Maps(OneTrial):
    """Small multiples over the plan; a row for each engine."""

    show: Shown
    each: Each = "engine"
    marks: bool = True  # goals and where the map has put them


class Series(OneTrial):
    """Channels of a run over time, one above the other, the moments marked."""

    channels: Annotated[list[Channel], Field(min_length=1)]
    each: Each = "engine"
    after: str = ""  # how the words of a moment begin: the first such moment is then 0
    before: Annotated[float, Field(ge=0)] = 5.0  # seconds shown before it
    seconds: Annotated[float, Field(ge=0)] = 0.0  # shown after it, or from the start; 0: to the end
    log: bool = False  # of all channels but the packets


class Survival(Options):
    """The share of trials in which something has happened, by the time or the way until then, which is a score.

    A trial without that score is one in which it has not happened.
    """

    score: str
    unit: str = ""  # in words beside the axis; left out, that of the score
    lines: str = "engine"
    most: Annotated[float, Field(ge=0)] = 0.0  # end of the axis; 0: where the last one stands


OPTIONS: dict[str, type[Options]] = {
    "curves": Curves,
    "dots": Dots,
    "maps": Maps,
    "series": Series,
    "survival": Survival,
}


def options_of(experiment: Experiment, spec: FigureSpec) -> Any:
    """The options of a figure, checked against its experiment. ValueError names experiment, figure and what is allowed."""
    where = f"experiment {experiment.name}, figure {spec.title or spec.kind!r}"
    if spec.kind not in OPTIONS:
        raise ValueError(f"{where}: unknown kind {spec.kind!r}; expected one of: {', '.join(OPTIONS)}")
    kind = OPTIONS[spec.kind]
    for name in spec.options:
        if name not in kind.model_fields:
            near = difflib.get_close_matches(name, kind.model_fields, 1)
            meant = f" (did you mean {near[0]!r}?)" if near else ""
            allowed = ", ".join(kind.model_fields)
            raise ValueError(f"{where}: {spec.kind!r} has no option {name!r}{meant}; it has: {allowed}")
    try:
        options = kind.model_validate(spec.options)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(str(part) for part in first["loc"])
        got = "" if first["type"] == "missing" else f", got {first['input']!r}"
        raise ValueError(f"{where}: option {name}: {first['msg'].removeprefix('Value error, ')}{got}") from None
    try:
        _check(experiment, options)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    return options


def check_figures(experiment: Experiment) -> None:
    """ValueError names the first figure that cannot be drawn as its options ask."""
    for spec in experiment.figures:
        options_of(experiment, spec)


def _check(experiment: Experiment, options: Options) -> None:
    axes = [axis.name for axis in experiment.axes]
    labels = [level.label for axis in experiment.axes for level in axis.levels]
    for label in options.at:
        _one_of("at", label, labels)
    for engine in options.engines:
        _one_of("engines", engine, list(experiment.engines))
    scores = [score.label for score in experiment.scores]
    match options:
        case Curves():
            _one_of("score", options.score, scores)
            _one_of("along", options.along, axes)
            _one_of("lines", options.lines, ["", *(name for name in axes if name != options.along)])
        case Dots():
            _one_of("score", options.score, scores)
            _one_of("by", options.by, ["", *axes])
        case Maps() | Series():
            _one_of("each", options.each, [*axes, "engine", "seed"])
            if options.pick == "median":
                _one_of("score", options.score, scores)
        case Survival():
            _one_of("score", options.score, [score.label for score in experiment.scores if score.rate is None])
            _one_of("lines", options.lines, ["engine", *axes])
        case _:
            pass


def _one_of(name: str, value: str, allowed: list[str]) -> None:
    if value not in allowed:
        listed = ", ".join(repr(each) for each in allowed)
        raise ValueError(f"{name} = {value!r}: expected one of: {listed or 'there are none'}")
