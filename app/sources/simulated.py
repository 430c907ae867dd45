"""The simulated robot in its office as the source of a session. Its pilot drives it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from app.config import Config, Value
from app.pilot import Pilot
from app.recordings.recording import About
from app.sensor_input import Lap, SensorInput
from app.sources.source import Source
from disk import kind
from ratslam_core import ExperienceMap, Odometry
from sim2d import SONAR_ANGLES_RAD, Drive, SensorFrame, Simulator, Truth, World, WorldText


@kind("simulated/1")
class Simulated:
    """world: the one that a reset begins in. The robot may be in another, where boxes were put down or taken away."""

    CACHES = ("world", "frame", "_text", "_text_now")
    recording: About | None = None
    driven, slow = True, False
    parts: tuple[str, ...] = ("pilot", "office and senses")
    foreign: tuple[str, ...] = ()
    over: bool = False  # an office always has more to tell
    beam_angles_rad: Sequence[float] = SONAR_ANGLES_RAD

    def __init__(self, world: World, seed: int, config: Config, before: Source | None = None) -> None:
        """before: another source; what was computed from the same walls is taken over. It does not change the result."""
        same = before.simulator if isinstance(before, Simulated) else None
        self.world, self.simulator = world, Simulator(world, config.robot, seed, config.office, same)
        self._look()

    def settle(self, worlds: tuple[World, ...], before: Source | None) -> None:
        self.world, world = worlds
        self.simulator.settle(world, before.simulator if isinstance(before, Simulated) else None)
        self._look()

    def _look(self) -> None:
        self._text, self._text_now = WorldText(), WorldText()
        self.frame = self.simulator.observe()

    def advance(self, pilot: Pilot, map_: ExperienceMap, lap: Lap) -> None:
        frame = self.frame
        drive = Drive(*pilot.step(frame.ranges_m, frame.bumped, _odometry(frame), map_))
        lap("pilot")
        self.frame = self.simulator.step(drive)
        lap("office and senses")

    def sensed(self, behaviour: int) -> SensorInput:
        frame = self.frame
        return SensorInput(frame.image, _odometry(frame), frame.ranges_m, behaviour, frame.scene)

    def carry(self, x: float, y: float, heading_rad: float) -> None:
        """Put the robot there. ValueError: it does not fit."""
        self.simulator.teleport(x, y, heading_rad)
        self.frame = self.simulator.observe()

    # ------------------------------------------------------------ looking

    @property
    def name(self) -> str:
        return self.world.name

    @property
    def truth(self) -> Truth:
        return self.simulator.truth

    @property
    def dt_ahead(self) -> float:
        return self.frame.dt

    def tick_at(self, time_s: float) -> None:
        """Its ticks are even."""

    @property
    def worlds(self) -> tuple[World, ...]:
        return self.world, self.simulator.world

    @property
    def world_texts(self) -> tuple[str, str]:
        text, now = self._text.of(self.world), self.simulator.world
        return text, text if now is self.world else self._text_now.of(now)

    @property
    def decides(self) -> Simulator:
        return self.simulator

    def new_ties(self) -> None:
        """It has sonars."""

    def set_section(self, section: str, values: dict[str, Value]) -> None:
        simulator = self.simulator
        if section == "robot":
            simulator.set_params(replace(simulator.params, **values))  # type: ignore[arg-type]
        else:
            simulator.office = replace(simulator.office, **values)  # type: ignore[arg-type]


def _odometry(frame: SensorFrame) -> Odometry:
    return Odometry(frame.odometry_speed, frame.odometry_yaw_rate, frame.dt)
