"""A recording as the source of a session: the same brain, looked at and changed in the same way, and no office or pilot.

What a recording does not have is absent: an order that needs it is refused. The recording itself is no part of the state:
copies of a session share it (app/recordings/reel.py).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.config import Value
from app.pilot import Pilot
from app.recordings.playing import Player
from app.recordings.recording import About, Moment, Pose
from app.recordings.reel import Reel
from app.sensor_input import Lap, SensorInput, Ties
from app.sources.source import Source
from disk import kind
from ratslam_core import ExperienceMap, Odometry
from sim2d import SensorFrame, Truth, World

SHOWN_PX = 320  # the widest picture that people are shown; the brain is given the whole one


@kind("recorded/1")
class Recorded:
    """A tick is a moment, however long that takes: the pace changes nothing."""

    CACHES = ("recording", "player", "frame", "over", "_reel", "_sensed")
    parts: tuple[str, ...] = ("recording",)
    world: World | None = None
    driven, slow = False, True
    foreign: tuple[str, ...] = ("robot", "office", "pilot")

    def __init__(self, player: Player) -> None:
        """player: is kept. ValueError: there is nothing to be played."""
        self.player = player
        self.recording: About | None = player.recording.about
        self._reel = Reel(player.recording)
        if not self._reel.has(0):
            raise ValueError(f"{player.recording.about.name} has no moment that can be played")
        self._reader = player.reader()
        self._true: tuple[float, float, float, float, float] | None = None  # as in `Truth`
        self._tick = -1
        self._read(_unwatched)

    def settle(self, worlds: tuple[World, ...], before: Source | None) -> None:  # noqa: ARG002
        """There are no worlds; `before`, which plays the same recording, is needed."""
        if not isinstance(before, Recorded):
            raise ValueError("a session of a recording goes on beside another that plays it")
        self.player, self.recording, self._reel = before.player, before.recording, before._reel
        self.over = not self._reel.has(self._tick + 1)
        now = self._reel.at(self._tick)
        self._take(now, self._reader.input_of(now, self._odometry))

    def advance(self, pilot: Pilot, map_: ExperienceMap, lap: Lap) -> None:  # noqa: ARG002
        """Play the next moment: the robot goes where it went."""
        self._read(lap)

    def _read(self, lap: Lap) -> None:
        moment = self._reel.at(self._tick + 1)
        over = not self._reel.has(self._tick + 2)  # where it breaks off, this is said before anything has changed
        before, true = self.truth, moment.truth
        self._tick, self.over = self._tick + 1, over
        self._true = None if true is None else _with_speeds(true, before, moment.dt)
        self._take(moment, self._reader.read(moment))
        lap("recording")

    def _take(self, moment: Moment, sensed: SensorInput) -> None:
        self._sensed, self._odometry = sensed, sensed.odometry
        self.frame = _frame(self._tick, moment, sensed.odometry)

    def sensed(self, behaviour: int) -> SensorInput:  # noqa: ARG002
        return self._sensed

    # ------------------------------------------------------------ looking

    @property
    def name(self) -> str:
        return self.player.recording.about.name

    @property
    def truth(self) -> Truth | None:
        return None if self._true is None else Truth(*self._true)

    @property
    def dt_ahead(self) -> float:
        return self._reel.at(self._tick + 1).dt if self._reel.has(self._tick + 1) else self.frame.dt

    def tick_at(self, time_s: float) -> int:
        """The last moment at or before a time, among those that were played once."""
        return self._reel.number_at(time_s)

    @property
    def worlds(self) -> tuple[World, ...]:
        return ()

    @property
    def world_texts(self) -> tuple[str, str]:
        return "", ""

    @property
    def decides(self) -> Recorded:
        return self

    @property
    def beam_angles_rad(self) -> list[float]:
        return self.player.beam_angles_rad

    def new_ties(self) -> Ties | None:
        return self.player.new_ties()

    def set_section(self, section: str, values: dict[str, Value]) -> None:
        """Never asked: those sections are foreign to it."""


def _frame(tick: int, moment: Moment, motion: Odometry) -> SensorFrame:
    """A moment as what a robot senses. An image of no pixels: the recording has none."""
    ranges = np.zeros(0, np.float32) if moment.ranges_m is None else moment.ranges_m.astype(np.float32)
    return SensorFrame(
        tick=tick,
        time_s=moment.time_s,
        image=_shown(moment.image),
        odometry_speed=motion.speed,
        odometry_yaw_rate=motion.yaw_rate,
        dt=motion.dt,
        ranges_m=ranges,
        bumped=False,
        laser_m=np.zeros(0, np.float32),
        scene=0,
    ).freeze()


def _shown(image: NDArray[np.uint8] | None) -> NDArray[np.uint8]:
    if image is None:
        return np.zeros((0, 0, 3), np.uint8)
    every = math.ceil(image.shape[1] / SHOWN_PX)
    return image[::every, ::every].copy()


def _with_speeds(now: Pose, before: Truth | None, dt: float) -> tuple[float, float, float, float, float]:
    """A true pose with the speeds that led to it from the one before, as in `Truth`."""
    x, y, heading = now
    if before is None:
        return x, y, heading, 0.0, 0.0
    dt = max(dt, 1e-6)
    way, turn = math.hypot(x - before.x, y - before.y), math.remainder(heading - before.heading_rad, math.tau)
    return x, y, heading, way / dt, turn / dt


def _unwatched(_stage: str) -> None:
    """The first moment is read before anybody can watch."""
