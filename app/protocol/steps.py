"""The steps of a protocol, as they stand in the file of an experiment or a lesson (docs/experiments.md tells how to use them).

A kind of step is one class: its values, what it needs, about how long it takes, and how it is carried out. A new one is a
class and its name in `Step`, at the end.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from disk.words import lines, one_line
from web.messages.commands import Name

if TYPE_CHECKING:
    from app.protocol.course import Course
    from app.session import Session
    from sim2d import World

Line = Annotated[str, Field(min_length=1, max_length=160), AfterValidator(one_line)]
Text = Annotated[str, Field(min_length=1, max_length=700), AfterValidator(lines)]
Seconds = Annotated[float, Field(gt=0, le=1e6)]
Metres = Annotated[float, Field(gt=0, le=1e4)]
WorldName = Annotated[str, Field(min_length=1, max_length=4096), AfterValidator(one_line)]  # or the path of a file
Where = Name | tuple[float, float]  # a place of the world by name, or (x, y) in metres, office frame
Values = dict[Line, float | int | bool | Line]  # parameters by dotted names

VISIT_S = 40.0  # about what it takes to be sent somewhere
REACHED_M = 0.25  # a driven robot has come to a point of its path
PATIENCE_S = 60.0  # a point of the path that takes longer is left out: somebody stands there
AIM_S = 0.5  # the driver corrects the heading within this time
MOST_TURN = 1.0  # rad/s, of a driven robot
SHARP_RAD = 0.6  # it turns on the spot if its next point lies farther aside than this
STANDING = (0.0, 0.0)
_TRIES = 200  # random places tried to find one that is far enough away
_STREAM = 2  # of the run's seed; session.py and headless/run.py use others


class Part(BaseModel):
    """A part of the file of an experiment or lesson: nothing in it is unknown, nothing changes."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class StepBase(Part):
    """What every step can be asked. A step overrides what is its own."""

    def needs_places(self) -> Sequence[Where]:
        """That the world must have."""
        return ()

    def needs_tags(self) -> Sequence[str]:
        """That must have been given before."""
        return ()

    def gives_tags(self) -> Sequence[str]:
        return ()

    def count_visits(self) -> int:
        """How often it sends the robot somewhere, and judges whether it has come there."""
        return 0

    def count_kidnaps(self) -> int:
        return 0

    def about_s(self) -> float:
        """About how long it takes, simulated."""
        return 0.0

    def shortened(self, share: float) -> Self:  # noqa: ARG002
        """The same in this share of its time, where it has one."""
        return self

    def check(self, session: Session) -> None:
        """ValueError names what does not exist here."""

    def carry_out(self, course: Course) -> Iterator[str]:
        """What is being done, before each tick."""
        self.at_once(course)
        return iter(())

    def at_once(self, course: Course) -> None:
        """Carry out a step that takes no time."""


class Explore(StepBase):
    """The robot explores by itself for so long, or until it has found itself again after a kidnap."""

    do: Literal["explore"] = "explore"
    minutes: Annotated[float, Field(gt=0, le=1e6)]
    until: Literal["the end", "recovered"] = "the end"

    def about_s(self) -> float:
        return self.minutes * 60 * (1.0 if self.until == "the end" else 0.5)

    def shortened(self, share: float) -> Self:
        return self.model_copy(update={"minutes": self.minutes * share})

    def carry_out(self, course: Course) -> Iterator[str]:
        evaluation = course.session.evaluation
        course.session.set_mode("explore")
        for _ in range(course.ticks_in(self.minutes * 60)):
            yield from course.tick("exploring")
            kidnaps = evaluation.kidnaps
            if self.until == "recovered" and (not kidnaps or kidnaps[-1].after_s is not None):
                break
        if self.until == "recovered" and evaluation.kidnaps:
            course.judge_kidnap()


class Drive(StepBase):
    """Somebody drives the robot along a path, from place to place, seeing where it truly is."""

    do: Literal["drive"] = "drive"
    path: Annotated[list[Where], Field(min_length=1)]
    laps: Annotated[int, Field(ge=1, le=10_000)] = 1
    speed: Annotated[float, Field(gt=0, le=2)] = 0.3  # m/s
    look_back_m: Annotated[float, Field(ge=0.1, le=1000)] | None = (
        None  # of path, after which it looks back: IROS 2005 IV.D
    )

    def needs_places(self) -> Sequence[Where]:
        return self.path

    def about_s(self) -> float:
        return 15.0 * len(self.path) * self.laps

    def shortened(self, share: float) -> Self:
        laps = self.laps * share
        path = self.path if laps >= 1 else self.path[: max(1, round(len(self.path) * laps))]
        return self.model_copy(update={"laps": max(1, round(laps)), "path": path})

    def carry_out(self, course: Course) -> Iterator[str]:
        path = [course.place(where) for where in self.path]
        stops = path if self.look_back_m is None else list(looking_back(path, self.look_back_m))
        for lap in range(self.laps):
            for place in stops:
                yield from self._drive_to(course, place, f"driven, lap {lap + 1} of {self.laps}")
        course.session.drive(*STANDING)

    def _drive_to(self, course: Course, place: tuple[float, float], what: str) -> Iterator[str]:
        session, began_s = course.session, course.session.time_s
        while math.dist(course.here, place) > REACHED_M:
            if session.time_s - began_s > PATIENCE_S:
                course.mark(f"({place[0]:g}, {place[1]:g}) could not be driven to, and is left out")
                return
            truth = session.simulator.truth
            aside = math.remainder(math.atan2(place[1] - truth.y, place[0] - truth.x) - truth.heading_rad, math.tau)
            turn = max(-MOST_TURN, min(MOST_TURN, aside / max(AIM_S, session.frame.dt)))
            session.drive(self.speed * math.cos(aside) if abs(aside) < SHARP_RAD else 0.0, turn)
            yield from course.tick(what)


def looking_back(path: Sequence[tuple[float, float]], every_m: float) -> Iterator[tuple[float, float]]:
    """The stops on a path that is driven in stretches of this length: each there, back and there again. IROS 2005 IV.D.

    test_course.py::test_who_looks_back_drives_each_stretch_three_times."""
    stretches, left_m = [[path[0]]], every_m
    for end in path[1:]:
        while (away := math.dist(at := stretches[-1][-1], end)) > left_m:
            share = left_m / away
            cut = at[0] + share * (end[0] - at[0]), at[1] + share * (end[1] - at[1])
            stretches[-1].append(cut)
            stretches.append([cut])
            left_m = every_m
        stretches[-1].append(end)
        left_m -= away
    yield path[0]
    for first, *rest in stretches:
        yield from (*rest, *rest[-2::-1], first, *rest)


class Move(StepBase):
    """The wheels are given these speeds: m/s forwards, degrees/s counter-clockwise, seconds."""

    do: Literal["move"] = "move"
    moves: Annotated[list[tuple[float, float, Seconds]], Field(min_length=1)]
    times: Annotated[int, Field(ge=1, le=10_000)] = 1

    def about_s(self) -> float:
        return self.times * sum(seconds for _, _, seconds in self.moves)

    def shortened(self, share: float) -> Self:
        return self.model_copy(update={"times": max(1, round(self.times * share))})

    def carry_out(self, course: Course) -> Iterator[str]:
        for _ in range(self.times):
            for speed, turn_deg, seconds in self.moves:
                course.session.drive(speed, math.radians(turn_deg))
                yield from course.ticks_for(seconds, "moved")
        course.session.drive(*STANDING)


class Kidnap(StepBase):
    """The robot is put elsewhere, or only turned, and is not told.

    place: where to; without one, by chance at least `least_m` away. heading_deg: which way it then faces; without one, by
    chance at a place by chance, else as before. turn_deg: it stays where it is and is turned so far.
    """

    do: Literal["kidnap"] = "kidnap"
    place: Where | None = None
    heading_deg: float | None = None
    turn_deg: float | None = None
    least_m: Annotated[float, Field(ge=0, le=1e4)] = 0.0

    @model_validator(mode="after")
    def _one_of(self) -> Kidnap:
        if self.turn_deg is not None and (self.place is not None or self.heading_deg is not None or self.least_m):
            raise ValueError("turn_deg turns the robot where it is; leave out place, heading_deg and least_m")
        return self

    def needs_places(self) -> Sequence[Where]:
        return () if self.place is None else [self.place]

    def count_kidnaps(self) -> int:
        return 1

    def at_once(self, course: Course) -> None:
        session, truth = course.session, course.session.simulator.truth
        heading = None if self.heading_deg is None else math.radians(self.heading_deg)
        if self.turn_deg is not None:
            session.kidnap(truth.x, truth.y, truth.heading_rad + math.radians(self.turn_deg))
        elif self.place is not None:
            session.kidnap(*course.place(self.place), heading)
        else:
            x, y, by_chance = self._far_away(course)
            session.kidnap(x, y, by_chance if heading is None else heading)
        course.mark("kidnapped", kind="kidnap")

    def _far_away(self, course: Course) -> tuple[float, float, float]:
        for _ in range(_TRIES):
            x, y, heading = course.session.random_free_pose()
            if math.dist((x, y), course.here) >= self.least_m:
                return x, y, heading
        raise ValueError(
            f"least_m = {self.least_m:g}: no free place so far from the robot in {course.session.world.name}"
        )


class Tag(StepBase):
    """From now on: the first time that the robot comes near each of these places, what it experiences there is tagged."""

    do: Literal["tag"] = "tag"
    places: Annotated[list[Name], Field(min_length=1)]
    within_m: Metres = 1.0

    def needs_places(self) -> Sequence[Where]:
        return self.places

    def gives_tags(self) -> Sequence[str]:
        return self.places

    def at_once(self, course: Course) -> None:
        for name in self.places:
            course.tag(name, course.place(name), self.within_m)


class TagHere(StepBase):
    """What the robot experiences now is tagged, by this name."""

    do: Literal["tag here"] = "tag here"
    name: Name

    def gives_tags(self) -> Sequence[str]:
        return [self.name]

    def at_once(self, course: Course) -> None:
        course.tag(self.name, course.here, experience=course.session.brain.experience_map.active)
        course.mark(f"{self.name} is tagged, here", kind="tagged")


class Send(StepBase):
    """The robot is sent to a tagged place, and for so long at most: the next goal finds it on the way."""

    do: Literal["send"] = "send"
    place: Name
    seconds: Seconds

    def needs_tags(self) -> Sequence[str]:
        return [self.place]

    def about_s(self) -> float:
        return self.seconds

    def carry_out(self, course: Course) -> Iterator[str]:
        experience = course.tags[self.place].experience
        if experience is None:
            course.mark(f"{self.place} was never approached, so that nobody is sent there")
            return
        course.session.go_to(experience)
        for what in course.ticks_for(self.seconds, f"sent to {self.place}"):
            if course.session.pilot.goal_state == (experience, "arrived"):
                course.mark(f"arrived at {self.place} before it was called back")
                return
            yield what
        course.mark(f"called back from the way to {self.place}")


class Visit(StepBase):
    """The robot is sent to these tagged places, one after the other. It has reached one if it says so and truly is near."""

    do: Literal["visit"] = "visit"
    places: Annotated[list[Name], Field(min_length=1)]
    timeout_s: Seconds = 180.0
    near_m: Metres = 1.0

    def needs_tags(self) -> Sequence[str]:
        return self.places

    def count_visits(self) -> int:
        return len(self.places)

    def about_s(self) -> float:
        return VISIT_S * len(self.places)

    def shortened(self, share: float) -> Self:
        return self.model_copy(update={"timeout_s": self.timeout_s * share})

    def carry_out(self, course: Course) -> Iterator[str]:
        for name in self.places:
            tag = course.tags[name]
            tag.passed = True  # what stands for a place does not change once the robot is sent there
            yield from course.go(name, tag.experience, (tag.x, tag.y), self.timeout_s, self.near_m)


class Tour(StepBase):
    """The robot is sent to places spread over its map, which are tagged `goal 1`, `goal 2` ..., `visits` times in all; in every
    round to each, in a new order.

    It has come to a place if it says so and truly is within `near_m` of where it had made that experience.
    """

    do: Literal["tour"] = "tour"
    goals: Annotated[int, Field(ge=1, le=1000)]
    visits: Annotated[int, Field(ge=1, le=1_000_000)]
    timeout_s: Seconds = 180.0
    near_m: Metres = 1.0

    def gives_tags(self) -> Sequence[str]:
        return [f"goal {number}" for number in range(1, self.goals + 1)]

    def count_visits(self) -> int:
        return self.visits

    def about_s(self) -> float:
        return VISIT_S * self.visits

    def shortened(self, share: float) -> Self:
        visits = max(1, round(self.visits * share))
        return self.model_copy(update={"visits": visits, "goals": min(self.goals, visits)})

    def carry_out(self, course: Course) -> Iterator[str]:
        """ValueError: the robot does not know so many places."""
        session, map_ = course.session, course.session.brain.experience_map
        goals = spread_goals(session, self.goals)
        if len(goals) < self.goals:
            raise ValueError(
                f"goals = {self.goals}, but the robot knows only {len(goals)} places; let it explore longer"
            )
        for name, goal in zip(self.gives_tags(), goals, strict=True):
            course.tag(name, session.evaluation.made_at(goal, map_), experience=goal)
        tags = [course.tags[name] for name in self.gives_tags()]
        for number, goal in enumerate(order(self.goals, self.visits, session.seed), start=1):
            tag, name = tags[goal], f"visit {number} of {self.visits}"
            yield from course.go(name, tag.experience, (tag.x, tag.y), self.timeout_s, self.near_m)


def spread_goals(session: Session, count: int) -> list[int]:
    """`count` experiences spread over the map. Each is the one farthest from the robot and from those chosen before."""
    poses = session.brain.experience_map.poses
    robot = session.brain.experience_map.robot
    away = np.hypot(poses[:, 0] - robot.x, poses[:, 1] - robot.y)
    chosen: list[int] = []
    for _ in range(min(count, len(poses))):
        chosen.append(int(np.argmax(away)))
        away = np.minimum(away, np.hypot(*(poses[:, :2] - poses[chosen[-1], :2]).T))
    return chosen


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


class Click(StepBase):
    """Somebody clicks the map at what stands for this place, and the robot goes there, or gives up after so long.

    The click is as exact as the map: it falls where the map has what the robot experienced nearest to the place.
    """

    do: Literal["click"] = "click"
    place: Where
    timeout_s: Seconds = 120.0
    near_m: Metres = 1.0

    def needs_places(self) -> Sequence[Where]:
        return [self.place]

    def count_visits(self) -> int:
        return 1

    def about_s(self) -> float:
        return 30.0

    def carry_out(self, course: Course) -> Iterator[str]:
        session, map_ = course.session, course.session.brain.experience_map
        x, y = course.place(self.place)
        births = session.evaluation.births(len(map_))
        nearest = int(np.nanargmin(np.hypot(births[:, 0] - x, births[:, 1] - y)))
        place = float(births[nearest, 0]), float(births[nearest, 1])
        name = self.place if isinstance(self.place, str) else "the place that was clicked"
        experience = session.set_goal(float(map_.poses[nearest, 0]), float(map_.poses[nearest, 1]))
        course.mark(f"{name} is clicked on the map: to experience {experience}")
        yield from course.go(name, experience, place, self.timeout_s, self.near_m, is_sent=True)


class PutPacket(StepBase):
    """A packet of activity is put into the pose cells by hand, so far from the winner (cells, layers). No sensor asks for it."""

    do: Literal["packet"] = "packet"
    away: tuple[int, int]  # cells along x' and y'
    layers: int = 0
    share: Annotated[float, Field(ge=0.01, le=0.95)] = 0.4  # of all activity afterwards

    def at_once(self, course: Course) -> None:
        cells = course.session.brain.pose_cells
        n_theta, n_y, n_x = cells.shape
        x, y = round(cells.winner.x + self.away[0]) % n_x, round(cells.winner.y + self.away[1]) % n_y
        heading = cells.winner.heading_rad + self.layers * math.tau / n_theta
        words = course.session.put_packet(x, y, math.remainder(heading, math.tau), self.share)
        course.mark(words, kind="packet")


class Wait(StepBase):
    """The robot stands still."""

    do: Literal["wait"] = "wait"
    seconds: Seconds

    def about_s(self) -> float:
        return self.seconds

    def shortened(self, share: float) -> Self:
        return self.model_copy(update={"seconds": self.seconds * share})

    def carry_out(self, course: Course) -> Iterator[str]:
        course.session.drive(*STANDING)
        yield from course.ticks_for(self.seconds, "waiting")


class Set(StepBase):
    """Parameters change while the robot runs."""

    do: Literal["set"] = "set"
    values: Values

    def check(self, session: Session) -> None:
        session.config.with_values(self.values)

    def at_once(self, course: Course) -> None:
        course.session.set_parameters(self.values)
        course.mark(", ".join(f"{name} = {value}" for name, value in self.values.items()))


class Door(StepBase):
    """A door of the office is opened or shut."""

    do: Literal["door"] = "door"
    name: Name
    open: bool

    def check(self, session: Session) -> None:
        names = [door.name for door in session.world.doors]
        if self.name not in names:
            known = ", ".join(names) or "there are none"
            raise ValueError(f"no door {self.name!r} in {session.world.name}; expected one of: {known}")

    def at_once(self, course: Course) -> None:
        course.session.set_door(self.name, self.open)
        course.mark(f"{self.name} {'opens' if self.open else 'shuts'}")


class Repeat(StepBase):
    """These steps so many times."""

    do: Literal["repeat"] = "repeat"
    times: Annotated[int, Field(ge=1, le=10_000)]
    steps: Annotated[list[Step], Field(min_length=1)]

    def count_visits(self) -> int:
        return self.times * sum(step.count_visits() for step in self.steps)

    def count_kidnaps(self) -> int:
        return self.times * sum(step.count_kidnaps() for step in self.steps)

    def about_s(self) -> float:
        return self.times * sum(step.about_s() for step in self.steps)

    def shortened(self, share: float) -> Self:
        steps = [step.shortened(share) for step in self.steps]
        return self.model_copy(update={"steps": steps, "times": max(1, round(self.times * share))})

    def carry_out(self, course: Course) -> Iterator[str]:
        for _ in range(self.times):
            yield from course.ticks_of(self.steps)


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


def check_steps(session: Session, steps: Sequence[Step], tagged: frozenset[str] = frozenset()) -> frozenset[str]:
    """ValueError names a place, door or parameter that does not exist, or a goal that nothing has tagged. Returns the tags."""
    for step in steps:
        if isinstance(step, Repeat):
            tagged = check_steps(session, step.steps, tagged)
        step.check(session)
        for where in step.needs_places():
            place_of(session.world, where)
        missing = [name for name in step.needs_tags() if name not in tagged]
        if missing:
            raise ValueError(f"{step.do} {missing[0]!r}: nothing is tagged so before; tag it first")
        tagged |= set(step.gives_tags())
    return tagged
