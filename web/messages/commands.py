"""The commands that people give the engine: pydantic models, strict and closed. Names and docstrings are the HTTP API's.

A new command is its model here, in the union at the end; its handler in the file of app/commands that its noun belongs to
(what it raises as ValueError is a refusal), with a row in table.py there; and what gives it on the page.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Unpack

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from disk.words import one_line

Finite = Annotated[float, Field(allow_inf_nan=False)]
Name = Annotated[str, Field(min_length=1, max_length=40), AfterValidator(one_line)]
Label = Annotated[str, Field(max_length=64), AfterValidator(one_line)]

EngineName = Literal["paper", "paper-2005", "paper-2006", "ours"]  # whose rules; "paper": those of an experiment's own


Needs = Literal["robot", "office", "link"]


class CommandModel(BaseModel):
    """What all commands are: strict and closed. Each carries its own rules, as `class SetGoal(CommandModel, needs="robot")`.

    needs: what it needs of the session's source: a robot that can be driven, an office, or that a link can tell all of it.
    in_the_past: may be given while a moment of the past is shown, since it changes nothing, or begins another run.
    while_playing: may be given while a situation is played up to its moment.
    ends: why a trial that is watched ends by it, in words: the robot can have one master only.
    alters: by it, that trial is another run from there on.
    at: the field, or fields, that are wrong when it is refused.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)
    needs: ClassVar[Needs | None]
    in_the_past: ClassVar[bool]
    while_playing: ClassVar[bool]
    ends: ClassVar[str]
    alters: ClassVar[bool]
    at: ClassVar[str]

    def __init_subclass__(
        cls, *, needs: Needs | None = None, in_the_past: bool = False, while_playing: bool = False, ends: str = "",
        alters: bool = False, at: str = "type", **config: Unpack[ConfigDict],
    ) -> None:  # fmt: skip
        super().__init_subclass__(**config)
        cls.needs, cls.in_the_past, cls.while_playing = needs, in_the_past, while_playing
        cls.ends, cls.alters, cls.at = ends, alters, at


_Size = Annotated[float, Field(ge=0.05, le=20.0)]


class SetDoor(CommandModel, needs="office", alters=True, at="name"):
    """Open or shut a door of the office. It moves from the next tick on, and waits for anyone who stands in it."""

    type: Literal["set_door"]
    name: Name
    open: bool


class SetLamp(CommandModel, needs="office", alters=True, at="name"):
    type: Literal["set_lamp"]
    name: Name
    on: bool


class PutBox(CommandModel, needs="office", alters=True, at="name"):
    """Put a box down (office frame, metres). Refused where it would cover the robot. A reset removes it."""

    type: Literal["put_box"]
    name: Name
    x: Finite
    y: Finite
    width: _Size = 0.5
    depth: _Size = 0.5
    height: _Size = 0.6
    angle_rad: Finite = 0.0


class RemoveBox(CommandModel, needs="office", alters=True, at="name"):
    type: Literal["remove_box"]
    name: Name


class UsePreset(CommandModel, alters=True, at="name"):
    """Set the robot's sensors and encoders to a preset: "Pioneer 2DXE 2004" or "ideal"."""

    type: Literal["use_preset"]
    name: Name


OfficeList = Literal[
    "walls", "starts", "places", "doors", "lamps", "boxes", "people", "slow_zones", "script", "daylight"
]  # fmt: skip


class EditStep(CommandModel):
    """One item in one list of the world file: added at the end, changed, or deleted. `item` is written as in that file.

    `daylight` counts as a list of at most one item.
    """

    do: Literal["add", "change", "delete"]
    list: OfficeList
    number: Annotated[int, Field(ge=0, le=100_000)] | None = None  # of the item to change or delete, from 0
    item: dict[str, Any] | None = None  # the new item; a wall without a colour gets looks of its own


class EditWorld(CommandModel, needs="office", alters=True, at="steps"):
    """Change the office under the running robot: all steps or none. Refused when the world would not be valid, when the
    robot would be covered, or when the office is no longer the edition that the editor saw. Undone as one."""

    type: Literal["edit_world"]
    steps: Annotated[list[EditStep], Field(min_length=1, max_length=200)]
    edition: int | None = None


class UndoEdit(CommandModel, needs="office", alters=True):
    """Undo the last change of the office."""

    type: Literal["undo_edit"]


class RedoEdit(CommandModel, needs="office", alters=True):
    """Redo the change that was undone last."""

    type: Literal["redo_edit"]


OfficeOrder = SetDoor | SetLamp | PutBox | RemoveBox | UsePreset
EditOrder = EditWorld | UndoEdit | RedoEdit


_Moment = Annotated[float, Field(ge=0, le=1e9)]


class Seek(CommandModel, in_the_past=True, at="tick"):
    """Pause and show a moment of the run, by simulated time or by tick. From the last one on: the present. Changes nothing."""

    type: Literal["seek"]
    time_s: _Moment | None = None
    tick: Annotated[int, Field(ge=0, le=10**9)] | None = None


class BackToNow(CommandModel, in_the_past=True):
    """Show the present again, paused."""

    type: Literal["back_to_now"]


class GoOnFromHere(CommandModel, in_the_past=True):
    """Make the moment of the past that is shown the present of another branch. The run as it was stays as its own branch."""

    type: Literal["go_on_from_here"]


class GoOnWithout(CommandModel, in_the_past=True, at="event"):
    """Go back to before what led to this event, and go on in another branch in which the brain has forgotten the views that
    led to it."""

    type: Literal["go_on_without"]
    event: Annotated[int, Field(ge=1)]


class ChangeBranch(CommandModel, in_the_past=True, at="number"):
    """Go on with another branch, from its end."""

    type: Literal["change_branch"]
    number: Annotated[int, Field(ge=1, le=1000)]


class CompareBranch(CommandModel, in_the_past=True, at="number"):
    """Show another branch beside the live one, at the same time, and say where they differ first. Without a number: none."""

    type: Literal["compare_branch"]
    number: Annotated[int, Field(ge=1, le=1000)] | None = None


class Loop(CommandModel, in_the_past=True):
    """Play the past between two times (simulated seconds) again and again. Without them: no longer."""

    type: Literal["loop"]
    begin_s: _Moment | None = None
    end_s: _Moment | None = None


class PutBookmark(CommandModel, in_the_past=True, at="name"):
    """Name the moment that is shown, to come back to it; with a tick: give the bookmark there another name."""

    type: Literal["put_bookmark"]
    name: Annotated[str, Field(min_length=1, max_length=60), AfterValidator(one_line)]
    tick: Annotated[int, Field(ge=0, le=10**9)] | None = None


class RemoveBookmark(CommandModel, in_the_past=True, at="tick"):
    type: Literal["remove_bookmark"]
    tick: Annotated[int, Field(ge=0, le=10**9)]


class GoBack(CommandModel, in_the_past=True, while_playing=True):
    """Leave a lesson, a trial of an experiment or a situation: the run that it took the place of goes on as it was."""

    type: Literal["go_back"]


TimeOrder = (
    Seek
    | BackToNow
    | GoOnFromHere
    | GoOnWithout
    | ChangeBranch
    | CompareBranch
    | Loop
    | PutBookmark
    | RemoveBookmark
    | GoBack
)


class BeginLesson(CommandModel, in_the_past=True, at="name"):
    """Begin a lesson, by its name in /api/lessons, in a run of its own. seed: another than the lesson's."""

    type: Literal["begin_lesson"]
    name: Label
    seed: Annotated[int, Field(ge=0, lt=2**31)] | None = None


class Predict(CommandModel, in_the_past=True, at="choice"):
    """The prediction that is compared with what happens: an option by its number, from 0, or a point (m) on the plate on
    which the lesson asks for one. It can be changed until it is shown."""

    type: Literal["predict"]
    choice: Annotated[int, Field(ge=0, le=9)] | None = None
    x: Finite | None = None
    y: Finite | None = None


class Vote(CommandModel, in_the_past=True, at="choice"):
    """As `predict`, by one of a class: voter is a text that each page makes up for itself, and each voter counts once.
    sender: the address it comes from, which the server tells."""

    type: Literal["vote"]
    lesson: Label
    voter: Annotated[Label, Field(min_length=8)]
    sender: Annotated[str, Field(max_length=64)] = ""
    choice: Annotated[int, Field(ge=0, le=9)] | None = None
    x: Finite | None = None
    y: Finite | None = None


class ShowLesson(CommandModel, in_the_past=True):
    """Let it happen; also without a prediction. Between two rounds: begin the next one."""

    type: Literal["show_lesson"]


class LessonAgain(CommandModel, in_the_past=True):
    """Begin the lesson anew, with the same seed."""

    type: Literal["lesson_again"]


class EndLesson(CommandModel, in_the_past=True):
    """Leave the lesson. Its run goes on, or stays paused, as it is."""

    type: Literal["end_lesson"]


class RunUntil(CommandModel, needs="robot", in_the_past=True, at="what"):
    """Run as fast as possible until this happens, and pause exactly then; or until `within_s` simulated seconds have passed.

    count: of packets; place: a place of the office by name, or x and y (m, office frame), which the robot comes near.
    """

    type: Literal["run_until"]
    what: Literal["closure", "snap", "lost", "found again", "packets", "goal reached", "place", "explored"]
    within_s: Annotated[float, Field(gt=0, le=36000)] = 600.0
    count: Annotated[int, Field(ge=2, le=9)] = 2
    place: Label | None = None
    x: Finite | None = None
    y: Finite | None = None


LessonOrder = BeginLesson | Predict | Vote | ShowLesson | LessonAgain | EndLesson | RunUntil


class SetGoal(CommandModel, needs="robot", ends="somebody gave the robot a goal", at="x, y"):
    """Go to this place of the map (metres, map frame): to the quickest of all experiences that stand for it."""

    type: Literal["set_goal"]
    x: Finite
    y: Finite


class CancelGoal(CommandModel, needs="robot", ends="somebody cancelled the robot's goal"):
    type: Literal["cancel_goal"]


class Tag(CommandModel, at="name"):
    """Name the place where the robot believes itself to be, to send it there later. A name that is given again moves."""

    type: Literal["tag"]
    name: Name


class Untag(CommandModel, at="name"):
    type: Literal["untag"]
    name: Name


class GoToTag(CommandModel, needs="robot", ends="somebody gave the robot a goal", at="name"):
    """Go to the place that was given this name."""

    type: Literal["go_to_tag"]
    name: Name


class SetMode(CommandModel, needs="robot", ends="somebody told the robot what to do", at="mode"):
    type: Literal["set_mode"]
    mode: Literal["explore", "manual", "goal"]


class Drive(CommandModel, needs="robot", ends="somebody drove the robot by hand"):
    """Drive by hand. m/s forwards, rad/s counter-clockwise. Stops 0.3 s after the last such command."""

    type: Literal["drive"]
    speed: Annotated[float, Field(ge=-0.5, le=0.5)]
    yaw_rate: Annotated[float, Field(ge=-1.6, le=1.6)]


class Kidnap(CommandModel, needs="robot", ends="somebody carried the robot away", at="x, y"):
    """Put the robot elsewhere (office frame) without telling it. Without a place, a random free one is taken."""

    type: Literal["kidnap"]
    x: Finite | None = None
    y: Finite | None = None
    heading_rad: Finite | None = None


class Pause(CommandModel, in_the_past=True):
    type: Literal["pause"]


class Resume(CommandModel, in_the_past=True):
    type: Literal["resume"]


class Step(CommandModel, in_the_past=True):
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


class SetSpeed(CommandModel, in_the_past=True, while_playing=True):
    """Simulated seconds per second; 0 = as fast as possible."""

    type: Literal["set_speed"]
    factor: Annotated[float, AfterValidator(_speed), WithJsonSchema(_SPEED_SCHEMA)]


class Reset(CommandModel, in_the_past=True, while_playing=True):
    """Start anew. Fields that are left out keep their values."""

    type: Literal["reset"]
    world: Label | None = None
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] | None = None


class SetParameter(CommandModel, alters=True):
    type: Literal["set_parameter"]
    name: Label
    value: float | int | bool | Label


class StepStage(CommandModel, in_the_past=True):
    """Pause and show the next stage of a tick, or the previous one. After the last stage the next tick begins."""

    type: Literal["step_stage"]
    back: bool = False


class InjectPacket(CommandModel, alters=True, at="x, y"):
    """Add a packet of activity at a place in the pose cells (cells, radians), to watch it compete. No sensor supports it.

    share: of all activity afterwards.
    """

    type: Literal["inject_packet"]
    x: Annotated[int, Field(ge=0)]
    y: Annotated[int, Field(ge=0)]
    heading_rad: Finite = 0.0
    share: Annotated[float, Field(ge=0.01, le=0.95)] = 0.45


class Inspect(CommandModel, in_the_past=True, while_playing=True):
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


class WatchExperiment(CommandModel, in_the_past=True, while_playing=True):
    """Begin a trial of an experiment and watch it. What is left out is as the experiment's file says.

    levels: one label of each axis. trial: the id of a trial that was run, to be told if it would not be the same run today.
    moment_s: the trial is first run ahead, as fast as possible, to ten seconds before this simulated time.
    """

    type: Literal["watch_experiment"]
    experiment: Label
    engine: EngineName | None = None
    levels: Annotated[list[Label], Field(max_length=8)] | None = None
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] | None = None
    quick: bool = False  # the shortened trial
    trial: Label | None = None
    moment_s: Annotated[float, Field(ge=0, le=1e7)] | None = None


class CompareBrains(CommandModel, at="since"):
    """Give a second brain the same senses, and show both. It differs from the first in the parameters of a named pair, or in
    `values`, and changes nothing in the first.

    pair: papers, vision, cells, cells-64, rate, no-map; or one of our additions by its name, such as "exact solver": the
    second does without it, or has it if the first does without. since: "beginning" begins the run anew with both, "now"
    goes on with a copy of the first.
    """

    type: Literal["compare_brains"]
    pair: Name | None = None
    values: (
        Annotated[
            dict[Label, float | int | bool | Label],
            Field(min_length=1, max_length=200),
        ]
        | None
    ) = None
    name: Name | None = None  # of the second
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
