"""The lessons as the page is told of them: those of the program and the user's own."""

from __future__ import annotations

from html import escape

from app.config import Config
from app.gallery.formulas import MATHML, formula_text
from app.lessons.files import all_lessons, catalogue, own_lessons
from app.lessons.performance import shown_s
from app.lessons.schema import Formula, Lesson
from sim2d.importers import open_world
from web.http.lessons import FormulaText, LessonCard, LessonText, LookText, Question, TryText


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


def _card(number: int, lesson: Lesson, own: bool) -> LessonCard:
    return LessonCard(
        name=lesson.name, number=number, title=lesson.title, idea=lesson.idea, paper=lesson.paper,
        minutes=max(0.1, round(shown_s(lesson) / 60, 1)), rounds=lesson.round_count, own=own, wrong=None,
    )  # fmt: skip
