"""The closed loop, one tick at a time: drive -> office -> senses -> RatSLAM -> pilot -> drive. Start reading here.

No thread, no clock, no page: the same seed and the same calls give the same run, bit for bit.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from app.companion import Heard
from app.config import Config
from app.evaluation import Evaluation
from app.order_book import Order
from app.orders import Orders
from app.pilot import Pilot
from app.recordings.recording import About
from app.stopwatch import Stopwatch
from disk import encode, kind
from ratslam_core import Estimate, Odometry, RatSlam
from ratslam_core.slam import STAGES
from sim2d import SONAR_ANGLES_RAD, Drive, Simulator, Truth, World, WorldText

SECOND = "second brain"  # the part of a tick that there is while two brains are compared
PARTS = ("pilot", "office and senses", *STAGES, "judging", SECOND)  # "judging" compares the estimate with the truth


@kind("session/2")
class Session(Orders):
    """One robot in one world with one brain."""

    CACHES = ("world", "stopwatch", "frame", "_text", "_text_now", "on_order", "under_orders", "heard")
    recording: About | None = None  # what is played, in a session that plays one

    def __init__(
        self, world: World, seed: int = 0, config: Config | None = None, brain: RatSlam | None = None,
        before: Session | None = None,
    ) -> None:  # fmt: skip
        """brain: one that already knows places and has to find out where it is, or a new one built from the caller's
        parts.

        before: another session; what was computed from the same walls is taken over. It does not change the result.
        """
        self.world, self.seed, self.config = world, seed, config or Config()
        _, pilot_seed = np.random.SeedSequence([seed, 1]).spawn(2)
        same = None if before is None else before.simulator
        self.simulator = Simulator(world, self.config.robot, seed, self.config.office, same)
        if brain is None:
            brain = self.new_brain(self.config)
        else:
            brain.set_params(self.config.engine)
            if len(brain.experience_map) > 0:  # an empty map holds no place to be found again
                brain.declare_kidnapped()
        self.brain = brain
        self.pilot = Pilot(self.config.pilot, np.array(SONAR_ANGLES_RAD), np.random.default_rng(pilot_seed))
        self.evaluation = Evaluation(len(brain.experience_map))
        self.tags = {}
        self._look()
        self.estimate: Estimate = self._think(self.stopwatch.lap)

    def settle(self, worlds: tuple[World, ...], before: Session | None = None) -> None:
        """Compute the caches anew in a session that was restored from a state (session_snapshot.py).

        worlds: as `worlds`; before: as above.
        """
        self.world, world = worlds
        self.simulator.settle(world, None if before is None else before.simulator)
        self._look()

    def new_brain(self, config: Config) -> RatSlam:
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        return RatSlam(config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=SONAR_ANGLES_RAD)

    def _look(self) -> None:
        self.stopwatch = Stopwatch(PARTS)
        self.frame = self.simulator.observe()
        self.heard = self._hear()
        self._text, self._text_now = WorldText(), WorldText()
        self.on_order: Callable[[Order], object] = _nobody
        self.under_orders = False

    def tick(self, watch: Callable[[str], None] | None = None) -> None:
        """Run one tick, one sensor period. watch: called after each stage of RatSLAM; it must not change anything."""
        clock = self.stopwatch
        clock.start()

        def staged(stage: str) -> None:
            clock.lap(stage)
            if watch is not None:
                watch(stage)
                clock.start()  # the time of watching does not count

        speed, yaw_rate = self.pilot.step(
            self.frame.ranges_m, self.frame.bumped, self._odometry(), self.brain.experience_map
        )
        clock.lap("pilot")
        self.frame = self.simulator.step(Drive(speed, yaw_rate))
        clock.lap("office and senses")
        self.estimate = self._think(staged)
        clock.lap("judging")
        if self.companion is not None:
            self.companion.follow(self.heard, self.time_s, self.tick_count, self.truth, self.brain, self.estimate)
            clock.lap(SECOND)
        clock.finish()

    # ------------------------------------------------------------ looking

    def state_hash(self) -> str:
        """A digest of everything that decides the future, and of the evaluation. Equal runs have equal hashes."""
        return self.digest(self.world_texts)

    def digest(self, world_texts: tuple[str, str]) -> str:
        """`state_hash` of a session or of a copy of one, which has no worlds."""
        parts = (
            *world_texts,
            self.seed,
            self.config,
            self.simulator,
            self.pilot,
            self.brain,
            self.evaluation,
            self.tags,
        )
        return hashlib.sha256("".join(encode(part).digest() for part in parts).encode()).hexdigest()

    @property
    def worlds(self) -> tuple[World, ...]:
        """The world that a reset begins in, and the one that the robot is in."""
        return self.world, self.simulator.world

    @property
    def world_texts(self) -> tuple[str, str]:
        """The texts of two worlds: the one that a reset begins in, and the one that the robot is in. They differ when
        boxes were put down or taken away."""
        text, now = self.world_text, self.simulator.world
        return text, text if now is self.world else self._text_now.of(now)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about its parameters, in sentences."""
        return tuple(self.config.warnings)

    @property
    def over(self) -> bool:
        """Whether its source has nothing more to tell. An office always has."""
        return False

    @property
    def dt_ahead(self) -> float:
        """Seconds that the next tick will take."""
        return self.frame.dt

    def tick_at(self, time_s: float) -> int | None:  # noqa: ARG002
        """The tick of a simulated time, if the source knows it. The ticks of an office are even, so it need not."""
        return None

    @property
    def truth(self) -> Truth | None:
        """Where the robot really is, as far as the source knows it. Never for the robot."""
        return self.simulator.truth

    @property
    def world_text(self) -> str:
        """The current world as the text of its file."""
        return self._text.of(self.world)

    # ------------------------------------------------------------ inside

    def _odometry(self) -> Odometry:
        return Odometry(self.frame.odometry_speed, self.frame.odometry_yaw_rate, self.frame.dt)

    def _hear(self) -> Heard:
        frame = self.frame
        return Heard(frame.image, self._odometry(), frame.ranges_m, self.pilot.behaviour.number, frame.scene)

    def _think(self, watch: Callable[[str], None]) -> Estimate:
        """One step of the brain, on what it hears in this tick."""
        self.heard = heard = self._hear()
        self.odometry = heard.odometry  # what the brain was told in its last step
        estimate = heard.tell(self.brain, watch)
        self.evaluation.record(
            self.time_s, self.simulator.truth, self.brain.experience_map, estimate.created, heard.odometry
        )
        return estimate


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


def _nobody(_order: Order) -> object:
    """The default for `on_order`: does nothing."""


def is_lost(session: Session) -> bool:
    """Whether a brain that was carried believes no place, or else a second packet holds more than a fifth of the activity."""
    brain, packets = session.brain, session.brain.pose_cells.packets
    return brain.lost if brain.carried else len(packets) > 1 and packets[1].mass > 0.2
