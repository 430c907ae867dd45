"""The lessons as the page is told of them: those of the program and the user's own, with their formulas typeset."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from xml.etree import ElementTree

from latex2mathml.converter import convert

from app.config import Config
from app.protocol.lesson import Formula, Lesson, all_lessons, catalogue, own_lessons
from app.protocol.performance import shown_s
from sim2d.importers import open_world
from web.http.gallery import FormulaText, LessonCard, LessonText, LookText, Question, SymbolText, TryText

MATHML = "http://www.w3.org/1998/Math/MathML"


class StoredLessons:
    """Reads the files anew each time, so that a teacher sees at once what was changed."""

    def cards(self) -> list[LessonCard]:
        of_program = {lesson.name for lesson in catalogue()}
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
