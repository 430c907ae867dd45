"""Experiments and lessons, for the page to choose from. What there is to tell comes from a Gallery and from Lessons, which the
program hands over."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Annotated, Any, Literal, Protocol

from fastapi import FastAPI, Request
from fastapi import Path as InPath
from fastapi.responses import FileResponse, Response
from pydantic import BaseModel

from web.http.asking import json_response
from web.http.commands import Declined, Problem
from web.http.security import Limits, comes_from_class
from web.http.state import to_json
from web.messages.commands import EngineName

Name = Annotated[str, InPath(max_length=40, description="its name")]
TYPES = {".svg": "image/svg+xml", ".png": "image/png"}


# ------------------------------------------------------------ experiments


class Axis(BaseModel):
    """What is varied, and its levels by label."""

    name: str
    levels: list[str]


class Plan(BaseModel):
    """The world from above, as the data of SVG paths in metres, y upwards: walls, and the way that is driven."""

    width: float
    depth: float
    left: float
    bottom: float
    walls: str
    way: str
    places: list[tuple[float, float]]


class Card(BaseModel):
    """An experiment in short."""

    name: str
    title: str
    paper: str  # with figure, table or section
    asks: str
    found: str  # by the paper
    world: str  # its title
    engines: list[EngineName]
    axes: list[Axis]
    watch: list[str]  # the levels at which it is watched unless others are chosen
    seed: int  # of its first trial
    trials: int  # in each cell
    seconds: float  # simulated, of one trial, about
    done: int  # trials that were run here
    picture: str | None  # the path of its figure
    plan: Plan | None  # to be drawn where there is no picture


class Dot(BaseModel):
    """A trial that was run here, or for the program's own results."""

    id: str  # "": of the program's own, which a store need not have
    seed: int
    quick: bool
    good: int | None  # so many of its goals were reached; None: this score has no goals
    of: int | None
    words: str
    moment_s: float  # of the moment that decided it, simulated
    moment: str


class Cell(BaseModel):
    """The trials of one engine at one level of each axis. `shade`: from 0 to 1, for its colour; None without trials."""

    engine: EngineName
    levels: list[str]
    n: int
    words: str  # the score with its interval
    shade: float | None
    dots: list[Dot]


class Results(BaseModel):
    """What was run of an experiment. `note`: what the reader has to know of these trials, or why there are none."""

    score: str
    is_rate: bool
    note: str
    cells: list[Cell]


class Detail(BaseModel):
    card: Card
    results: Results


class Gallery(Protocol):
    """Reads files and may take a while."""

    def cards(self) -> list[Card]: ...

    def detail(self, name: str) -> Detail | None: ...

    def picture(self, name: str) -> Path | None: ...


def add_experiments(app: FastAPI, gallery: Gallery | None) -> None:
    limits = Limits()
    errors: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (404, 429)}

    @app.get("/api/experiments", tags=["experiments"], responses={200: {"model": list[Card]}, 429: errors[429]})
    async def experiments() -> Response:
        """The experiments that come with the program, in the order of the papers."""
        limits.pass_on("experiments")
        cards = [] if gallery is None else await asyncio.to_thread(gallery.cards)
        return json_response(to_json([card.model_dump() for card in cards]))

    @app.get("/api/experiments/{name}", tags=["experiments"], responses={200: {"model": Detail}, **errors})
    async def experiment(name: Name) -> Response:
        """One experiment, with the trials of it that were run here. `watch_experiment` plays one from its moment."""
        limits.pass_on("experiments")
        detail = None if gallery is None else await asyncio.to_thread(gallery.detail, name)
        if detail is None:
            raise Declined.of(404, f"there is no experiment {name[:40]!r}; /api/experiments lists them")
        return json_response(to_json(detail.model_dump()))

    @app.get("/api/experiments/{name}/picture", tags=["experiments"], responses={404: errors[404]})
    async def picture(name: Name) -> Response:
        """Its first figure as SVG or PNG: the newest that was drawn here, or the one that comes with the program."""
        path = None if gallery is None else await asyncio.to_thread(gallery.picture, name)
        if path is None:
            raise Declined.of(404, f"there is no picture of {name[:40]!r}")
        return FileResponse(path, media_type=TYPES[path.suffix], headers={"Cache-Control": "no-cache"})


# ------------------------------------------------------------ lessons


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
    """All that the page tells of a lesson, but what happens in it. text: the paper's passage; more: what else is known of the
    outcome; explains: Inspect tells why when it is over."""

    card: LessonCard
    text: str
    more: str | None
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
