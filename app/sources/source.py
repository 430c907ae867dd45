"""What a session asks of its source. A session does not know which source it has; a source knows neither brain nor judge."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from app.config import Value
from app.pilot import Pilot
from app.recordings.recording import About
from app.sensor_input import Lap, SensorInput, Ties
from ratslam_core import ExperienceMap
from sim2d import SensorFrame, Truth, World


class Source(Protocol):
    """Simulated | Recorded. It is a part of the session's state."""

    recording: About | None  # what a recording says of itself, for people
    driven: bool  # by the pilot
    slow: bool  # its ticks may take long to be made again
    parts: tuple[str, ...]  # of a tick, before those of the brain
    foreign: tuple[str, ...]  # sections of the parameters that mean nothing to it
    frame: SensorFrame  # what was sensed last

    @property
    def name(self) -> str:
        """Of its world or of its recording."""
        ...

    @property
    def over(self) -> bool:
        """Whether it has nothing more to tell."""
        ...

    @property
    def truth(self) -> Truth | None:
        """Where the robot really is, as far as it is known. Never for the robot."""
        ...

    @property
    def dt_ahead(self) -> float:
        """Seconds that the next tick will take."""
        ...

    @property
    def world(self) -> World | None:
        """The office that a reset begins in; None: there is none."""
        ...

    @property
    def worlds(self) -> tuple[World, ...]:
        """The world that a reset begins in, and the one that the robot is in; nothing without an office."""
        ...

    @property
    def world_texts(self) -> tuple[str, str]:
        """Their texts. They differ when boxes were put down or taken away."""
        ...

    @property
    def decides(self) -> object:
        """All of it that decides the future, beside the worlds: a part of the state's hash."""
        ...

    @property
    def beam_angles_rad(self) -> Sequence[float]:
        """Of the ranges that a brain is given."""
        ...

    def advance(self, pilot: Pilot, map_: ExperienceMap, lap: Lap) -> None:
        """The next tick: another `frame`. pilot: is asked where to drive, if the source can be driven."""
        ...

    def sensed(self, behaviour: int) -> SensorInput:
        """What was sensed last, as a brain is given it. behaviour: the pilot's; a recording tells its own."""
        ...

    def tick_at(self, time_s: float) -> int | None:
        """The tick of a time, if it is not simply proportional."""
        ...

    def new_ties(self) -> Ties | None:
        """What ties the experiences of a new brain; None: nothing, since there is no laser."""
        ...

    def set_section(self, section: str, values: dict[str, Value]) -> None:
        """Take changed live parameters of "robot" or "office". ValueError: they cannot be, and nothing has changed."""
        ...

    def settle(self, worlds: tuple[World, ...], before: Source | None) -> None:
        """Compute the caches anew after it was restored from a state. before: one of the same session or recording."""
        ...
