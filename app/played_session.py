"""A session that plays a recording: the same brain, looked at and changed in the same way, and no office or pilot.

What a recording does not have is absent: an order that needs it is refused (app/commands/table.py). The recording itself
is no part of the state: copies of a session share it (app/recordings/reel.py).
"""

from __future__ import annotations

import copy
import hashlib
import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from app.companion import Heard
from app.config import Config, Value
from app.evaluation import Evaluation
from app.order_book import Order, order
from app.pilot import Pilot
from app.recordings.playing import Player, Step
from app.recordings.recording import About, Moment, Pose
from app.recordings.reel import Reel
from app.recordings.scan_ties import ScanTies
from app.session import SECOND, Session
from app.stopwatch import Stopwatch
from disk import encode, kind
from ratslam_core import Odometry, RatSlam
from ratslam_core.slam import STAGES
from sim2d import SONAR_ANGLES_RAD, SensorFrame, Truth, World

PARTS = ("recording", *STAGES, "judging", SECOND)  # of a tick
NOT_RECORDED = ("robot", "office", "pilot")  # sections of the parameters that no recording has
SHOWN_PX = 320  # the widest picture that people are shown; the brain is given the whole one


@kind("played session/1")
class PlayedSession(Session):
    """One recording and one brain. A tick is a moment, however long that takes: the pace changes nothing."""

    CACHES = (*Session.CACHES, "recording", "_player", "_reel", "_ends")

    def __init__(self, player: Player, seed: int | None = None) -> None:
        """ValueError: there is nothing to be played."""
        self._player = copy.copy(player)
        self.seed = self._player.seed = player.seed if seed is None else seed
        self.config = player.config
        self.pilot = Pilot(self.config.pilot, np.array(SONAR_ANGLES_RAD), np.random.default_rng(0))  # never asked
        self.evaluation = Evaluation()
        self.tags = {}
        self._true: tuple[float, float, float, float, float] | None = None  # as in `Truth`
        self._reel = Reel(player.recording)
        if not self._reel.has(0):
            raise ValueError(f"{player.recording.about.name} has no moment that can be played")
        self._playing = self._player.begin()
        self.brain = self._playing.brain
        self._tick = -1
        self._begin()
        self._play(_unwatched)

    def settle(self, worlds: tuple[World, ...], before: Session | None = None) -> None:  # noqa: ARG002
        """As in every session. There are no worlds; `before`, which plays the same recording, is needed."""
        if not isinstance(before, PlayedSession):
            raise ValueError("a session of a recording goes on beside another that plays it")
        self._player, self._reel = before._player, before._reel
        self._begin()
        self.frame = _frame(self._tick, self._reel.at(self._tick), self.odometry)
        self._ends = not self._reel.has(self._tick + 1)
        now = self._reel.at(self._tick)  # before the first tick, a second brain may begin with it
        self.heard = Heard(now.image, self.odometry, self._playing.ranges_of(now), now.behaviour, scan_m=now.ranges_m)

    def _begin(self) -> None:
        self.recording = self.about
        self.stopwatch = Stopwatch(PARTS)
        self.on_order: Callable[[Order], object] = _nobody
        self.under_orders = False

    @property
    def tick_count(self) -> int:
        return self._tick

    @property
    def over(self) -> bool:
        """Whether the last moment has been played."""
        return self._ends

    @property
    def worlds(self) -> tuple[World, ...]:
        return ()

    @property
    def world_texts(self) -> tuple[str, str]:
        return "", ""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those that are not about what a recording lacks."""
        foreign = tuple(f"{section}." for section in NOT_RECORDED)
        return tuple(words for words in self.config.warnings if not any(name in words for name in foreign))

    @property
    def about(self) -> About:
        """What the recording says of itself."""
        return self._player.recording.about

    @property
    def player(self) -> Player:
        """Plays the same recording from its beginning, with the parameters as they are now."""
        player = copy.copy(self._player)
        player.config = self.config
        return player

    def tick(self, watch: Callable[[str], None] | None = None) -> None:
        """Play one moment. After the last one nothing happens."""
        clock = self.stopwatch
        clock.start()
        if self._ends:
            return

        def staged(stage: str) -> None:
            clock.lap(stage)
            if watch is not None:
                watch(stage)
                clock.start()  # the time of watching does not count

        self._play(staged)
        clock.lap("judging")
        if self.companion is not None:
            self.companion.follow(self.heard, self.time_s, self.tick_count, self.truth, self.brain, self.estimate)
            clock.lap(SECOND)
        clock.finish()

    @order
    def set_parameters(self, values: Mapping[str, Value]) -> list[str]:
        """As in every session; those of robot, office and pilot are refused."""
        for name in values:
            if name.split(".")[0] in NOT_RECORDED:
                raise ValueError(f"a recording plays: {name} is for the simulator, and changes nothing here")
        return super().set_parameters(values)

    # ------------------------------------------------------------ looking

    @property
    def truth(self) -> Truth | None:
        return None if self._true is None else Truth(*self._true)

    @property
    def dt_ahead(self) -> float:
        return self._reel.at(self._tick + 1).dt if self._reel.has(self._tick + 1) else self.frame.dt

    def tick_at(self, time_s: float) -> int:
        """The last moment at or before a time, among those that were played once."""
        return self._reel.number_at(time_s)

    def digest(self, world_texts: tuple[str, str]) -> str:  # noqa: ARG002  # it has none
        """Of everything that decides the future, beside the recording itself, and of the evaluation."""
        parts = (self._tick, self.seed, self.config, self._playing, self._true, self.evaluation, self.tags)
        return hashlib.sha256("".join(encode(part).digest() for part in parts).encode()).hexdigest()

    # ------------------------------------------------------------ a second brain

    def new_brain(self, config: Config) -> RatSlam:
        player = self.player
        player.config = config
        return player.brain()

    def new_ties(self) -> ScanTies | None:
        return self._player.begin().ties

    @property
    def ties(self) -> ScanTies | None:
        return self._playing.ties

    # ------------------------------------------------------------ inside

    def _play(self, watch: Callable[[str], None]) -> None:
        """Play the next moment, keep what it tells, and compare it with the truth if the recording has it."""
        moment = self._reel.at(self._tick + 1)
        ends = not self._reel.has(self._tick + 2)  # where it breaks off, this is said before the brain has changed
        self.stopwatch.lap("recording")
        step = self._playing.step(moment, watch)
        self._tick, self._ends = self._tick + 1, ends
        self.estimate, self.odometry = step.estimate, step.motion
        self.frame = _frame(self._tick, moment, step.motion)
        self.heard = Heard(
            moment.image, step.motion, step.ranges_m, moment.behaviour, gap=step.gap, scan_m=moment.ranges_m
        )
        self._judge(step)

    def _judge(self, step: Step) -> None:
        before, true = self.truth, step.moment.truth
        self._true = None if true is None else _with_speeds(true, before, step.moment.dt)
        truth = self.truth
        if truth is not None:
            self.evaluation.record(self.time_s, truth, self.brain.experience_map, step.estimate.created, step.motion)


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


def _nobody(_order: Order) -> None:
    """The default for `on_order`: does nothing."""


def _unwatched(_stage: str) -> None:
    """The first moment is played before anybody can watch."""
