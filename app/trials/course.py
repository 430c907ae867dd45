"""A session taken through a protocol, step by step, and what the experimenter writes down on the way.

The experimenter sees where the robot truly is; the robot is given nothing but drives, goals and new surroundings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from app.session import Session, spread_goals
from app.trials.scores import Moment, MomentKind, Tagged, Visited
from app.trials.steps import (
    Click,
    Door,
    Drive,
    Explore,
    Kidnap,
    Move,
    PutPacket,
    Repeat,
    Send,
    Set,
    Step,
    Tag,
    TagHere,
    Tour,
    Visit,
    Wait,
    Where,
    check_steps,
    order,
    place_of,
)

REACHED_M = 0.25  # a driven robot has come to a point of its path
PATIENCE_S = 60.0  # a point of the path that takes longer is left out: somebody stands there
AIM_S = 0.5  # the driver corrects the heading within this time
MOST_TURN = 1.0  # rad/s, of a driven robot
SHARP_RAD = 0.6  # it turns on the spot if its next point lies farther aside than this
_TRIES = 200  # random places tried to find one that is far enough away
_STANDING = (0.0, 0.0)


class Course:
    """Take `ticks()` one by one, and run one tick of the session after each."""

    def __init__(self, session: Session, steps: Sequence[Step]) -> None:
        """ValueError names a place, door or parameter that does not exist."""
        self.session, self.steps = session, tuple(steps)
        self.tags: dict[str, Tagged] = {}
        self.visits: list[Visited] = []
        self.moments: list[Moment] = []
        check_steps(session, self.steps)

    def ticks(self) -> Iterator[str]:
        """What is being done, before each tick."""
        yield from self.ticks_of(self.steps)
        self.mark("the end", kind="end")

    def mark(self, words: str, ok: bool | None = None, kind: MomentKind | None = None) -> None:
        """Write down that something happens now."""
        judged: MomentKind = "step" if ok is None else "reached" if ok else "failed"
        self.moments.append(Moment(self.session.time_s, words, ok, kind or judged))

    @property
    def deciding(self) -> Moment:
        """The moment that decided the trial: what failed first, else what succeeded last, else the end."""
        failed = [moment for moment in self.moments if moment.ok is False]
        succeeded = [moment for moment in self.moments if moment.ok]
        return failed[0] if failed else (succeeded or self.moments)[-1]

    # ------------------------------------------------------------ the steps

    def ticks_of(self, steps: Sequence[Step]) -> Iterator[str]:
        """What is being done, before each tick of some of the steps."""
        for step in steps:
            yield from self._carry_out(step)

    def _carry_out(self, step: Step) -> Iterator[str]:
        match step:
            case Explore():
                yield from self._explore(step)
            case Drive():
                yield from self._drive(step)
            case Move():
                yield from self._move(step)
            case Send():
                yield from self._send(step)
            case Visit():
                for name in step.places:
                    yield from self._visit(name, step)
            case Tour():
                yield from self._tour(step)
            case Click():
                yield from self._click(step)
            case Wait():
                self.session.drive(*_STANDING)
                yield from self._for(step.seconds, "waiting")
            case Repeat():
                for _ in range(step.times):
                    yield from self.ticks_of(step.steps)
            case _:
                self._do_at_once(step)

    def _do_at_once(self, step: Step) -> None:
        match step:
            case Tag():
                for name in step.places:
                    self.tags[name] = Tagged(*self._place(name), step.within_m)
            case TagHere():
                self._tag_here(step.name)
            case Kidnap():
                self._kidnap(step)
            case PutPacket():
                self._put_packet(step)
            case Set():
                self.session.set_parameters(step.values)
                self.mark(", ".join(f"{name} = {value}" for name, value in step.values.items()))
            case Door():
                self.session.set_door(step.name, step.open)
                self.mark(f"{step.name} {'opens' if step.open else 'shuts'}")
            case _:
                raise TypeError(f"nobody carries out {step.do}")

    def _tick(self, what: str) -> Iterator[str]:
        yield what
        for name, tag in self.tags.items():
            if tag.note(self._here, self.session.brain.experience_map.active):
                self.mark(f"{name} is tagged, {tag.away_m:.2f} m from it", kind="tagged")

    def _for(self, seconds: float, what: str) -> Iterator[str]:
        for _ in range(max(1, round(seconds / self.session.frame.dt))):
            yield from self._tick(what)

    def _explore(self, step: Explore) -> Iterator[str]:
        session = self.session
        session.set_mode("explore")
        for _ in range(max(1, round(step.minutes * 60 / session.frame.dt))):
            yield from self._tick("exploring")
            kidnaps = session.evaluation.kidnaps
            if step.until == "recovered" and (not kidnaps or kidnaps[-1].after_s is not None):
                break
        if step.until == "recovered" and session.evaluation.kidnaps:
            self._judge_kidnap()

    def _judge_kidnap(self) -> None:
        kidnap = self.session.evaluation.kidnaps[-1]
        if kidnap.after_s is None:
            self.mark("not recovered from the kidnap", False)
        else:
            self.mark(
                f"recovered {kidnap.after_s:.1f} s and {kidnap.after_m or 0:.1f} m after the kidnap", True, "recovered"
            )

    def _drive(self, step: Drive) -> Iterator[str]:
        for lap in range(step.laps):
            for where in step.path:
                yield from self._drive_to(self._place(where), step.speed, f"driven, lap {lap + 1} of {step.laps}")
        self.session.drive(*_STANDING)

    def _drive_to(self, place: tuple[float, float], speed: float, what: str) -> Iterator[str]:
        session, began_s = self.session, self.session.time_s
        while math.dist(self._here, place) > REACHED_M:
            if session.time_s - began_s > PATIENCE_S:
                self.mark(f"({place[0]:g}, {place[1]:g}) could not be driven to, and is left out")
                return
            truth = session.simulator.truth
            aside = math.remainder(math.atan2(place[1] - truth.y, place[0] - truth.x) - truth.heading_rad, math.tau)
            turn = max(-MOST_TURN, min(MOST_TURN, aside / max(AIM_S, session.frame.dt)))
            session.drive(speed * math.cos(aside) if abs(aside) < SHARP_RAD else 0.0, turn)
            yield from self._tick(what)

    def _move(self, step: Move) -> Iterator[str]:
        for _ in range(step.times):
            for speed, turn_deg, seconds in step.moves:
                self.session.drive(speed, math.radians(turn_deg))
                yield from self._for(seconds, "moved")
        self.session.drive(*_STANDING)

    def _tag_here(self, name: str) -> None:
        x, y = self._here
        active = self.session.brain.experience_map.active
        self.tags[name] = Tagged(x, y, within_m=0.0, experience=active, away_m=0.0, passed=True)
        self.mark(f"{name} is tagged, here", kind="tagged")

    def _send(self, step: Send) -> Iterator[str]:
        tag = self.tags[step.place]
        if tag.experience is None:
            self.mark(f"{step.place} was never approached, so that nobody is sent there")
            return
        self.session.go_to(tag.experience)
        for what in self._for(step.seconds, f"sent to {step.place}"):
            if self.session.pilot.goal_state == (tag.experience, "arrived"):
                self.mark(f"arrived at {step.place} before it was called back")
                return
            yield what
        self.mark(f"called back from the way to {step.place}")

    def _visit(self, name: str, step: Visit) -> Iterator[str]:
        tag = self.tags[name]
        tag.passed = True  # what stands for a place does not change once the robot is sent there
        if tag.experience is None:
            self._visited(name, None, (tag.x, tag.y), "never approached while exploring", self._beginning)
            return
        yield from self._go(name, tag.experience, (tag.x, tag.y), step)

    def _tour(self, step: Tour) -> Iterator[str]:
        """ValueError: the robot does not know so many places."""
        session, map_ = self.session, self.session.brain.experience_map
        goals = spread_goals(session, step.goals)
        if len(goals) < step.goals:
            raise ValueError(
                f"tour: goals = {step.goals}, but the robot knows only {len(goals)} places; explore longer"
            )
        places = [session.evaluation.made_at(goal, map_) for goal in goals]
        for number, goal in enumerate(order(step.goals, step.visits, session.seed), start=1):
            yield from self._go(f"visit {number} of {step.visits}", goals[goal], places[goal], step)

    def _go(self, name: str, experience: int, place: tuple[float, float], step: Visit | Tour) -> Iterator[str]:
        beginning = self._beginning
        self.session.go_to(experience)
        yield from self._until_there(name, experience, place, step, beginning)

    def _click(self, step: Click) -> Iterator[str]:
        """The click is as exact as the map: it falls where the map has what the robot experienced nearest to the place."""
        session, map_ = self.session, self.session.brain.experience_map
        x, y = self._place(step.place)
        births = session.evaluation.births(len(map_))
        nearest = int(np.nanargmin(np.hypot(births[:, 0] - x, births[:, 1] - y)))
        place = float(births[nearest, 0]), float(births[nearest, 1])
        name = step.place if isinstance(step.place, str) else "the place that was clicked"
        experience = session.set_goal(float(map_.poses[nearest, 0]), float(map_.poses[nearest, 1]))
        self.mark(f"{name} is clicked on the map: to experience {experience}")
        yield from self._until_there(name, experience, place, step, self._beginning)

    def _until_there(
        self, name: str, experience: int, place: tuple[float, float], step: Visit | Tour | Click,
        beginning: tuple[float, float],
    ) -> Iterator[str]:  # fmt: skip
        """Until the robot says that it has come to its goal, or the time is over; the experimenter sees whether it has."""
        session = self.session
        while (state := session.pilot.goal_state) is None or state[1] != "arrived":
            if session.time_s - beginning[0] >= step.timeout_s - 1e-9:
                self._visited(name, experience, place, f"not reached in {step.timeout_s:g} s", beginning)
                return
            yield from self._tick(f"on the way to {name}")
        miss_m = math.dist(self._here, place)
        why = "" if miss_m <= step.near_m else f"arrived {miss_m:.2f} m away"
        self._visited(name, experience, place, why, beginning)

    @property
    def _beginning(self) -> tuple[float, float]:
        return self.session.time_s, self.session.evaluation.path_m

    def _visited(
        self, name: str, experience: int | None, place: tuple[float, float], why: str, beginning: tuple[float, float]
    ) -> None:
        session, (began_s, began_m) = self.session, beginning
        path_m, miss_m = session.evaluation.path_m - began_m, math.dist(self._here, place)
        self.visits.append(Visited(name, experience, not why, began_s, session.time_s - began_s, path_m, miss_m, why))
        self.mark(f"{name}: {why or 'reached'}", not why)

    def _kidnap(self, step: Kidnap) -> None:
        session, truth = self.session, self.session.simulator.truth
        heading = None if step.heading_deg is None else math.radians(step.heading_deg)
        if step.turn_deg is not None:
            session.kidnap(truth.x, truth.y, truth.heading_rad + math.radians(step.turn_deg))
        elif step.place is not None:
            session.kidnap(*self._place(step.place), heading)
        else:
            x, y, by_chance = self._far_away(step.least_m)
            session.kidnap(x, y, by_chance if heading is None else heading)
        self.mark("kidnapped", kind="kidnap")

    def _put_packet(self, step: PutPacket) -> None:
        cells = self.session.brain.pose_cells
        n_theta, n_y, n_x = cells.shape
        x, y = round(cells.winner.x + step.away[0]) % n_x, round(cells.winner.y + step.away[1]) % n_y
        heading = cells.winner.heading_rad + step.layers * math.tau / n_theta
        self.mark(self.session.put_packet(x, y, math.remainder(heading, math.tau), step.share), kind="packet")

    def _far_away(self, least_m: float) -> tuple[float, float, float]:
        for _ in range(_TRIES):
            x, y, heading = self.session.random_free_pose()
            if math.dist((x, y), self._here) >= least_m:
                return x, y, heading
        raise ValueError(f"least_m = {least_m:g}: no free place so far from the robot in {self.session.world.name}")

    # ------------------------------------------------------------ where things are

    @property
    def _here(self) -> tuple[float, float]:
        truth = self.session.simulator.truth
        return truth.x, truth.y

    def _place(self, where: Where) -> tuple[float, float]:
        return place_of(self.session.world, where)
