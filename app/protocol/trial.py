"""One trial as data: the same trial is the same run, bit for bit, so that it need not be kept but can be run again."""

from __future__ import annotations

import hashlib
import json
import math
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pydantic import TypeAdapter

from app.config import Config
from app.protocol.measures import MEASURES, Measure, Measuring
from app.protocol.steps import Step, Values

if TYPE_CHECKING:
    from app.protocol.course import Course, Moment, Progress
    from sim2d import World


_STEPS: TypeAdapter[tuple[Step, ...]] = TypeAdapter(tuple[Step, ...])


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
    measures: tuple[str, ...]  # by the names of their classes, beside those that every trial has
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

    @property
    def kinds(self) -> list[type[Measure]]:
        """All that is measured."""
        return [kind for kind in MEASURES if kind.always or kind.__name__ in self.measures]

    @property
    def about_s(self) -> float:
        """About how long it is, in simulated seconds."""
        return sum(step.about_s() for step in self.protocol)

    def begin(self) -> Course:
        """The session before its first tick. ValueError says what does not fit together."""
        from app.protocol.course import Course
        from app.session import Session
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


def run_trial(trial: Trial, progress: Progress | None = None) -> tuple[Result, Course]:
    """Run a trial to its end."""
    from app.protocol.course import run_ticks

    began = time.perf_counter()
    course = trial.begin()
    measuring = Measuring(course, trial.kinds)
    run_ticks(course, course.ticks(), [measuring.note], progress)
    scores = {name: float(value) for name, value in measuring.values().items() if math.isfinite(value)}
    session = course.session
    wall_s = time.perf_counter() - began
    return Result(trial.id, scores, course.deciding, session.time_s, wall_s, session.state_hash()), course


def text_of(world: World) -> str:
    """A world as the text of its file."""
    from sim2d import WorldText

    return WorldText().of(world)
