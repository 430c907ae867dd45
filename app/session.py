"""The closed loop, one tick at a time: source -> RatSLAM -> pilot -> source, and a judge. Start reading here.

No thread, no clock, no page: the same seed and the same calls give the same run, bit for bit.
"""

from __future__ import annotations

import copy
import hashlib
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.companion import SECTIONS, Companion
from app.config import Config, Value
from app.evaluation import Evaluation
from app.orders import UNCHANGED, Order, order
from app.pilot import Mode, Pilot
from app.pilot.route_following import nearest_to, of_its_place
from app.recordings.playing import Player
from app.recordings.recording import About
from app.sensor_input import Lap
from app.sources.recorded import Recorded
from app.sources.simulated import Simulated
from app.sources.source import Source
from disk import copy_state, encode, kind
from disk.words import one_line
from ratslam_core import Estimate, PoseCells, RatSlam
from ratslam_core.pose_cells.attractor_kernels import gaussian
from ratslam_core.slam import STAGES
from ratslam_core.types import wrap_angle
from sim2d import SONAR_ANGLES_RAD, Box, SensorFrame, Simulator, Truth, World

SECOND = "second brain"  # the part of a tick that there is while two brains are compared
MOST_TAGS = 24
LONGEST_NAME = 40


@kind("session/3")
class Session:
    """One source of senses, one brain that maps by them, one pilot that drives by the map, and what judges the map by the
    truth. The methods marked as orders are what it can be told between two ticks: they are kept with a run and can be
    given again. ValueError says why an order cannot be carried out; nothing has changed then."""

    CACHES = ("stopwatch", "sensed", "on_order", "under_orders")
    companion: Companion | None = None  # an attribute of those sessions only that have one

    def __init__(
        self, source: World | Source, seed: int = 0, config: Config | None = None, brain: RatSlam | None = None,
        before: Session | None = None,
    ) -> None:  # fmt: skip
        """source: an office to be simulated, or another source of senses, as of a recording.

        brain: one that already knows places and has to find out where it is, or a new one built from the caller's parts.
        before: another session; what was computed from the same walls is taken over. It does not change the result.
        """
        self.seed, self.config = seed, config or Config()
        if isinstance(source, World):
            source = Simulated(source, seed, self.config, before and before.source)
        self.source: Source = source
        if brain is None:
            brain = self.new_brain(self.config)
        else:
            brain.set_params(self.config.engine)
            if len(brain.experience_map) > 0:  # an empty map holds no place to be found again
                brain.declare_kidnapped()
        self.brain, self.ties = brain, source.new_ties()
        _, pilot_seed = np.random.SeedSequence([seed, 1]).spawn(2)
        self.pilot = Pilot(self.config.pilot, np.array(SONAR_ANGLES_RAD), np.random.default_rng(pilot_seed))
        self.evaluation = Evaluation(len(brain.experience_map))
        self.tags: dict[str, int] = {}  # name -> the experience that was active when somebody gave it
        self._begin()
        self.estimate: Estimate = self._think(self.stopwatch.lap)

    def settle(self, worlds: tuple[World, ...], before: Session | None = None) -> None:
        """Compute the caches anew in a session that was restored from a state (session_snapshot.py).

        worlds: as `worlds`; before: as above.
        """
        self.source.settle(worlds, before and before.source)
        self._begin()

    def new_brain(self, config: Config) -> RatSlam:
        """One that knows nothing."""
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        rng = np.random.default_rng(brain_seed)
        return RatSlam(config.engine, rng, sonar_angles_rad=self.source.beam_angles_rad)

    def _begin(self) -> None:
        self.stopwatch = Stopwatch((*self.source.parts, *STAGES, "judging", SECOND))
        self.sensed = self.source.sensed(self.pilot.behaviour.number)
        self.on_order: Callable[[Order], object] = _nobody
        self.under_orders = False

    def tick(self, watch: Lap | None = None) -> None:
        """Run one tick, one sensor period; after the last moment of a recording nothing happens. watch: called after each
        stage of RatSLAM; it must not change anything."""
        clock = self.stopwatch
        clock.start()
        if self.source.over:
            return

        def staged(stage: str) -> None:
            clock.lap(stage)
            if watch is not None:
                watch(stage)
                clock.start()  # the time of watching does not count

        self.source.advance(self.pilot, self.brain.experience_map, clock.lap)
        self.sensed = self.source.sensed(self.pilot.behaviour.number)
        self.estimate = self._think(staged)
        clock.lap("judging")
        if self.companion is not None:
            self._follow(self.companion)
            clock.lap(SECOND)
        clock.finish()

    def _think(self, watch: Lap) -> Estimate:
        """One step of the brain on what is sensed in this tick, compared with the truth where that is known."""
        self.odometry = self.sensed.odometry  # as given to the brain in its last step
        estimate = self.sensed.step(self.brain, self.ties, watch)
        truth = self.source.truth
        if truth is not None:
            map_ = self.brain.experience_map
            self.evaluation.record(self.time_s, truth, map_, estimate.created, self.odometry)
        return estimate

    def _follow(self, companion: Companion) -> None:
        companion.follow(self.sensed, self.time_s, self.tick_count, self.truth, self.brain, self.estimate)

    # ------------------------------------------------------------ looking

    @property
    def frame(self) -> SensorFrame:
        """What was sensed last."""
        return self.source.frame

    @property
    def tick_count(self) -> int:
        return self.source.frame.tick

    @property
    def time_s(self) -> float:
        return self.source.frame.time_s

    @property
    def truth(self) -> Truth | None:
        """Where the robot really is, as far as the source knows it. Never for the robot."""
        return self.source.truth

    @property
    def recording(self) -> About | None:
        """What is played; None: an office is simulated."""
        return self.source.recording

    @property
    def player(self) -> Player | None:
        """Plays the recording from its beginning, with the parameters as they are now. None: an office is simulated."""
        if not isinstance(self.source, Recorded):
            return None
        player = copy.copy(self.source.player)
        player.config = self.config
        return player

    @property
    def office(self) -> Simulated:
        """ValueError: there is none."""
        if not isinstance(self.source, Simulated):
            raise ValueError("a recording plays: it has no office")
        return self.source

    @property
    def simulator(self) -> Simulator:
        return self.office.simulator

    @property
    def world(self) -> World:
        """The one that a reset begins in."""
        return self.office.world

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about its parameters, in sentences."""
        foreign = tuple(f"{section}." for section in self.source.foreign)
        return tuple(words for words in self.config.warnings if not any(name in words for name in foreign))

    def state_hash(self) -> str:
        """A digest of everything that decides the future, and of the evaluation. Equal runs have equal hashes."""
        return self.digest(self.source.world_texts)

    def digest(self, world_texts: tuple[str, str]) -> str:
        """`state_hash` of a session or of a copy of one, which has no worlds."""
        source, evaluation = self.source.decides, self.evaluation
        parts = (*world_texts, self.seed, self.config, source, self.pilot, self.brain, evaluation, self.tags)
        if self.ties is not None:
            parts += (self.ties,)
        return hashlib.sha256("".join(encode(part).digest() for part in parts).encode()).hexdigest()

    # ------------------------------------------------------------ to the robot

    @order
    def set_goal(self, x: float, y: float) -> int:
        """Go to the place (x, y), metres in the map's frame: to the quickest of all experiences that stand for it. Returns
        the one nearest to it."""
        return self.go_to_place_of(nearest_to(self.brain.experience_map, x, y))

    @order
    def go_to_place_of(self, experience: int) -> int:
        """Go to this experience or another of its place. Returns the first of them."""
        first, *others = of_its_place(self.brain.experience_map, experience, self.pilot.params)
        self.pilot.set_goal(first, others)
        return first

    @order
    def go_to(self, experience: int) -> None:
        """Go to this very experience."""
        self.pilot.set_goal(experience)

    @order
    def cancel_goal(self) -> None:
        self.pilot.cancel_goal()

    @order
    def tag(self, name: str) -> int:
        """Name the place of the pose estimate, as "the kitchen", to send the robot there later. A name that is
        given again moves. Returns the active experience. IROS 2005 IV."""
        name = one_line(name.strip())
        if not name:
            raise ValueError("a tag needs a name")
        if name not in self.tags and len(self.tags) >= MOST_TAGS:
            raise ValueError(f"{name!r} would be tag number {MOST_TAGS + 1}; {MOST_TAGS} are enough, remove one first")
        self.tags[name] = self.brain.experience_map.active
        return self.tags[name]

    @order
    def untag(self, name: str) -> None:
        del self.tags[self._tagged(name)]

    @order
    def go_to_tag(self, name: str) -> int:
        """Go to the place of this name, as after a click there. Returns its experience."""
        return self.go_to_place_of(self.tags[self._tagged(name)])

    def _tagged(self, name: str) -> str:
        if name not in self.tags:
            known = f"one of: {', '.join(self.tags)}" if self.tags else "given first; there is none yet"
            raise ValueError(f"there is no tag {name!r}; it must be {known}")
        return name

    @order
    def set_mode(self, mode: Mode) -> None:
        self.pilot.set_mode(mode)

    @order
    def drive(self, speed: float, yaw_rate: float) -> object:
        """Drive by hand, m/s forwards and rad/s counter-clockwise, until the next such order. Who holds a key gives the same
        order sixty times a second: it is one order."""
        return None if self.pilot.drive(speed, yaw_rate) else UNCHANGED

    @order
    def kidnap(self, x: float | None = None, y: float | None = None, heading_rad: float | None = None) -> None:
        """Put the robot at (x, y), metres in the office's frame, unknown to the brain. Without a place: a random free one."""
        if x is None and y is None:
            x, y, by_chance = self.simulator.random_free_pose()
            heading_rad = by_chance if heading_rad is None else heading_rad
        if x is None or y is None:
            raise ValueError("a kidnap needs both x and y, or neither for a place by chance")
        heading = self.simulator.truth.heading_rad if heading_rad is None else heading_rad
        self.office.carry(x, y, heading)
        self.evaluation.kidnapped(self.time_s, self.brain.experience_map)
        if self.companion is not None:
            self.companion.evaluation.kidnapped(self.time_s, self.companion.brain.experience_map)

    @order
    def random_free_pose(self) -> tuple[float, float, float]:
        """A random pose where the robot fits now: x, y, heading. It advances the simulator's own generator."""
        return self.simulator.random_free_pose()

    # ------------------------------------------------------------ to the brain

    @order
    def put_packet(self, x: int, y: int, heading_rad: float = 0.0, share: float = 0.4) -> str:
        """Put a packet of activity into the pose cells by hand. Returns what was done, in words."""
        return put_packet(self.brain.pose_cells, x, y, heading_rad, share)

    @order
    def forget_view(self, view: int) -> None:
        """The brain forgets where it has seen this view."""
        self.brain.forget_view(view)

    def set_parameter(self, name: str, value: Value) -> bool:
        """Change one parameter. True if it takes effect at once, False if at the next reset."""
        self.set_parameters({name: value})
        return next(item.metadata["live"] for dotted, item, _ in self.config.items() if dotted == name)

    @order
    def set_parameters(self, values: Mapping[str, Value]) -> list[str]:
        """Change several parameters, all or none. Returns the names of those that wait for the next reset."""
        for name in values:
            if name.split(".")[0] in self.source.foreign:
                raise ValueError(f"a recording plays: {name} is for the simulator, and changes nothing here")
        config = self.config.with_values(values)
        beside = None if self.companion is None else config.with_values(self.companion.values)
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
                self._set_section(section, change)
        self.config = config
        if self.companion is not None and beside is not None:
            self.companion.change(self.companion.config, beside)
        return waiting

    def _set_section(self, section: str, change: dict[str, Value]) -> None:
        """Hand the changed live parameters of a section to the part that uses them."""
        brain = self.brain
        if section in ("robot", "office"):
            self.source.set_section(section, change)
        elif section == "pilot":
            self.pilot.params = replace(self.pilot.params, **change)  # type: ignore[arg-type]
        else:
            brain.set_params(replace(brain.params, **{section: replace(getattr(brain.params, section), **change)}))

    # ------------------------------------------------------------ to the office

    @order
    def edit_world(self, world: World) -> None:
        """Go on in an edited world; a reset begins in it, too. ValueError if something in it would cover the robot."""
        self.simulator.set_world(world)
        self.office.world = world

    @order
    def set_door(self, name: str, is_open: bool) -> None:
        """Open or shut a door. It moves from the next tick on and waits for anybody in its way."""
        self.simulator.set_door(name, is_open)

    @order
    def set_lamp(self, name: str, on: bool) -> None:
        self.simulator.set_lamp(name, on)

    @order
    def put_box(self, box: Box) -> None:
        """Put a new box down. ValueError if it would cover the robot or is outside."""
        self.simulator.put_box(box)

    @order
    def remove_box(self, name: str) -> None:
        self.simulator.remove_box(name)

    # ------------------------------------------------------------ to a second brain, beside the first [ours]

    @order
    def begin_companion(self, first: str, name: str, values: Mapping[str, Value], anew: bool) -> None:
        """Give a second brain the same senses from now on. It replaces one that there is.

        first, name: what the two are called. values: the parameters that make the difference; all others are those of the
        first, now and later. anew: it knows nothing, which is possible before the first tick only; otherwise it begins as
        a copy of the first.
        """
        names = first.strip(), name.strip()
        for given in names:
            if not 0 < len(one_line(given)) <= LONGEST_NAME:
                raise ValueError(
                    f"a brain that is compared needs a name of 1 to {LONGEST_NAME} characters, got {given!r}"
                )
        config = config_beside(self.config, values)
        self.companion = self._anew(names, values, config) if anew else self._copy(names, values, config)

    @order
    def end_companion(self) -> None:
        if self.companion is None:
            raise ValueError("there is no second brain to be ended")
        del self.companion

    def _anew(self, names: tuple[str, str], values: Mapping[str, Value], config: Config) -> Companion:
        if self.tick_count > 0:
            raise ValueError("a new brain begins together with the run: restart it, or compare with a copy from now on")
        companion = Companion(names, dict(values), config, self.new_brain(config), Evaluation(), self.time_s)
        companion.ties = self.source.new_ties()
        self._follow(companion)
        return companion

    def _copy(self, names: tuple[str, str], values: Mapping[str, Value], config: Config) -> Companion:
        fixed = [
            dotted
            for (dotted, item, old), (_, _, new) in zip(self.config.items(), config.items(), strict=True)
            if old != new and not item.metadata["live"]
        ]
        if fixed:
            raise ValueError(
                f"{', '.join(fixed)} cannot change while a brain runs: compare from the beginning of a run"
            )
        brain = copy_state(self.brain)
        companion = Companion(names, dict(values), self.config, brain, copy_state(self.evaluation), self.time_s)
        companion.counterpart = list(range(len(brain.experience_map)))
        companion.estimate, companion.ties = self.estimate, copy_state(self.ties)
        companion.change(self.config, config)
        return companion


def config_beside(config: Config, values: Mapping[str, Value]) -> Config:
    """All parameters of a second brain that differs from the first in these. ValueError: it cannot differ in them."""
    foreign = [dotted for dotted in values if dotted.split(".")[0] not in SECTIONS]
    if foreign:
        raise ValueError(f"{foreign[0]} cannot differ between two brains: they have one robot, office and pilot")
    return config.with_values(values)


def played_session(player: Player, seed: int | None = None) -> Session:
    """A session that plays a recording from its beginning. ValueError: there is nothing to be played."""
    player = copy.copy(player)
    player.seed = player.seed if seed is None else seed
    return Session(Recorded(player), player.seed, player.config)


def _nobody(_order: Order) -> object:
    """The default for `on_order`: does nothing."""


def is_lost(session: Session) -> bool:
    """Whether a brain that was carried believes no place, or else a second packet holds more than a fifth of the activity."""
    brain, packets = session.brain, session.brain.pose_cells.packets
    return brain.lost if brain.carried else len(packets) > 1 and packets[1].mass > 0.2


SIGMA, REACH = 1.2, 3  # in cells along x' and y', in layers along theta'


def put_packet(pose_cells: PoseCells, x: int, y: int, heading_rad: float, share: float) -> str:
    """Inject a packet by hand, which competes from the next tick on: a demonstration, no sensor asks for it. Returns what
    was done, in words. ValueError outside the pose cells.

    share: the packet's share of all activity once it is in.
    """
    n_theta, n_y, n_x = pose_cells.shape
    if not (0 <= x < n_x and 0 <= y < n_y):
        raise ValueError(f"a pose cell has x from 0 to {n_x - 1} and y from 0 to {n_y - 1}, got {x} and {y}")
    layer = round(wrap_angle(heading_rad) / math.tau * n_theta) % n_theta
    flat, value = _blob(pose_cells.shape, layer, y, x)
    value *= share / (1 - share) / value.sum()
    pose_cells.inject(flat, value.astype(np.float32))
    pose_cells.settle()
    return f"a packet of {share:.0%} put at cell ({x}, {y}) by hand"


def _blob(shape: tuple[int, int, int], layer: int, y: int, x: int) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The cells (flat indices) within REACH of one cell, wrapped on the torus, and their Gaussian weights."""
    n_theta, n_y, n_x = shape
    around, weights = np.arange(-REACH, REACH + 1), gaussian(SIGMA, REACH).astype(np.float64)
    thetas, ys, xs = np.meshgrid((layer + around) % n_theta, (y + around) % n_y, (x + around) % n_x, indexing="ij")
    flat = ((thetas * n_y + ys) * n_x + xs).ravel().astype(np.int32)
    return flat, np.einsum("t,y,x->tyx", weights, weights, weights).ravel()


KEPT = 100  # ticks that means and worst times are taken over


class Stopwatch:
    """The time that each part of a tick takes. Nothing that the session does depends on it.

    Call `start`, then `lap(part)` after each part, then `finish`. If a part comes twice, its times are added.
    """

    def __init__(self, parts: tuple[str, ...]) -> None:
        self.parts = parts
        self._row = {part: k for k, part in enumerate(parts)}
        self._kept_s = np.zeros((KEPT, len(parts)))
        self._now_s = [0.0] * len(parts)
        self._ticks = 0
        self._then = time.perf_counter()

    def start(self) -> None:
        """A tick begins, or goes on after an interruption that is not to be counted."""
        self._then = time.perf_counter()

    def lap(self, part: str) -> None:
        now = time.perf_counter()
        self._now_s[self._row[part]] += now - self._then
        self._then = now

    def finish(self) -> None:
        """The tick ends."""
        self._kept_s[self._ticks % KEPT] = self._now_s
        self._now_s = [0.0] * len(self.parts)
        self._ticks += 1

    @property
    def mean_and_worst_ms(self) -> dict[str, tuple[float, float]]:
        """Mean and worst time of each part over the last hundred ticks, in milliseconds."""
        kept = 1e3 * self._kept_s[: min(self._ticks, KEPT)]
        if len(kept) == 0:
            return dict.fromkeys(self.parts, (0.0, 0.0))
        means, worsts = kept.mean(0).tolist(), kept.max(0).tolist()
        return dict(zip(self.parts, zip(means, worsts, strict=True), strict=True))
