"""The commands of lessons, and running until something happens."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from web.messages.command import CommandModel, Finite
from web.messages.command import Label as _Label


class BeginLesson(CommandModel):
    """Begin a lesson, by its name in /api/lessons, in a run of its own. seed: another than the lesson's."""

    type: Literal["begin_lesson"]
    name: _Label
    seed: Annotated[int, Field(ge=0, lt=2**31)] | None = None


class Predict(CommandModel):
    """The prediction that is compared with what happens: an option by its number, from 0, or a point (m) on the plate on
    which the lesson asks for one. It can be changed until it is shown."""

    type: Literal["predict"]
    choice: Annotated[int, Field(ge=0, le=9)] | None = None
    x: Finite | None = None
    y: Finite | None = None


class Vote(CommandModel):
    """As `predict`, by one of a class: voter is a text that each page makes up for itself, and each voter counts once.
    sender: the address it comes from, which the server tells."""

    type: Literal["vote"]
    lesson: _Label
    voter: Annotated[_Label, Field(min_length=8)]
    sender: Annotated[str, Field(max_length=64)] = ""
    choice: Annotated[int, Field(ge=0, le=9)] | None = None
    x: Finite | None = None
    y: Finite | None = None


class ShowLesson(CommandModel):
    """Let it happen; also without a prediction. Between two rounds: begin the next one."""

    type: Literal["show_lesson"]


class LessonAgain(CommandModel):
    """Begin the lesson anew, with the same seed."""

    type: Literal["lesson_again"]


class EndLesson(CommandModel):
    """Leave the lesson. Its run goes on, or stays paused, as it is."""

    type: Literal["end_lesson"]


class RunUntil(CommandModel):
    """Run as fast as possible until this happens, and pause exactly then; or until `within_s` simulated seconds have passed.

    count: of packets; place: a place of the office by name, or x and y (m, office frame), which the robot comes near.
    """

    type: Literal["run_until"]
    what: Literal["closure", "snap", "lost", "found again", "packets", "goal reached", "place"]
    within_s: Annotated[float, Field(gt=0, le=36000)] = 600.0
    count: Annotated[int, Field(ge=2, le=9)] = 2
    place: _Label | None = None
    x: Finite | None = None
    y: Finite | None = None


LessonOrder = BeginLesson | Predict | Vote | ShowLesson | LessonAgain | EndLesson | RunUntil
