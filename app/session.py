"""The closed loop, one tick at a time: drive -> office -> senses -> RatSLAM -> pilot -> drive. Start reading here.

No thread, no clock, no page: the same seed and the same calls give the same run, bit for bit.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from app.config import Config, Value
from app.evaluation import Evaluation
from app.pilot import Mode, Pilot
from app.pilot.goal_place import nearest_to, of_its_place
from app.stopwatch import Stopwatch
from disk import encode, kind
from ratslam_core import Estimate, Odometry, RatSlam
from ratslam_core.slam import STAGES
from sim2d import SONAR_ANGLES_RAD, Drive, SensorFrame, Simulator, World, WorldText

MOST_TAGS = 24
PARTS = ("pilot", "office and senses", *STAGES, "judging")  # of a tick; "judging" compares the estimate with the truth


@kind("session/2")
class Session:
    """One robot in one world with one brain."""

    CACHES = ("world", "stopwatch", "frame", "_text")

    def __init__(
        self, world: World, seed: int = 0, config: Config | None = None, brain: RatSlam | None = None,
        before: Session | None = None,
    ) -> None:  # fmt: skip
        """brain: one that already knows places and has to find out where it is, or a new one built from the caller's
        parts.

        before: another session; what was computed from the same walls is taken over. It does not change the result.
        """
        self.world, self.seed, self.config = world, seed, config or Config()
        brain_seed, pilot_seed = np.random.SeedSequence([seed, 1]).spawn(2)
        same = None if before is None else before.simulator
        self.simulator = Simulator(world, self.config.robot, seed, self.config.office, same)
        if brain is None:
            brain = RatSlam(self.config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=SONAR_ANGLES_RAD)
        else:
            brain.set_params(self.config.engine)
            if len(brain.experience_map) > 0:  # an empty map holds no place to be found again
                brain.declare_kidnapped()
        self.brain = brain
        self.pilot = Pilot(self.config.pilot, np.array(SONAR_ANGLES_RAD), np.random.default_rng(pilot_seed))
        self.evaluation = Evaluation(len(brain.experience_map))
        self.tags: dict[str, int] = {}  # name -> the experience that was active when somebody gave it
        self._look()
        self.odometry = self._odometry()  # what the brain was told in its last step
        self.estimate: Estimate = self._think(self.stopwatch.lap)

    def settle(self, world: World) -> None:
        """Compute the caches anew in a session that was restored from a state (session_snapshot.py)."""
        self.world = world
        self.simulator.settle(world)
        self._look()

    def _look(self) -> None:
        self.stopwatch = Stopwatch(PARTS)
        self.frame: SensorFrame = self.simulator.observe()
        self._text = WorldText()

    @property
    def tick_count(self) -> int:
        return self.frame.tick

    @property
    def time_s(self) -> float:
        return self.frame.time_s

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
        clock.finish()

    # ------------------------------------------------------------ orders; ValueError says why one cannot be carried out

    def set_goal(self, x: float, y: float) -> int:
        """Go to the place (x, y), metres in the map's frame: to the quickest of all experiences that stand for it. Returns
        the one nearest to it."""
        return self._go_to(nearest_to(self.brain.experience_map, x, y, self.pilot.params))

    def tag(self, name: str) -> int:
        """Name the place where the robot believes itself to be, as "the kitchen", to send it there later. A name that is
        given again moves. Returns the active experience. IROS 2005 IV."""
        name = name.strip()
        if not name or not name.isprintable():
            raise ValueError(f"a tag needs a name that can be printed, got {name!r}")
        if name not in self.tags and len(self.tags) >= MOST_TAGS:
            raise ValueError(f"{name!r} would be tag number {MOST_TAGS + 1}; {MOST_TAGS} are enough, remove one first")
        self.tags[name] = self.brain.experience_map.active
        return self.tags[name]

    def untag(self, name: str) -> None:
        del self.tags[self._tagged(name)]

    def go_to_tag(self, name: str) -> int:
        """Go to the place of this name, as after a click there. Returns its experience."""
        return self._go_to(self.tags[self._tagged(name)])

    def _go_to(self, experience: int) -> int:
        """Go to this experience or another of its place. Returns the first of them."""
        first, *others = of_its_place(self.brain.experience_map, experience, self.pilot.params)
        self.pilot.set_goal(first, others)
        return first

    def _tagged(self, name: str) -> str:
        if name not in self.tags:
            known = f"one of: {', '.join(self.tags)}" if self.tags else "given first; there is none yet"
            raise ValueError(f"there is no tag {name!r}; it must be {known}")
        return name

    def set_mode(self, mode: Mode) -> None:
        self.pilot.set_mode(mode)

    def kidnap(self, x: float | None = None, y: float | None = None, heading_rad: float | None = None) -> None:
        """Put the robot at (x, y), metres in the office's frame, untold. Without a place: a random free one."""
        if x is None and y is None:
            x, y, by_chance = self.simulator.random_free_pose()
            heading_rad = by_chance if heading_rad is None else heading_rad
        if x is None or y is None:
            raise ValueError("a kidnap needs both x and y, or neither for a place by chance")
        heading = self.simulator.truth.heading_rad if heading_rad is None else heading_rad
        self.simulator.teleport(x, y, heading)
        self.frame = self.simulator.observe()
        self.evaluation.kidnapped(self.time_s, self.brain.experience_map)

    def set_parameter(self, name: str, value: Value) -> bool:
        """Change one parameter. True if it takes effect at once, False if at the next reset."""
        self.set_parameters({name: value})
        return next(item.metadata["live"] for dotted, item, _ in self.config.items() if dotted == name)

    def set_parameters(self, values: Mapping[str, Value]) -> list[str]:
        """Change several parameters, all or none. Returns the names of those that wait for the next reset."""
        config = self.config.with_values(values)
        changes: dict[str, dict[str, Value]] = {"robot": {}}  # robot first: only it can refuse (no room)
        waiting: list[str] = []
        for (dotted, item, old), (_, _, new) in zip(self.config.items(), config.items(), strict=True):
            section, key = dotted.split(".")
            if old != new and item.metadata["live"]:
                changes.setdefault(section, {})[key] = new
            elif old != new:
                waiting.append(dotted)
        for section, change in changes.items():
            if change:
                self._take(section, change)
        self.config = config
        return waiting

    def edit_world(self, world: World) -> None:
        """Go on in an edited world; a reset begins in it, too. ValueError if something in it would cover the robot."""
        self.simulator.set_world(world)
        self.world = world

    def state_hash(self) -> str:
        """A digest of everything that decides the future, and of the evaluation. Equal runs have equal hashes."""
        parts = (
            self.world_text,
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
    def world_text(self) -> str:
        """The current world as the text of its file."""
        return self._text.of(self.world)

    # ------------------------------------------------------------ inside

    def _odometry(self) -> Odometry:
        return Odometry(self.frame.odometry_speed, self.frame.odometry_yaw_rate, self.frame.dt)

    def _think(self, watch: Callable[[str], None]) -> Estimate:
        """One step of the brain. The scene number is made from the true pose, so the brain gets it only if its front
        end is "scene numbers", as in the papers' own simulator."""
        self.odometry = odometry = self._odometry()
        numbers = self.brain.params.local_view.front_end == "scene numbers"
        estimate = self.brain.step(
            self.frame.image,
            odometry,
            scene=self.frame.scene if numbers else None,
            behaviour=self.pilot.behaviour.number,
            ranges_m=self.frame.ranges_m,
            watch=watch,
        )
        self.evaluation.record(self.time_s, self.simulator.truth, self.brain.experience_map, estimate.created, odometry)
        return estimate

    def _take(self, section: str, change: dict[str, Value]) -> None:
        """Hand the changed live parameters of a section to the part that uses them."""
        brain = self.brain
        if section == "robot":
            self.simulator.set_params(replace(self.simulator.params, **change))  # type: ignore[arg-type]
        elif section == "office":
            self.simulator.office = replace(self.simulator.office, **change)  # type: ignore[arg-type]
        elif section == "pilot":
            self.pilot.params = replace(self.pilot.params, **change)  # type: ignore[arg-type]
        else:
            brain.set_params(replace(brain.params, **{section: replace(getattr(brain.params, section), **change)}))


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


def is_lost(session: Session) -> bool:
    """Whether the brain has declared itself lost, or a second packet holds more than a fifth of the activity."""
    packets = session.brain.pose_cells.packets
    return session.brain.lost or (len(packets) > 1 and packets[1].mass > 0.2)
