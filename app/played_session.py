"""A session that plays a recording: the same brain, looked at and changed in the same way, and no office or pilot.

What a recording does not have is absent: an order that needs it is refused (app/commands/needs.py).
"""

from __future__ import annotations

import copy
import hashlib
import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from app.config import Value
from app.evaluation import Evaluation
from app.order_book import Order
from app.pilot import Pilot
from app.recordings.playing import Player, Step
from app.recordings.recording import About, Moment, Pose, Recording
from app.session import Session
from app.stopwatch import Stopwatch
from disk import encode
from ratslam_core import Odometry
from sim2d import SONAR_ANGLES_RAD, SensorFrame, Truth

PARTS = ("recording and RatSLAM", "judging")  # of a tick
NOT_RECORDED = ("robot", "office", "pilot")  # sections of the parameters that no recording has
SHOWN_PX = 320  # the widest picture that people are shown; the brain is given the whole one


class PlayedSession(Session):
    """One recording and one brain. A tick is a moment, however long that takes: the pace changes nothing."""

    def __init__(self, player: Player, seed: int | None = None) -> None:
        """ValueError: there is nothing to be played."""
        self._player = copy.copy(player)
        self.seed = self._player.seed = player.seed if seed is None else seed
        self.config = player.config
        self._moments = _Watched(player.recording)
        self.recording = player.recording.about
        self.pilot = Pilot(self.config.pilot, np.array(SONAR_ANGLES_RAD), np.random.default_rng(0))  # never asked
        self.evaluation = Evaluation()
        self.tags = {}
        self.stopwatch = Stopwatch(PARTS)
        self.on_order = _nobody
        self.under_orders = False
        self._truth: Truth | None = None
        watched = copy.copy(self._player)
        watched.recording = self._moments
        self._steps: Iterator[Step] = watched.steps()
        first = next(self._steps, None)
        if first is None:
            raise ValueError(f"{self.recording.name} has no moment that can be played")
        self.brain = first.brain
        self._tick = 0
        self._take(first)

    @property
    def over(self) -> bool:
        """Whether the last moment has been played."""
        return self._moments.ended

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those that are not about what a recording lacks."""
        foreign = tuple(f"{section}." for section in NOT_RECORDED)
        return tuple(words for words in self.config.warnings if not any(name in words for name in foreign))

    @property
    def player(self) -> Player:
        """Plays the same recording from its beginning, with the parameters as they are now."""
        player = copy.copy(self._player)
        player.config = self.config
        return player

    def tick(self, watch: Callable[[str], None] | None = None) -> None:  # noqa: ARG002  # a moment is played as a whole
        """Play one moment. After the last one nothing happens."""
        self.stopwatch.start()
        step = next(self._steps, None)
        if step is None:
            return
        self.stopwatch.lap(PARTS[0])
        self._tick += 1
        self._take(step)
        self.stopwatch.lap(PARTS[1])
        self.stopwatch.finish()

    def set_parameters(self, values: Mapping[str, Value]) -> list[str]:
        """As in every session; those of robot, office and pilot are refused."""
        for name in values:
            if name.split(".")[0] in NOT_RECORDED:
                raise ValueError(f"a recording plays: {name} is for the simulator, and changes nothing here")
        return super().set_parameters(values)

    # ------------------------------------------------------------ looking

    @property
    def truth(self) -> Truth | None:
        return self._truth

    def state_hash(self) -> str:
        """A digest of everything that decides the future, beside the recording itself, and of the evaluation."""
        parts = (self._tick, self.seed, self.config, self.brain, self.evaluation, self.tags)
        return hashlib.sha256("".join(encode(part).digest() for part in parts).encode()).hexdigest()

    # ------------------------------------------------------------ inside

    def _take(self, step: Step) -> None:
        """Keep what a step tells, and compare it with the truth if the recording has it."""
        self.estimate, self.odometry = step.estimate, step.motion
        self.frame = _frame(self._tick, step.moment, step.motion)
        before, true = self._truth, step.moment.truth
        self._truth = None if true is None else _truth(true, before, step.moment.dt)
        if self._truth is not None:
            self.evaluation.record(
                self.time_s, self._truth, self.brain.experience_map, step.estimate.created, step.motion
            )


class _Watched:
    """A recording that knows when its last moment has been given: it reads one ahead."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self.ended = False

    @property
    def about(self) -> About:
        return self._recording.about

    def moments(self) -> Iterator[Moment]:
        moments = self._recording.moments()
        now = next(moments, None)
        while now is not None:
            following = next(moments, None)
            self.ended = following is None
            yield now
            now = following


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


def _truth(now: Pose, before: Truth | None, dt: float) -> Truth:
    """A true pose with the speeds that led to it from the one before."""
    x, y, heading = now
    if before is None:
        return Truth(x, y, heading, 0.0, 0.0)
    dt = max(dt, 1e-6)
    way, turn = math.hypot(x - before.x, y - before.y), math.remainder(heading - before.heading_rad, math.tau)
    return Truth(x, y, heading, way / dt, turn / dt)


def _nobody(_order: Order) -> None:
    """The default for `on_order`: does nothing."""
