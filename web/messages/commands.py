"""The commands that people give the engine: pydantic models, strict and closed. Names and docstrings are the HTTP API's."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from web.messages.command import CommandModel, EngineName, Finite
from web.messages.command import Label as _Label
from web.messages.command import Name as _Name
from web.messages.lesson_orders import LessonOrder
from web.messages.office_orders import EditOrder, OfficeOrder
from web.messages.time_orders import TimeOrder


class SetGoal(CommandModel):
    """Go to this place of the map (metres, map frame): to the quickest of all experiences that stand for it."""

    type: Literal["set_goal"]
    x: Finite
    y: Finite


class CancelGoal(CommandModel):
    type: Literal["cancel_goal"]


class Tag(CommandModel):
    """Name the place where the robot believes itself to be, to send it there later. A name that is given again moves."""

    type: Literal["tag"]
    name: _Name


class Untag(CommandModel):
    type: Literal["untag"]
    name: _Name


class GoToTag(CommandModel):
    """Go to the place that was given this name."""

    type: Literal["go_to_tag"]
    name: _Name


class SetMode(CommandModel):
    type: Literal["set_mode"]
    mode: Literal["explore", "manual", "goal"]


class Drive(CommandModel):
    """Drive by hand. m/s forwards, rad/s counter-clockwise. Stops 0.3 s after the last such command."""

    type: Literal["drive"]
    speed: Annotated[float, Field(ge=-0.5, le=0.5)]
    yaw_rate: Annotated[float, Field(ge=-1.6, le=1.6)]


class Kidnap(CommandModel):
    """Put the robot elsewhere (office frame) without telling it. Without a place, a random free one is taken."""

    type: Literal["kidnap"]
    x: Finite | None = None
    y: Finite | None = None
    heading_rad: Finite | None = None


class Pause(CommandModel):
    type: Literal["pause"]


class Resume(CommandModel):
    type: Literal["resume"]


class Step(CommandModel):
    """Pause and advance by this many ticks of 0.1 s."""

    type: Literal["step"]
    ticks: Annotated[int, Field(ge=1, le=1000)] = 1


SLOWEST, FASTEST = 0.25, 16.0  # what the page offers besides "as fast as possible"
SPEEDS = f"0 (as fast as possible) or from {SLOWEST:g} to {FASTEST:g}"
_SPEED_SCHEMA = {"anyOf": [{"const": 0}, {"type": "number", "minimum": SLOWEST, "maximum": FASTEST}]}


def is_speed(factor: float) -> bool:
    """Whether a session can run at this speed; `SPEEDS` says which are possible."""
    return factor == 0 or SLOWEST <= factor <= FASTEST


def _speed(factor: float) -> float:
    if not is_speed(factor):
        raise PydanticCustomError("speed", "must be {speeds}", {"speeds": SPEEDS})
    return factor


class SetSpeed(CommandModel):
    """Simulated seconds per second; 0 = as fast as possible."""

    type: Literal["set_speed"]
    factor: Annotated[float, AfterValidator(_speed), WithJsonSchema(_SPEED_SCHEMA)]


class Reset(CommandModel):
    """Start anew. Fields that are left out keep their values."""

    type: Literal["reset"]
    world: _Label | None = None
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] | None = None


class SetParameter(CommandModel):
    type: Literal["set_parameter"]
    name: _Label
    value: float | int | bool | _Label


class StepStage(CommandModel):
    """Pause and show the next stage of a tick, or the previous one. After the last stage the next tick begins."""

    type: Literal["step_stage"]
    back: bool = False


class InjectPacket(CommandModel):
    """Add a packet of activity at a place in the pose cells (cells, radians), to watch it compete. No sensor supports it.

    share: of all activity afterwards.
    """

    type: Literal["inject_packet"]
    x: Annotated[int, Field(ge=0)]
    y: Annotated[int, Field(ge=0)]
    heading_rad: Finite = 0.0
    share: Annotated[float, Field(ge=0.01, le=0.95)] = 0.45


class Inspect(CommandModel):
    """Choose what everybody inspects: an experience, a view, the pose cells at x', y', or why an event happened. Without
    any of them: nothing.

    Changes nothing in the robot.
    """

    type: Literal["inspect"]
    experience: Annotated[int, Field(ge=0)] | None = None
    view: Annotated[int, Field(ge=0)] | None = None
    x: Annotated[int, Field(ge=0)] | None = None
    y: Annotated[int, Field(ge=0)] | None = None
    event: Annotated[int, Field(ge=1)] | None = None


class WatchExperiment(CommandModel):
    """Begin a trial of an experiment and watch it. What is left out is as the experiment's file says.

    levels: one label of each axis. trial: the id of a trial that was run, to be told if it would not be the same run today.
    moment_s: the trial is first run ahead, as fast as possible, to ten seconds before this simulated time.
    """

    type: Literal["watch_experiment"]
    experiment: _Label
    engine: EngineName | None = None
    levels: Annotated[list[_Label], Field(max_length=8)] | None = None
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] | None = None
    quick: bool = False  # the shortened trial
    trial: _Label | None = None
    moment_s: Annotated[float, Field(ge=0, le=1e7)] | None = None


class CompareBrains(CommandModel):
    """Give a second brain the same senses, and show both. It differs from the first in the parameters of a named pair, or in
    `values`, and changes nothing in the first.

    pair: papers, vision, cells, cells-64, rate, no-map; or one of our additions by its name, such as "exact solver": the
    second does without it, or has it if the first does without. since: "beginning" begins the run anew with both, "now"
    goes on with a copy of the first.
    """

    type: Literal["compare_brains"]
    pair: _Name | None = None
    values: (
        Annotated[
            dict[_Label, float | int | bool | _Label],
            Field(min_length=1, max_length=200),
        ]
        | None
    ) = None
    name: _Name | None = None  # of the second
    since: Literal["beginning", "now"] = "beginning"


class EndComparison(CommandModel):
    """Go on with the first brain alone. The last figures of both stay on the timeline."""

    type: Literal["end_comparison"]


TagOrder = Tag | Untag | GoToTag
BrainOrder = CompareBrains | EndComparison
LookOrder = Inspect | StepStage | InjectPacket
Command = Annotated[
    SetGoal
    | CancelGoal
    | TagOrder
    | SetMode
    | Drive
    | Kidnap
    | Pause
    | Resume
    | Step
    | SetSpeed
    | Reset
    | SetParameter
    | OfficeOrder
    | EditOrder
    | LookOrder
    | BrainOrder
    | TimeOrder
    | LessonOrder
    | WatchExperiment,
    Field(discriminator="type"),
]
