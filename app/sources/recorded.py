"""A recording as the source of a session: the same brain, looked at and changed in the same way, and no office or pilot.

What a recording does not have is absent: an order that needs it is refused. The recording itself is no part of the state:
copies of a session share it.
"""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from app.config import Value
from app.pilot import Pilot
from app.recordings.playing import Player
from app.recordings.recording import About, Moment, Pose, Recording
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


BUDGET_BYTES = 48_000_000  # of moments that are held, most of it pictures
MOST_CURSORS = 4  # places at which it is being read: the present, the past, and what they are compared with


class Reel:
    """[ours] Reads on where it has read before; to go back it reads from the beginning, without unpacking pictures on the way.

    To be used from one thread at a time.
    """

    def __init__(self, recording: Recording, budget_bytes: int = BUDGET_BYTES) -> None:
        self._recording, self._budget_bytes = recording, budget_bytes
        self._cursors: list[_Cursor] = []  # the one that was used last is the last
        self._held: OrderedDict[int, Moment] = OrderedDict()  # the same
        self._held_bytes = 0
        self._times = array("d")  # s, of all moments up to the farthest that was passed
        self._length: int | None = None  # once the end was seen

    @property
    def nbytes(self) -> int:
        """Of the moments that are held."""
        return self._held_bytes

    def has(self, number: int) -> bool:
        """Whether there is a moment of this number. It is read, if nobody has been so far yet."""
        if number < len(self._times):
            return True
        return self._length is None and self._read(number) is not None

    def at(self, number: int) -> Moment:
        """The moment of this number, from 0. ValueError: there is none, or it cannot be read again."""
        moment = self._held.get(number)
        if moment is not None:
            self._held.move_to_end(number)
            return moment
        moment = self._read(number)
        if moment is None:
            raise ValueError(f"{self._recording.about.name}: moment {number} is not there, or not any more")
        return moment

    def number_at(self, time_s: float) -> int:
        """The last moment at or before a time, among those that were passed; 0 before all of them."""
        return max(0, bisect_right(self._times, time_s + 1e-9) - 1)

    # ------------------------------------------------------------ inside

    def _read(self, number: int) -> Moment | None:
        """None: the recording ends before it."""
        cursor = self._cursor_to(number)
        try:
            moment = cursor.read(number, self._times)
        except BaseException:
            self._cursors.remove(cursor)
            raise
        if moment is None:
            self._length = len(self._times)
            self._cursors.remove(cursor)
            return None
        self._hold(number, moment)
        return moment

    def _cursor_to(self, number: int) -> _Cursor:
        """The nearest one before a moment, or a new one at the beginning."""
        before = [cursor for cursor in self._cursors if cursor.next <= number]
        if before:
            cursor = max(before, key=lambda each: each.next)
            self._cursors.remove(cursor)
        else:
            cursor = _Cursor(self._recording)
            if len(self._cursors) == MOST_CURSORS:
                self._cursors.pop(0).close()
        self._cursors.append(cursor)
        return cursor

    def _hold(self, number: int, moment: Moment) -> None:
        self._held[number] = moment
        self._held_bytes += _size(moment)
        while self._held_bytes > self._budget_bytes and len(self._held) > 2:  # a tick needs its own and the next
            _, dropped = self._held.popitem(last=False)
            self._held_bytes -= _size(dropped)


class _Cursor:
    """A place at which a recording is being read."""

    def __init__(self, recording: Recording) -> None:
        self._moments: Iterator[Moment] = recording.moments(lambda number: number >= self._goal)
        self._goal = self.next = 0  # numbers of the moment that is wanted, and of the one that comes next

    def read(self, number: int, times: array[float]) -> Moment | None:
        """Go on to this moment. times: those of all moments that were passed before, to which new ones are added."""
        self._goal = number
        for moment in self._moments:
            if self.next == len(times):
                times.append(moment.time_s)
            self.next += 1
            if self.next > number:
                return moment
        return None

    def close(self) -> None:
        close = getattr(self._moments, "close", None)  # a generator may hold a file open
        if close is not None:
            close()


def _size(moment: Moment) -> int:
    """Bytes."""
    parts = (moment.image, moment.ranges_m)
    return 500 + sum(part.nbytes for part in parts if isinstance(part, np.ndarray))
