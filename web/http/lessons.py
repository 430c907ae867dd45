"""The lessons, for the page: what there is, and the texts of one. They come from `Lessons`, which the program hands over."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any, Literal, Protocol

from fastapi import FastAPI, Request
from fastapi import Path as InPath
from fastapi.responses import Response
from pydantic import BaseModel

from web.http.asking import json_response
from web.http.commands import Declined, Problem
from web.http.security import Limits, comes_from_class
from web.http.state import to_json

Name = Annotated[str, InPath(max_length=40, description="its name")]


class LessonCard(BaseModel):
    """A lesson in short. minutes: simulated, about how long what is shown takes; wrong: why one of the user's cannot be begun."""

    name: str
    number: int
    title: str
    idea: str
    paper: str
    minutes: float
    rounds: int
    own: bool
    wrong: str | None


class SymbolText(BaseModel):
    """A symbol of a formula. parameter: its dotted name, if it is one; value: as it is in the lesson."""

    mathml: str
    means: str
    parameter: str | None
    value: str | None


class FormulaText(BaseModel):
    """mathml: with `data-parameter` at each symbol that is a parameter."""

    mathml: str
    latex: str
    says: str
    source: str
    symbols: list[SymbolText]


class Question(BaseModel):
    """What the class is asked: options, or a place to be drawn on a plate."""

    question: str
    options: list[str]
    draw: Literal["the robot", "the belief"] | None
    plate: Literal["office", "map"]


class LookText(BaseModel):
    """at: a plate (office, pose, map), a tab of the panel, or the timeline."""

    at: str
    words: str


class TryText(BaseModel):
    """button: None without commands."""

    words: str
    button: str | None
    commands: list[dict[str, Any]]


class LessonText(BaseModel):
    """All that the page tells of a lesson, but what happens in it. explains: Inspect tells why when it is over."""

    card: LessonCard
    text: str
    formulas: list[FormulaText]
    world: str
    engine: str
    seed: int
    view: Literal["all", "office", "pose", "map"]
    tab: str
    labels: list[str]  # of its rounds
    predict: Question
    watch: list[LookText]
    explains: bool
    sandbox: list[TryText]


class Lessons(Protocol):
    """Reads files and may take a while."""

    def cards(self) -> list[LessonCard]: ...

    def text(self, name: str) -> LessonText | None: ...


def add_lessons(app: FastAPI, lessons: Lessons | None) -> None:
    limits, of_class = Limits(), Limits()
    errors: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (404, 429)}

    @app.get("/api/lessons", tags=["lessons"], responses={200: {"model": list[LessonCard]}, 429: errors[429]})
    async def cards(request: Request) -> Response:
        """The lessons there are, in their order. `begin_lesson` begins one."""
        (of_class if comes_from_class(request) else limits).pass_on("lessons")
        found = [] if lessons is None else await asyncio.to_thread(lessons.cards)
        return json_response(to_json([card.model_dump() for card in found]))

    @app.get("/api/lessons/{name}", tags=["lessons"], responses={200: {"model": LessonText}, **errors})
    async def text(request: Request, name: Name) -> Response:
        """All texts of one lesson, its formulas as MathML."""
        (of_class if comes_from_class(request) else limits).pass_on("lessons")
        found = None if lessons is None else await asyncio.to_thread(lessons.text, name)
        if found is None:
            raise Declined.of(404, f"there is no lesson {name[:40]!r}; /api/lessons lists them")
        return json_response(to_json(found.model_dump()))
