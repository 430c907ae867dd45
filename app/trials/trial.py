"""One trial as data: the same trial is the same run, bit for bit, so that it need not be kept but can be run again."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pydantic import TypeAdapter

from app.config import Config
from app.trials.measures import MEASURES, Measure
from app.trials.scores import Moment, scores_of
from app.trials.steps import Step, Values

if TYPE_CHECKING:
    from app.trials.course import Course
    from sim2d import World


_STEPS: TypeAdapter[tuple[Step, ...]] = TypeAdapter(tuple[Step, ...])
TELL_AFTER = 100  # ticks between two words about how far it is


@dataclass(frozen=True, slots=True)
class Trial:
    """Everything that decides a run. values: the parameters that are not as they are by default."""

    experiment: str
    engine: str  # "paper" or "ours"
    levels: tuple[str, ...]  # of each axis, by label
    seed: int
    world: str  # name, or path of a file
    world_text: str
    values: Values
    protocol: tuple[Step, ...]
    measures: tuple[str, ...]
    version: str  # of the code: code_version.py
    quick: bool = False
    id: str = field(init=False, default="")

    def __post_init__(self) -> None:
        object.__setattr__(self, "id", hashlib.sha256(self._text().encode()).hexdigest()[:16])

    def _text(self) -> str:
        """What the id is a hash of: version, protocol, world, config, seed, and what is measured."""
        steps = _STEPS.dump_python(self.protocol, mode="json")
        parts = self.version, steps, self.world_text, self.values, self.seed, sorted(self.measures)
        return json.dumps(parts, sort_keys=True, separators=(",", ":"))

    def begin(self) -> Course:
        """The session before its first tick. ValueError says what does not fit together."""
        from app.session import Session
        from app.trials.course import Course
        from sim2d.importers import open_world

        config = Config().with_values(self.values)
        world = open_world(self.world, robot_radius_m=config.robot.robot_radius_m)
        return Course(Session(world, self.seed, config), self.protocol)


@dataclass(frozen=True, slots=True)
class Result:
    """How a trial ended. Only `wall_s` depends on the machine."""

    trial_id: str
    scores: dict[str, float]
    deciding: Moment
    simulated_s: float
    wall_s: float
    state_hash: str


def run_trial(trial: Trial, tell: Callable[[float, str], None] | None = None) -> tuple[Result, Course]:
    """Run a trial to its end. tell: is given the simulated seconds since the last call, and what is being done."""
    began = time.perf_counter()
    course = trial.begin()
    measures = [MEASURES[name](course) for name in trial.measures]
    watched(course, measures, tell)
    scores = scores_of(course)
    for measure in measures:
        scores.update(measure.scores())
    session = course.session
    wall_s = time.perf_counter() - began
    return Result(trial.id, scores, course.deciding, session.time_s, wall_s, session.state_hash()), course


def watched(course: Course, measures: list[Measure], tell: Callable[[float, str], None] | None = None) -> None:
    """Take a course to its end, and show each of its ticks to everybody who measures."""
    session, since_s = course.session, course.session.time_s
    for what in course.ticks():
        session.tick()
        for measure in measures:
            measure.note()
        if tell is not None and session.tick_count % TELL_AFTER == 0:
            tell(session.time_s - since_s, what)
            since_s = session.time_s


def text_of(world: World) -> str:
    """A world as the text of its file."""
    from sim2d import WorldText

    return WorldText().of(world)
