"""What the page's gallery shows: the catalogue's experiments, with figures and trials from the user's folder where there
are some; and the lessons, with their formulas typeset.

Of each experiment the grid, its first score in each cell with the trials behind it, and the plan of its world, which stands
for a figure that is not there.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from html import escape
from pathlib import Path
from typing import TypeVar
from xml.etree import ElementTree

from latex2mathml.converter import convert

from app.code_version import code_version
from app.config import Config
from app.experiments.results import published
from app.experiments.store import Store, StoredTrial, default_path
from app.experiments.summary import CellSummary, leading, summarise, words
from app.protocol.experiment import EngineName, Experiment, Score, catalogue, first_levels
from app.protocol.lesson import Formula, Lesson, all_lessons, own_lessons
from app.protocol.lesson import catalogue as lesson_catalogue
from app.protocol.lesson_round import shown_s
from app.protocol.steps import Drive, Repeat, Step, Tag, place_of
from sim2d import World
from sim2d.importers import open_world
from web.http.gallery import (
    Axis,
    Card,
    Cell,
    Detail,
    Dot,
    FormulaText,
    LessonCard,
    LessonText,
    LookText,
    Plan,
    Question,
    Results,
    SymbolText,
    TryText,
)

PICTURES = Path(__file__).parents[1] / "docs" / "pictures" / "experiments"  # those that come with the program
FIGURES = "figures"  # the folder beside the store for those that are drawn here

EARLIER = "These trials were run by an earlier version of the program: played today, they may go otherwise."
PUBLISHED = "These are the program's own results, as in docs/results.md; none of these trials was run here yet."
OLDER = "They are of an earlier version: played today, a trial may go otherwise."
QUICK = "These are short trials, run to see that the experiment works; they say little."
MARGIN_M = 0.3  # of a plan, round the walls

_T = TypeVar("_T")


class StoredGallery:
    """Reads the catalogue and the store anew each time, so that what another program writes is seen."""

    def __init__(self, store: Path | None = None, pictures: Path = PICTURES) -> None:
        self._store, self._pictures = store, pictures

    def cards(self) -> list[Card]:
        code_version()  # takes a second the first time: better here than when somebody presses "Watch it"
        counts: dict[str, int] = {}
        with contextlib.suppress(ValueError):  # each experiment says what is wrong with the store
            counts = self._read(lambda store: store.counts()) or {}
        return [self._card(experiment, counts.get(experiment.name, 0)) for experiment in catalogue()]

    def detail(self, name: str) -> Detail | None:
        experiment = _experiments().get(name)
        if experiment is None:
            return None
        why = ""
        try:
            trials = self._read(lambda store: store.of_experiment(name)) or []
        except ValueError as error:
            trials, why = [], str(error)
        done = sum(not trial.error for trial in trials)
        results = _results_of(experiment, trials, *_of_program(name))
        if why:
            results.note = f"The trials that were run here cannot be shown: {why}. {results.note}".strip()
        return Detail(card=self._card(experiment, done), results=results)

    def picture(self, name: str) -> Path | None:
        """The newest figure drawn here, the first of its experiment; else the one that comes with the program."""
        if name not in _experiments():
            return None
        drawn: list[Path] = []
        with contextlib.suppress(ValueError):  # there is no home, and so none drawn
            drawn = [*self._folder.glob(f"{name}-1-*.svg"), *self._folder.glob(f"{name}-1-*.png")]
        if drawn:
            return max(drawn, key=lambda path: (path.stat().st_mtime, path.suffix))
        shipped = [self._pictures / f"{name}{suffix}" for suffix in (".svg", ".png")]
        return next((path for path in shipped if path.is_file()), None)

    @property
    def _path(self) -> Path:
        return self._store or default_path()

    @property
    def _folder(self) -> Path:
        return self._path.parent / FIGURES

    def _read(self, question: Callable[[Store], _T]) -> _T | None:
        """The store's answer; None if nothing was run yet, and then no file is made. ValueError says why it cannot be read."""
        if not self._has_store():
            return None
        with Store(self._path, reading=True) as store:
            return question(store)

    def _has_store(self) -> bool:
        with contextlib.suppress(ValueError):  # there is no home, and so no store
            return self._path.is_file()
        return False

    def _card(self, experiment: Experiment, done: int) -> Card:
        world = _world(experiment.world)
        picture = self.picture(experiment.name)
        return Card(
            name=experiment.name,
            title=experiment.title,
            paper=experiment.paper,
            asks=experiment.asks,
            found=experiment.found,
            world=world.title,
            engines=list(experiment.engines),
            axes=[Axis(name=axis.name, levels=[level.label for level in axis.levels]) for axis in experiment.axes],
            watch=list(first_levels(experiment)),
            seed=experiment.seed,
            trials=experiment.trials,
            seconds=experiment.seconds(),
            done=done,
            picture=None if picture is None else f"/api/experiments/{experiment.name}/picture",
            plan=_plan_of(experiment, world),
        )


def _experiments() -> dict[str, Experiment]:
    return {experiment.name: experiment for experiment in catalogue()}


def _of_program(name: str) -> tuple[list[CellSummary], list[StoredTrial]]:
    with contextlib.suppress(ValueError):  # an installed program may come without its documents
        return published(name)
    return [], []


@lru_cache
def _world(name: str) -> World:
    return open_world(name)


def _results_of(
    experiment: Experiment, stored: Sequence[StoredTrial], shown: Sequence[CellSummary], behind: list[StoredTrial]
) -> Results:  # fmt: skip
    """The grid of an experiment. stored: all its trials, the oldest first. Those shown are of one kind, the best there is.

    shown: what stands in docs/results.md, for want of trials; behind: the trials behind it.
    """
    trials, note = _chosen([trial for trial in stored if not trial.error])
    cells = summarise(experiment, trials) if trials else shown
    if not trials and shown:
        trials = behind
        note = PUBLISHED if all(trial.version == code_version() for trial in behind) else f"{PUBLISHED} {OLDER}"
    score = leading(experiment)
    found = {(cell.engine, cell.levels): cell for cell in cells if score.label in cell.values}
    values = [cell.values[score.label].value for cell in found.values()]
    finite = [value for value in values if math.isfinite(value)]
    span = (0.0, 1.0) if score.rate is not None else (min(finite, default=0.0), max(finite, default=1.0))
    return Results(
        score=score.label,
        is_rate=score.rate is not None,
        note=note,
        cells=[
            _cell(score, engine, levels, found.get((engine, levels)), span, _of(trials, engine, levels))
            for engine in experiment.engines
            for levels in (tuple(level.label for level in cell) for cell in experiment.cells())
        ],
    )


def _chosen(trials: list[StoredTrial]) -> tuple[list[StoredTrial], str]:
    whole = [trial for trial in trials if not trial.quick]
    current = [trial for trial in whole if trial.version == code_version()]
    if current or not trials:
        return current, ""
    newest = {(trial.engine, trial.levels, trial.seed): trial for trial in whole or trials}  # of each cell and seed
    return list(newest.values()), EARLIER if whole else QUICK


def _of(trials: list[StoredTrial], engine: str, cell: tuple[str, ...]) -> list[StoredTrial]:
    mine = [trial for trial in trials if trial.engine == engine and trial.levels == cell]
    return sorted(mine, key=lambda trial: (trial.seed, trial.id))


def _cell(
    score: Score, engine: EngineName, levels: tuple[str, ...], summary: CellSummary | None, span: tuple[float, float],
    trials: list[StoredTrial],
) -> Cell:  # fmt: skip
    dots = [_dot(score, trial) for trial in trials]
    if summary is None or summary.n == 0:
        return Cell(engine=engine, levels=list(levels), n=0, words="", shade=None, dots=dots)
    value = summary.values[score.label]
    shade = _share(value.value, *span)
    return Cell(engine=engine, levels=list(levels), n=summary.n, words=words(value, score), shade=shade, dots=dots)


def _share(value: float, low: float, high: float) -> float | None:
    if not math.isfinite(value):
        return None
    return 0.5 if high <= low else (value - low) / (high - low)


def _dot(score: Score, trial: StoredTrial) -> Dot:
    good = of = None
    if score.rate is None:
        value = trial.scores.get(str(score.score))
        said = "not measured" if value is None else f"{value:.3g} {score.unit}".rstrip()
    else:
        good, of = (round(trial.scores.get(name, 0.0)) for name in score.rate)
        said = f"{good} of {of}"
    return Dot(
        id=trial.id, seed=trial.seed, quick=trial.quick, good=good, of=of, words=said, moment_s=trial.moment_s,
        moment=trial.moment_words,
    )  # fmt: skip


def _plan_of(experiment: Experiment, world: World) -> Plan:
    """The plan of an experiment's world, with the way that its protocol drives."""
    ends = [(wall.x1, wall.y1, wall.x2, wall.y2) for wall in world.walls]
    xs = [x for x1, _, x2, _ in ends for x in (x1, x2)]
    ys = [y for _, y1, _, y2 in ends for y in (y1, y2)]
    left, bottom = min(xs) - MARGIN_M, min(ys) - MARGIN_M
    steps = list(_flat(experiment.protocol))
    drives = [[place_of(world, where) for where in step.path] for step in steps if isinstance(step, Drive)]
    tagged = [place_of(world, name) for step in steps if isinstance(step, Tag) for name in step.places]
    return Plan(
        width=round(max(xs) + MARGIN_M - left, 2),
        depth=round(max(ys) + MARGIN_M - bottom, 2),
        left=round(left, 2),
        bottom=round(bottom, 2),
        walls="".join(f"M{x1:.2f} {y1:.2f}L{x2:.2f} {y2:.2f}" for x1, y1, x2, y2 in ends),
        way="".join("M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in points) for points in drives),
        places=tagged,
    )


def _flat(steps: Sequence[Step]) -> Iterable[Step]:
    for step in steps:
        if isinstance(step, Repeat):
            yield from _flat(step.steps)
        else:
            yield step


MATHML = "http://www.w3.org/1998/Math/MathML"


class StoredLessons:
    """The lessons of the program and the user's own.

    Reads the files anew each time, so that a teacher sees at once what was changed.
    """

    def cards(self) -> list[LessonCard]:
        of_program = {lesson.name for lesson in lesson_catalogue()}
        own = {lesson.name for _, lesson in own_lessons() if isinstance(lesson, Lesson)}
        cards = [_card(number, lesson, lesson.name in own) for number, lesson in enumerate(all_lessons(), start=1)]
        for path, lesson in own_lessons():
            if isinstance(lesson, str) and path.stem not in of_program:
                cards.append(
                    LessonCard(
                        name=path.stem, number=len(cards) + 1, title=path.name, idea="", paper="", minutes=0.0, rounds=1,
                        own=True, wrong=lesson,
                    )
                )  # fmt: skip
        return cards

    def text(self, name: str) -> LessonText | None:
        lessons = all_lessons()
        number = next((k for k, lesson in enumerate(lessons) if lesson.name == name), None)
        if number is None:
            return None
        lesson = lessons[number]
        scene, ask = lesson.scene, lesson.predict
        values = {
            dotted: f"{value:g}" if isinstance(value, float) else str(value)
            for dotted, _, value in scene.config.items()
        }
        own = any(isinstance(each, Lesson) and each.name == name for _, each in own_lessons())
        return LessonText(
            card=_card(number + 1, lesson, own),
            text=lesson.text.strip(),
            more=lesson.more,
            formulas=[_typeset(formula, values) for formula in lesson.formulas],
            world=open_world(scene.world).title,
            engine=scene.engine,
            seed=scene.seed,
            view=scene.view,
            tab=scene.tab,
            labels=[each.label for each in lesson.rounds],
            predict=Question(
                question=ask.question.strip(),
                options=[each.words for each in ask.options],
                draw=ask.draw,
                plate=ask.plate,
            ),
            watch=[LookText(at=look.at, words=look.words) for look in lesson.watch],
            explains=lesson.show.explain is not None,
            sandbox=[TryText(words=each.words, button=each.button, commands=each.commands) for each in lesson.sandbox],
        )


def _card(number: int, lesson: Lesson, own: bool) -> LessonCard:
    return LessonCard(
        name=lesson.name, number=number, title=lesson.title, idea=lesson.idea, paper=lesson.paper,
        minutes=max(0.1, round(shown_s(lesson) / 60, 1)), rounds=lesson.round_count, own=own, wrong=None,
    )  # fmt: skip


def _typeset(formula: Formula, values: dict[str, str]) -> FormulaText:
    """One that cannot be typeset is shown as it was written."""
    try:
        return formula_text(formula, values)
    except ValueError:
        mathml = f'<math xmlns="{MATHML}"><mtext>{escape(formula.latex)}</mtext></math>'
        return FormulaText(mathml=mathml, latex=formula.latex, says=formula.says, source=formula.source, symbols=[])


def check_formulas(lesson: Lesson) -> None:
    """ValueError names a formula or symbol that cannot be typeset."""
    values = {dotted: "" for dotted, _, _ in Config().items()}
    for formula in lesson.formulas:
        formula_text(formula, values)


def formula_text(formula: Formula, values: Mapping[str, str]) -> FormulaText:
    """A formula as MathML, each symbol that is a parameter marked by its name.

    values: of the parameters, by dotted name. ValueError: it is no LaTeX.
    """
    tree = _tree(formula.latex, block=True)
    for symbol in formula.symbols:
        if symbol.parameter is not None:
            _mark(tree, _content(symbol.symbol), symbol.parameter)
    symbols = [
        SymbolText(
            mathml=_text(_tree(symbol.symbol)), means=symbol.means, parameter=symbol.parameter,
            value=None if symbol.parameter is None else values[symbol.parameter],
        )
        for symbol in formula.symbols
    ]  # fmt: skip
    return FormulaText(
        mathml=_text(tree), latex=formula.latex, says=formula.says, source=formula.source, symbols=symbols
    )


def _tree(latex: str, block: bool = False) -> ElementTree.Element:
    ElementTree.register_namespace("", MATHML)
    try:
        tree = ElementTree.fromstring(convert(latex, display="block" if block else "inline"))
    except Exception as error:  # whatever the converter raises
        raise ValueError(f"{latex!r} cannot be typeset: {type(error).__name__} {error}") from None
    unknown = next((text for each in tree.iter() if (text := each.text or "").startswith("\\")), None)
    if unknown is not None:
        raise ValueError(f"{latex!r} cannot be typeset: {unknown} is unknown")
    return tree


def _content(latex: str) -> list[str]:
    """The symbol's own elements as texts, without those around it."""
    inner = list(_tree(latex))
    while len(inner) == 1 and inner[0].tag.endswith("mrow"):
        inner = list(inner[0])
    return [_text(each) for each in inner]


def _mark(tree: ElementTree.Element, wanted: list[str], parameter: str) -> None:
    """Mark every element that looks like the symbol; of a symbol of several elements, the first."""
    for element in tree.iter():
        children = list(element)
        for k in range(len(children) - len(wanted) + 1):
            if [_text(each) for each in children[k : k + len(wanted)]] == wanted:
                children[k].set("data-parameter", parameter)


def _text(element: ElementTree.Element) -> str:
    tail, element.tail = element.tail, None
    text = ElementTree.tostring(element, encoding="unicode")
    element.tail = tail
    return text
