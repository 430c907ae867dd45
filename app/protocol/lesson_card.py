"""How many words the card of a lesson has in sight in each state (web/static/lessons shows it). What unfolds is not counted: the
paper's passage and formulas, `more`, the moments, a question that has been asked."""

from __future__ import annotations

import re
from collections.abc import Iterable

from app.protocol.lesson import Lesson, fill_in

MOST_WORDS = 90

# The card's own words, and the most that it says: a class votes, the prediction was wrong, somebody changed something.
CARD = {
    "always": ("Lesson 1", "As in the paper", "Your run"),
    "rounds": ("round 1 of 2",),
    "asking": ("9 votes", "The class votes at ADDRESS."),
    "drawing": ("Click the plan, or use the arrow keys and Enter.",),
    "scene": ("The scene is being set.",),
    "predict": ("Let it happen",),
    "watching": ("What to watch", "The question"),
    "between rounds": ("Show the next round",),
    "over": ("Not as predicted", "The question", "Try it", "Again", "Next"),
    "compared": ("Predicted:", "9 of 9 predicted it", "Moments", "Changed by you."),
    "more": ("More",),
    "inspect": ("Inspect: why it happened",),
    "drawn": ("9 m from where it ended", "Blue: predicted. Orange: where it ended. Ring: the robot."),
}
IN_SIGHT = {  # what of a file
    "scene": "question or options",
    "predict": "question or options",
    "showing": "watch",
    "between rounds": "watch",
    "compared": "options, outcome or because",
    "sandbox": "sandbox",
}


def words_in_sight(lesson: Lesson) -> dict[str, int]:
    """By state; `between rounds` is that of a round which is over while another follows."""
    always = [lesson.title, *CARD["always"], *(CARD["rounds"] if lesson.rounds else ())]
    asks, watches, over = [*always, *_asking(lesson)], [*always, *_watching(lesson)], [*always, *CARD["over"]]
    states = {
        "scene": [*asks, *CARD["scene"]],
        "predict": [*asks, *CARD["predict"]],
        "showing": [*watches, "On the way to the goal."],
        "compared": [*over, *_comparing(lesson)],
        "sandbox": [*over, "Broken off: somebody drove the robot by hand.", *_trying(lesson)],
    }
    if lesson.rounds:
        first, second = (each.label for each in lesson.rounds[:2])
        states["between rounds"] = [*watches, f"{first} is over; next: {second}.", *CARD["between rounds"]]
    return {state: count_words(texts) for state, texts in states.items()}


def wordy_states(lesson: Lesson) -> list[str]:
    """A sentence for each state in which the card shows more than it should."""
    return [
        f"in the state {state!r} the card shows {count} words at once; more than {MOST_WORDS} are not read: "
        f"shorten {IN_SIGHT[state]}"
        for state, count in words_in_sight(lesson).items()
        if count > MOST_WORDS
    ]


def count_words(texts: Iterable[str]) -> int:
    """What stands between spaces and has a letter or a digit, as the page's test counts."""
    return sum(len(re.findall(r"\S*\w\S*", text)) for text in texts)


def _asking(lesson: Lesson) -> list[str]:
    ask = lesson.predict
    counts = ["9" for _ in ask.options]
    drawing = CARD["drawing"] if ask.draw else ()
    return [ask.question, *(each.words for each in ask.options), *counts, *CARD["asking"], *drawing]


def _watching(lesson: Lesson) -> list[str]:
    places = ["Pose cells" if look.at == "pose" else look.at for look in lesson.watch]
    return [*CARD["watching"], *places, *(look.words for look in lesson.watch)]


def _comparing(lesson: Lesson) -> list[str]:
    predicted = max((each.words for each in lesson.predict.options), key=lambda words: count_words([words]), default="")
    return [
        lesson.because, _outcome(lesson), *CARD["compared"], *([predicted] if predicted else CARD["drawn"]),
        *(CARD["more"] if lesson.more else ()), *(CARD["inspect"] if lesson.show.explain else ()),
    ]  # fmt: skip


def _trying(lesson: Lesson) -> list[str]:
    return [text for each in lesson.sandbox for text in (each.words, each.button or "")]


def _outcome(lesson: Lesson) -> str:
    """With a number for each reading."""
    found = {part.split(" of ", 1)[0]: 1.0 for finding in lesson.findings for part in finding.parts}
    pair = lesson.pair
    labels = [each.label for each in lesson.rounds] if pair is None else [pair.second, pair.first]
    return fill_in(lesson.outcome, [(label, found) for label in labels or [""]])
