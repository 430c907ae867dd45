"""The steps that protocols are made of, as they stand in the file of an experiment or lesson (docs/experiments.md tells how
to use them), and whether they fit the world and the parameters, before the first of them is carried out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from disk.words import lines, one_line
from web.messages.commands import Name

if TYPE_CHECKING:
    from app.session import Session
    from sim2d import World

_STREAM = 2  # of the run's seed; session.py and headless/run.py use others


def order(goals: int, visits: int, seed: int) -> Iterator[int]:
    """The goal of each visit: every round visits all goals in a new order, never the same twice in a row."""
    rng = np.random.default_rng([seed, _STREAM])
    last = -1
    for first in range(0, visits, goals):
        round_ = [int(goal) for goal in rng.permutation(goals)]
        if round_[0] == last and goals > 1:
            round_ = [*round_[1:], last]
        last = round_[-1]
        yield from round_[: visits - first]


Line = Annotated[str, Field(min_length=1, max_length=160), AfterValidator(one_line)]
Text = Annotated[str, Field(min_length=1, max_length=700), AfterValidator(lines)]
Seconds = Annotated[float, Field(gt=0, le=1e6)]
Metres = Annotated[float, Field(gt=0, le=1e4)]
WorldName = Annotated[str, Field(min_length=1, max_length=4096), AfterValidator(one_line)]  # or the path of a file
Where = Name | tuple[float, float]  # a place of the world by name, or (x, y) in metres, office frame
Values = dict[Line, float | int | bool | Line]  # parameters by dotted names


class _Step(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Explore(_Step):
    """The robot explores by itself for so long, or until it has found itself again after a kidnap."""

    do: Literal["explore"]
    minutes: Annotated[float, Field(gt=0, le=1e5)]
    until: Literal["the end", "recovered"] = "the end"


class Drive(_Step):
    """Somebody drives the robot along a path, from place to place, seeing where it truly is."""

    do: Literal["drive"]
    path: Annotated[list[Where], Field(min_length=1)]
    laps: Annotated[int, Field(ge=1, le=10_000)] = 1
    speed: Annotated[float, Field(gt=0, le=2)] = 0.3  # m/s


class Move(_Step):
    """The wheels are given these speeds: m/s forwards, degrees/s counter-clockwise, seconds."""

    do: Literal["move"]
    moves: Annotated[list[tuple[float, float, Seconds]], Field(min_length=1)]
    times: Annotated[int, Field(ge=1, le=10_000)] = 1


class Kidnap(_Step):
    """The robot is put elsewhere, or only turned, and is not told.

    place: where to; without one, by chance at least `least_m` away. heading_deg: which way it then faces; without one, by
    chance at a place by chance, else as before. turn_deg: it stays where it is and is turned so far.
    """

    do: Literal["kidnap"]
    place: Where | None = None
    heading_deg: float | None = None
    turn_deg: float | None = None
    least_m: Annotated[float, Field(ge=0, le=1e4)] = 0.0

    @model_validator(mode="after")
    def _one_of(self) -> Kidnap:
        if self.turn_deg is not None and (self.place is not None or self.heading_deg is not None or self.least_m):
            raise ValueError("turn_deg turns the robot where it is; leave out place, heading_deg and least_m")
        return self


class Tag(_Step):
    """From now on: the first time that the robot comes near each of these places, what it experiences there is tagged."""

    do: Literal["tag"]
    places: Annotated[list[Name], Field(min_length=1)]
    within_m: Metres = 1.0


class TagHere(_Step):
    """What the robot experiences now is tagged, by this name."""

    do: Literal["tag here"]
    name: Name


class Send(_Step):
    """The robot is sent to a tagged place, and for so long at most: the next goal finds it on the way."""

    do: Literal["send"]
    place: Name
    seconds: Seconds


class Visit(_Step):
    """The robot is sent to these tagged places, one after the other. It has reached one if it says so and truly is near."""

    do: Literal["visit"]
    places: Annotated[list[Name], Field(min_length=1)]
    timeout_s: Seconds = 180.0
    near_m: Metres = 1.0


class Tour(_Step):
    """The robot is sent to places spread over its map, `visits` times in all; in every round to each, in a new order.

    It has come to a place if it says so and truly is within `near_m` of where it had made that experience.
    """

    do: Literal["tour"]
    goals: Annotated[int, Field(ge=1, le=1000)]
    visits: Annotated[int, Field(ge=1, le=100_000)]
    timeout_s: Seconds = 180.0
    near_m: Metres = 1.0


class Click(_Step):
    """Somebody clicks the map at what stands for this place, and the robot goes there, or gives up after so long."""

    do: Literal["click"]
    place: Where
    timeout_s: Seconds = 120.0
    near_m: Metres = 1.0


class PutPacket(_Step):
    """A packet of activity is put into the pose cells by hand, so far from the winner (cells, layers). No sensor asks for it."""

    do: Literal["packet"]
    away: tuple[int, int]  # cells along x' and y'
    layers: int = 0
    share: Annotated[float, Field(ge=0.01, le=0.95)] = 0.4  # of all activity afterwards


class Wait(_Step):
    """The robot stands still."""

    do: Literal["wait"]
    seconds: Seconds


class Set(_Step):
    """Parameters change while the robot runs."""

    do: Literal["set"]
    values: Values


class Door(_Step):
    """A door of the office is opened or shut."""

    do: Literal["door"]
    name: Name
    open: bool


class Repeat(_Step):
    """These steps so many times."""

    do: Literal["repeat"]
    times: Annotated[int, Field(ge=1, le=10_000)]
    steps: Annotated[list[Step], Field(min_length=1)]


Step = Annotated[
    Explore
    | Drive
    | Move
    | Kidnap
    | Tag
    | TagHere
    | Send
    | Visit
    | Tour
    | Click
    | PutPacket
    | Wait
    | Set
    | Door
    | Repeat,
    Field(discriminator="do"),
]
Repeat.model_rebuild()


def place_of(world: World, where: Where) -> tuple[float, float]:
    """A place of the world by name, or the point itself (m, office frame). ValueError lists the names."""
    if not isinstance(where, str):
        return where
    known = [*world.places, *world.starts]
    for place in known:
        if place.name == where:
            return place.x, place.y
    names = ", ".join(place.name for place in known)
    raise ValueError(f"{world.name} has no place {where!r}; expected one of: {names}, or [x, y] in metres")


def check_steps(session: Session, steps: Sequence[Step], tagged: frozenset[str] = frozenset()) -> None:
    """ValueError names a place, door or parameter that does not exist, or a goal that nothing has tagged."""
    for step in steps:
        if isinstance(step, Repeat):
            check_steps(session, step.steps, tagged)
        elif isinstance(step, Tag):
            tagged |= set(step.places)
        elif isinstance(step, TagHere):
            tagged |= {step.name}
        elif isinstance(step, Set):
            session.config.with_values(step.values)
        elif isinstance(step, Door):
            _check_door(session.world, step.name)
        for where in _places(step):
            place_of(session.world, where)
        goals = step.places if isinstance(step, Visit) else [step.place] if isinstance(step, Send) else []
        missing = [name for name in goals if name not in tagged]
        if missing:
            raise ValueError(f"{step.do} {missing[0]!r}: nothing is tagged so before; tag it first")


def _places(step: Step) -> Sequence[Where]:
    match step:
        case Tag(places=places):
            return places
        case Drive(path=path):
            return path
        case Kidnap(place=place) if place is not None:
            return [place]
        case Click(place=place):
            return [place]
        case _:
            return []


def _check_door(world: World, name: str) -> None:
    names = [door.name for door in world.doors]
    if name not in names:
        raise ValueError(f"no door {name!r} in {world.name}; expected one of: {', '.join(names) or 'there are none'}")
