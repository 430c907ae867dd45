"""The lesson that a class is in, and what `run_until` waits for. Parts of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

LessonState = Literal["scene", "predict", "showing", "compared", "sandbox"]
UntilState = Literal["running", "met", "too late", "broken off"]


@dataclass(frozen=True, slots=True)
class LessonMark:
    """Something that happened, where it happened: m and rad, in the frame of its plate; among the pose cells x and y are cells.

    start: among the pose cells, where it came from: x and y in cells, and the heading.
    """

    plate: Literal["office", "map", "cells"]
    x: float
    y: float
    heading_rad: float | None
    words: str
    tick: int
    start: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class LessonPrediction:
    """An option by its number, from 0, or a point on the lesson's plate, m."""

    choice: int | None = None
    x: float | None = None
    y: float | None = None


@dataclass(frozen=True, slots=True)
class LessonVotes:
    """What the class predicts: votes for each option, or the points that were drawn."""

    counts: tuple[int, ...]
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class LessonOutcome:
    """What happened, beside what was predicted. right: None if nothing was predicted.

    choice: the option that came true; x, y: where it ended, m, on the lesson's plate; distance_m: from the prediction.
    """

    words: str
    because: str
    right: bool | None
    choice: int | None = None
    x: float | None = None
    y: float | None = None
    distance_m: float | None = None


@dataclass(frozen=True, slots=True)
class LessonView:
    """What the page tells of the lesson. Its texts: GET /api/lessons/NAME."""

    name: str
    title: str
    state: LessonState
    doing: str
    progress: float | None  # of the scene, or of what is shown
    round: int  # from 1; a lesson may be shown several times over, with other settings
    rounds: int
    label: str  # of the round
    seed: int
    prediction: LessonPrediction | None
    votes: LessonVotes
    outcome: LessonOutcome | None
    marks: tuple[LessonMark, ...]
    altered: bool  # somebody has changed something: it is no longer what the lesson promises
    draws: Literal["office", "map"] | None = None  # the plate on which a place is predicted; None: options are


@dataclass(frozen=True, slots=True)
class UntilView:
    """What `run_until` waits for, and how it ended. progress: share of the time that it may take."""

    what: str
    words: str
    state: UntilState
    progress: float
