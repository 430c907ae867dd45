"""What came of a lesson that ran without a page, in words, and whether it kept what it promises."""

from __future__ import annotations

from dataclasses import dataclass

from app.lessons.findings import told
from app.lessons.performance import Performance, perform, rounds_of
from app.lessons.schema import Lesson
from app.lessons.units import shown


@dataclass(frozen=True, slots=True)
class LessonReport:
    """kept: whether every promise holds, and one of the options is right."""

    lines: tuple[str, ...]
    kept: bool
    performances: tuple[Performance, ...]


def report_of(lesson: Lesson, seed: int | None = None) -> LessonReport:
    """Run a lesson and judge it."""
    performances = perform(lesson, seed)
    found = rounds_of(performances)
    lines, kept = (
        [f"{lesson.title}, seed {lesson.scene.seed if seed is None else seed}", told(lesson.outcome, found)],
        True,
    )
    ask = lesson.predict
    if ask.finding is not None and ask.options:
        value = ask.finding.of(found)
        right = [option.words for option in ask.options if option.holds(value)]
        kept = len(right) == 1
        lines.append(f"right prediction ({ask.finding.text} = {value:g}): {'; '.join(right) or 'none of the options'}")
    elif ask.draw is not None:
        x, y = performances[-1].place_of(ask.draw, ask.plate)
        lines.append(f"{ask.draw} ends at ({x:.2f}, {y:.2f}) on the {ask.plate}")
    for promise in lesson.promise:
        value = promise.finding.of(found)
        holds = promise.holds(value)
        kept = kept and holds
        bounds = f"[{promise.at_least:g}, {promise.below:g})"
        lines.append(f"{'kept' if holds else 'BROKEN'}: {promise.finding.text} = {value:g}, promised {bounds}")
    for performance in performances:
        assert performance.values is not None
        for label, values in performance.found:
            told_all = ", ".join(f"{name} {shown(name, value)}" for name, value in values.items() if value == value)
            lines.append(f"{label or 'measured'}: {told_all}")
        lines.append(f"state hash {performance.session.state_hash()}")
    return LessonReport(tuple(lines), kept, tuple(performances))
