"""A lesson: one idea of the papers as a file that says what to set up, to ask, to show and to promise (docs/lessons.md tells how
to write one); those that come with the program, and the user's own in ~/.ratslam/lessons."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from app.config import Config
from app.config.presets import Pair, pair_of, require_pair, values_of
from app.protocol.conditions import Until
from app.protocol.files import read_part
from app.protocol.measures import MEASURE_OF, MEASURES, Measure, measure_of, measures_for, reading_of
from app.protocol.steps import Line, Part, Seconds, Step, Text, Values, WorldName
from disk import user_folder
from disk.words import lines
from web.messages import Command
from web.messages.commands import Name

Plate = Literal["office", "map"]  # where something is marked or drawn; frames: the simulator's own, the map's own
MarkKind = Literal["closure", "snap", "lost", "recovered", "kidnap", "arrived", "false", "packet", "link", "reached"]
PairName = Annotated[str, AfterValidator(require_pair)]
_COMMAND: TypeAdapter[Command] = TypeAdapter(Command)


_IN_BRACES = re.compile(r"\{([^{}]*)\}")

Measured = Mapping[str, float]  # what was measured in a round, by the name of the reading


def _known_reading(reference: str) -> str:
    measure_of(reference.split(" of ", 1)[0])
    return reference


Reference = Annotated[str, AfterValidator(_known_reading)]  # "NAME", of the last round, or "NAME of LABEL"


class Finding(Part):
    """A measure; with `minus`, less another; with `over`, so many times as large as another."""

    measure: Reference
    minus: Reference | None = None
    over: Reference | None = None

    @property
    def text(self) -> str:
        minus = "" if self.minus is None else f" - {self.minus}"
        return self.measure + minus + ("" if self.over is None else f" / {self.over}")

    @property
    def parts(self) -> list[str]:
        return [part for part in (self.measure, self.minus, self.over) if part is not None]

    @property
    def labelled(self) -> list[tuple[str, str]]:
        """Measure and label of each part that names a round, or one of two brains."""
        split = [part.partition(" of ") for part in self.parts if " of " in part]
        return [(name, label) for name, _, label in split]

    def of(self, rounds: Sequence[tuple[str, Measured]]) -> float:
        """Its value. rounds: label and values of each, or of each of two brains; what names none is of the last."""
        value = _value(self.measure, rounds)
        if self.minus is not None:
            less = _value(self.minus, rounds)
            value = 0.0 if value == less else value - less  # what neither reached is no difference
        return value if self.over is None else value / max(_value(self.over, rounds), 1e-9)

    @classmethod
    def all_in(cls, text: str) -> list[Finding]:
        """Those in braces."""
        return [cls(measure=reference) for reference in _IN_BRACES.findall(text)]


def fill_in(text: str, rounds: Sequence[tuple[str, Measured]]) -> str:
    """The text with what was found in the place of each {NAME} or {NAME of LABEL}."""

    def found(match: re.Match[str]) -> str:
        reference = match.group(1)
        return reading_of(reference.split(" of ", 1)[0]).shown(_value(reference, rounds))

    return _IN_BRACES.sub(found, text)


def _value(reference: str, rounds: Sequence[tuple[str, Measured]]) -> float:
    name, _, label = reference.partition(" of ")
    values = next((values for known, values in rounds if known == label), None) if label else rounds[-1][1]
    if values is None:
        raise ValueError(f"{reference!r}: there is no round {label!r}")
    return values.get(name, math.nan)  # of a reading that does not apply


def _known(parameter: str) -> str:
    if parameter not in (names := {name for name, _, _ in Config().items()}):
        near = get_close_matches(parameter, names, 1) or sorted(names)[:1]
        raise ValueError(f"there is no parameter {parameter!r}; one is {near[0]!r}")
    return parameter


def _fitting(values: Values) -> Values:
    Config().with_values(values)
    return values


Settings = Annotated[Values, AfterValidator(_fitting)]  # parameters by dotted names, each within its range


class Symbol(Part):
    """A symbol of a formula: what it is, and which parameter it is, if it is one."""

    symbol: Line  # LaTeX, as in the formula
    means: Line
    parameter: Annotated[str, AfterValidator(_known)] | None = None


class Formula(Part):
    """A formula as in the paper, in LaTeX."""

    latex: Annotated[str, Field(min_length=1, max_length=400), AfterValidator(lines)]
    says: Line
    source: Line  # such as "A eq. 4"
    symbols: list[Symbol] = []


class Scene(Part):
    """What the lesson begins with. `steps` are run ahead as fast as possible.

    view: which plates are looked at; tab: of the panel; speed: at which the rest is shown.
    """

    world: WorldName = "office"
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 1
    engine: Literal["ours", "paper-2004", "paper-2005", "paper-2006"] = "ours"
    set: Settings = {}
    view: Literal["all", "office", "pose", "map"] = "all"
    tab: Literal["senses", "memory", "truth", "tick", "inspect", "office", "tune"] = "memory"
    speed: Annotated[float, Field(ge=0.25, le=16)] = 1.0
    steps: list[Step] = []
    compare: PairName | None = None  # a second brain gets the same input from the beginning on

    @property
    def config(self) -> Config:
        """With which it begins."""
        return Config().with_values({**values_of(self.engine), **self.set})


class Round(Part):
    """A lesson may be shown several times over, each time with other settings: a run each, from the same seed."""

    label: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 .,%/-]{0,39}$")]
    set: Settings = {}
    steps: list[Step] = []  # at the beginning of what is shown


class _Bounds(Part):
    """A number from `at_least` on and `below`; what never happened is infinite, and not below anything that is given."""

    model_config = ConfigDict(allow_inf_nan=True)

    at_least: float = -math.inf
    below: float = math.inf

    def holds(self, value: float) -> bool:
        return self.at_least <= value and (value < self.below or self.below == math.inf)


class Option(_Bounds):
    """A prediction that can be chosen. It is right if what is found lies within its bounds."""

    words: Line


class Predict(Part):
    """What the class is asked before it happens. The right answer is found in the run: it stands nowhere.

    Either options, with what is measured; or `draw`: where on the office `the robot` will be, or `the belief`, which is
    where it will believe itself to be. near_m: a drawn point is right within this.
    """

    question: Text
    options: list[Option] = []
    finding: Finding | None = None
    draw: Literal["the robot", "the belief"] | None = None
    plate: Plate = "office"
    near_m: Annotated[float, Field(gt=0, le=100)] = 1.0

    @model_validator(mode="after")
    def _either(self) -> Predict:
        if (self.draw is None) != bool(self.options):
            raise ValueError("give either options, three or four, or draw")
        if self.options and (self.finding is None or not 2 <= len(self.options) <= 5):
            raise ValueError(
                "options need a finding, which is what decides between them, and there must be 2 to 5 of them"
            )
        if self.draw == "the robot" and self.plate == "map":
            raise ValueError(
                'the map shows where the robot believes itself to be: draw = "the belief", or plate = "office"'
            )
        for a, b in ((a, b) for k, a in enumerate(self.options) for b in self.options[k + 1 :]):
            if max(a.at_least, b.at_least) < min(a.below, b.below):
                raise ValueError(f"options {a.words!r} and {b.words!r} can both be right: their bounds overlap")
        return self


class Show(Part):
    """What is shown: steps, until they are done or `until` is met, and `then_s` more. It takes at most `limit_s`.

    marks: kinds of events that are marked where they happen. explain: the last event of this kind is inspected at the end.
    """

    steps: Annotated[list[Step], Field(min_length=1)]
    until: Until | None = None
    then_s: Annotated[float, Field(ge=0, le=600)] = 0.0
    limit_s: Seconds = 300.0
    marks: list[MarkKind] = []
    explain: Literal["snap", "closure", "lost", "false"] | None = None
    compare: PairName | None = None  # a copy of the brain becomes a second one when it is shown


class Look(Part):
    """What to look at while it happens. at: a plate, or a tab of the panel."""

    at: Literal["office", "pose", "map", "senses", "memory", "truth", "tick", "inspect", "tune", "timeline"]
    words: Line


class Promise(_Bounds):
    """What must come out, on the lesson's seed and on others: a test proves the first."""

    finding: Finding

    @model_validator(mode="after")
    def _promises_something(self) -> Promise:
        if self.at_least == -math.inf and self.below == math.inf:
            raise ValueError("a promise without at_least and below cannot be broken: give one of them")
        return self


class Try(Part):
    """Something to try afterwards: a sentence, and what its button does, as commands of the API."""

    words: Line
    button: Name | None = None
    commands: list[dict[str, Any]] = []

    @model_validator(mode="after")
    def _commands_exist(self) -> Try:
        if (self.button is None) == bool(self.commands):
            raise ValueError("a button needs commands, and commands a button")
        for command in self.commands:
            try:
                _COMMAND.validate_python(command)
            except ValidationError as error:
                raise ValueError(f"{command!r} is no command: {error.errors()[0]['msg']}") from None
        return self


class Lesson(Part):
    """One idea. `outcome` tells what happened; {NAME} in it is what was measured, {NAME of LABEL} that of a round. `text`, the
    paper's passage, and `more`, what else is known of the outcome, unfold."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,39}$")]
    title: Line
    idea: Line
    paper: Line
    text: Text
    formulas: list[Formula] = []
    scene: Scene
    rounds: list[Round] = []
    predict: Predict
    show: Show
    outcome: Text
    because: Text
    more: Text | None = None
    watch: list[Look] = []
    promise: Annotated[list[Promise], Field(min_length=1)]
    sandbox: list[Try] = []

    @model_validator(mode="after")
    def _labels_known(self) -> Lesson:
        labels, pair = [each.label for each in self.rounds], self.pair
        if len(set(labels)) != len(labels) or len(labels) == 1:
            raise ValueError("rounds: each needs a label of its own, and one alone is none: use the scene's set")
        what = "round" if pair is None else "brain"
        labels = labels if pair is None else [pair.first, pair.second]
        for finding in self.findings:
            for measure, label in finding.labelled:
                if label not in labels:
                    known = f"one of: {', '.join(labels)}" if labels else "left out, as there are no rounds"
                    raise ValueError(f"{finding.text!r}: there is no {what} {label!r}; it must be {known}")
                if pair is not None and label == pair.second and not measure_of(measure).of_any_brain:
                    known = ", ".join(name for name, kind in MEASURE_OF.items() if kind.of_any_brain)
                    raise ValueError(f"{finding.text!r}: of a second brain only {known} are measured")
        return self

    @property
    def pair(self) -> Pair | None:
        """The two brains that it compares. ValueError: they cannot be compared."""
        name = self.scene.compare or self.show.compare
        if name is None:
            return None
        if self.rounds or (self.scene.compare and self.show.compare):
            raise ValueError("compare: give it once, in the scene or in what is shown, and no rounds beside it")
        pair = pair_of(name, self.scene.config)
        fixed = [dotted for dotted, item, _ in Config().items() if dotted in pair.values and not item.metadata["live"]]
        if self.show.compare and fixed:
            raise ValueError(
                f"compare: {name!r} changes {fixed[0]}, which a running brain cannot: give it in the scene"
            )
        return pair

    @property
    def findings(self) -> list[Finding]:
        """All that is asked of its run or runs."""
        asked = [self.predict.finding] if self.predict.finding is not None else []
        return [*asked, *(promise.finding for promise in self.promise), *Finding.all_in(self.outcome)]

    @property
    def measures(self) -> list[type[Measure]]:
        """All that costs little, and what is asked."""
        asked = measures_for(name.split(" of ", 1)[0] for each in self.findings for name in each.parts)
        return [kind for kind in MEASURES if not kind.costly or kind in asked]

    @property
    def round_count(self) -> int:
        return max(1, len(self.rounds))


_CATALOGUE = Path(__file__).with_name("lessons")


def own_folder() -> Path:
    """Where a teacher's own lie. ValueError without a home."""
    return user_folder("lessons")


def read_lesson(path: Path) -> Lesson:
    """ValueError: file, line, name, value, and what would be right."""
    return read_part(path, Lesson)


def check_lesson(lesson: Lesson) -> None:
    """ValueError says what does not fit together: a world, a place, a door."""
    from app.protocol.lesson_round import LessonRound, session_of
    from app.views.history import History

    for number in range(lesson.round_count):
        session = session_of(lesson, number)
        LessonRound(lesson, number, session, History(session))


def catalogue() -> Iterator[Lesson]:
    """The lessons that come with the program, in their order."""
    for path in sorted(_CATALOGUE.glob("*.toml")):
        yield read_lesson(path)


def own_lessons() -> Iterator[tuple[Path, Lesson | str]]:
    """The user's, each read or with what is wrong with it."""
    try:
        folder = own_folder()
    except ValueError:  # no home directory, so none of one's own
        return
    for path in sorted(folder.glob("*.toml")):
        try:
            yield path, read_lesson(path)
        except ValueError as error:
            yield path, str(error)


def all_lessons() -> list[Lesson]:
    """Those that can be begun. One of the user's takes the place of one of the program's with the same name."""
    found = {lesson.name: lesson for lesson in catalogue()}
    found.update({lesson.name: lesson for _, lesson in own_lessons() if isinstance(lesson, Lesson)})
    return list(found.values())


def find_lesson(name: str) -> Lesson:
    """A lesson by name. ValueError lists the names there are."""
    lessons = {lesson.name: lesson for lesson in all_lessons()}
    if name not in lessons:
        raise ValueError(f"there is no lesson {name!r}; expected one of: {', '.join(lessons)}")
    return lessons[name]
