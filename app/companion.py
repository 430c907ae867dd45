"""A second brain on the same sensor input, to be compared with the first: it only estimates, the pilot follows the first. [ours]

test_companion.py: the first stays the same to the bit, and a companion with the same parameters is the first one again.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import Any

from app.config import Config, Value
from app.evaluation import Evaluation
from app.sensor_input import SensorInput, Ties
from disk import encode, kind
from ratslam_core import Estimate, RatSlam
from ratslam_core.params import RatSlamParams
from sim2d import Truth

SECTIONS = tuple(RatSlamParams.__dataclass_fields__)  # of the parameters that a brain has


@kind("first_divergence/1")
@dataclass(slots=True)
class FirstDivergence:
    """The first tick after which two brains differ, and how. view, experience: of the first and of the second; link: the ends
    of the one that only one of them has, and whether it is the first that has it. None: they do not differ in that."""

    packet: tuple[int, float] | None = None  # tick, and its simulated time
    view: tuple[int, float, int, int] | None = None
    experience: tuple[int, float, int, int] | None = None
    link: tuple[int, float, int, int, bool] | None = None

    def note(self, tick: int, time_s: float, first: RatSlam, one: Estimate, second: RatSlam, other: Estimate) -> None:
        """Compare what both have made of a tick."""
        if self.packet is None and _place(one) != _place(other):
            self.packet = tick, time_s
        if self.view is None and one.recognition.view != other.recognition.view:
            self.view = tick, time_s, one.recognition.view, other.recognition.view
        if self.experience is None and one.experience != other.experience:
            self.experience = tick, time_s, one.experience, other.experience
        if self.link is None:
            here, there = first.experience_map, second.experience_map
            if here.link_count != there.link_count:
                self.link = _link_of_one(tick, time_s, here.links.tolist(), there.links.tolist())


@kind("companion/2")
class Companion:
    """One brain beside the first of a session. `counterpart[k]` is the experience in which this one was when the first one
    made its experience k, -1 where that is unknown: with it, a goal of the first is a place in this map, too."""

    def __init__(
        self, names: tuple[str, str], values: dict[str, Value], config: Config, brain: RatSlam, evaluation: Evaluation,
        since_s: float,
    ) -> None:  # fmt: skip
        """names: of the first brain and of this; values: the parameters that make the difference; config: all of them;
        since_s: the simulated time at which it began."""
        (self.first, self.name), self.values, self.config, self.brain = names, values, config, brain
        self.evaluation, self.since_s, self.divergence = evaluation, since_s, FirstDivergence()
        self.counterpart: list[int] = []
        self.estimate: Estimate | None = None
        self.ties: Ties | None = None  # of a recording with a laser

    def follow(
        self, sensed: SensorInput, time_s: float, tick: int, truth: Truth | None, first: RatSlam, estimate: Estimate
    ) -> None:
        """One step on the sensor input of the first brain in this tick.

        first, estimate: the first brain, and what it has made of the tick; they are only compared with.
        """
        own = self.estimate = sensed.step(self.brain, self.ties)
        if truth is not None:
            self.evaluation.record(time_s, truth, self.brain.experience_map, own.created, sensed.odometry)
        self._note_counterpart(estimate.experience)
        self.divergence.note(tick, time_s, first, estimate, self.brain, own)

    def change(self, before: Config, now: Config) -> None:
        """Take the live parameters that differ between two configs of its own; the others wait for a reset, as ever."""
        changes: dict[str, dict[str, Any]] = {}
        for (dotted, item, old), (_, _, new) in zip(before.items(), now.items(), strict=True):
            section, key = dotted.split(".")
            if old != new and item.metadata["live"] and section in SECTIONS:
                changes.setdefault(section, {})[key] = new
        params = self.brain.params
        sections: dict[str, Any] = {name: replace(getattr(params, name), **keys) for name, keys in changes.items()}
        self.brain.set_params(replace(params, **sections))
        self.config = now

    def digest(self) -> str:
        """Of all that decides what it will do and how it is judged: equal for equal histories."""
        parts = (self.values, self.config, self.brain, self.ties, self.evaluation, self.counterpart, self.divergence)
        return hashlib.sha256("".join(encode(part).digest() for part in parts).encode()).hexdigest()

    def _note_counterpart(self, experience: int) -> None:
        while len(self.counterpart) < experience:
            self.counterpart.append(-1)
        if len(self.counterpart) == experience:
            self.counterpart.append(self.brain.experience_map.active)


def digest_of(companion: Companion | None) -> str | None:
    return None if companion is None else companion.digest()


def _place(estimate: Estimate) -> tuple[float, float, float]:
    packet = estimate.packet
    return packet.x, packet.y, packet.heading_rad


def _link_of_one(
    tick: int, time_s: float, here: list[list[int]], there: list[list[int]]
) -> tuple[int, float, int, int, bool] | None:
    """The first link that only one of two maps has."""
    for links, others, first in ((here, there, True), (there, here, False)):
        known = {(start, end) for start, end in others}
        for start, end in links:
            if (start, end) not in known:
                return tick, time_s, start, end, first
    return None
