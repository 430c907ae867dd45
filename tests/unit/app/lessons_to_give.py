"""A short lesson that is in no catalogue."""

from __future__ import annotations

from typing import Any

from app.protocol.lesson import Lesson

SHORT: dict[str, Any] = {
    "name": "short",
    "title": "A short lesson",
    "idea": "It moves.",
    "paper": "none",
    "text": "The robot drives.",
    "scene": {"world": "office", "steps": [{"do": "move", "moves": [[0.2, 0.0, 1.0]]}]},
    "predict": {
        "question": "How far?",
        "finding": {"measure": "path_m"},
        "options": [{"words": "not far", "below": 0.3}, {"words": "far", "at_least": 0.3}],
    },
    "show": {"steps": [{"do": "move", "moves": [[0.2, 0.0, 2.0]]}], "limit_s": 10},
    "outcome": "It drove {path_m}.",
    "because": "The wheels turned.",
    "promise": [{"finding": {"measure": "path_m"}, "at_least": 0.3, "below": 0.5}],
}


def short_lesson(**changes: object) -> Lesson:
    return Lesson.model_validate({**SHORT, **changes})


def drawn_lesson() -> Lesson:
    return short_lesson(predict={"question": "Where?", "draw": "the robot", "near_m": 0.5})


def two_rounds() -> Lesson:
    rounds = [{"label": "slow"}, {"label": "fast", "steps": [{"do": "move", "moves": [[0.3, 0.0, 1.0]]}]}]
    return short_lesson(
        rounds=rounds,
        predict={**SHORT["predict"], "finding": {"measure": "path_m of fast", "minus": "path_m of slow"}},
        outcome="{path_m of slow}, then {path_m of fast}.",
    )
