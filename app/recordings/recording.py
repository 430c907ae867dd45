"""A recording of a robot, whatever format it came in: what it has, and its moments one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from app.config import Config

Pose = tuple[float, float, float]  # x, y (m), heading (rad, counter-clockwise)
Wanted = Callable[[int], bool]  # whether the picture of the moment of this number, from 0, is wanted


def every(_number: int) -> bool:
    """All pictures are wanted."""
    return True


@dataclass(frozen=True, slots=True)
class Moment:
    """What was sensed at one moment, usually that of a camera's picture. None: the recording does not have it."""

    frame: int  # its number in the recording, from 0; pictures that cannot be read are left out, and their numbers with them
    time_s: float  # since the recording's first moment; never goes back
    dt: float  # s since the moment before; of the first one, that of a typical one. The motion below is that of this time
    image: NDArray[np.uint8] | None = None  # (h, w, 3), RGB
    speed: float | None = None  # m/s forwards, by wheels
    yaw_rate: float | None = None  # rad/s counter-clockwise, by wheels or a gyro
    throttle: float | None = None  # -1 to 1, of a car without wheel encoders
    ranges_m: NDArray[np.float64] | None = None  # (beams,), of the laser or the sonars; inf: nothing in range
    truth: Pose | None = None  # for judging and drawing, never for the robot
    behaviour: int = 0  # the local movement that led here, 0 to 15; only runs of ours have it


@dataclass(frozen=True, slots=True)
class Count:
    """How much of one source could be read."""

    what: str  # "messages of /odom", "lines of values.csv", "pictures"
    read: int
    there: int  # all of them, the unreadable, too


@dataclass(frozen=True, slots=True)
class About:
    """What a recording says of itself before it is played."""

    name: str
    format: str  # "Donkey tub", "MCAP", ...
    moments: int
    seconds: float
    has: frozenset[str]  # of "camera", "speed", "yaw rate", "throttle", "ranges", "truth"
    image_shape: tuple[int, int] | None = None  # (h, w)
    beam_angles_rad: tuple[float, ...] = ()  # of each range from straight ahead, left is positive
    range_limit_m: float | None = None
    uses: tuple[str, ...] = ()  # sentences: what is used for what
    config: Config | None = None  # of a run of ours: its parameters ...
    seed: int | None = None  # ... and its seed
    problems: tuple[str, ...] = ()  # sentences with the message or line where something is wrong
    counts: tuple[Count, ...] = ()  # of each source that is used
    unused: tuple[str, ...] = ()  # sentences: each file, topic and column that is not used, and why

    @property
    def whole(self) -> bool:
        """Whether all that is in it is played, and nothing is wrong with it."""
        return not self.problems and not self.unused and all(count.read == count.there for count in self.counts)


class Recording(Protocol):
    """A file or folder that was opened. It can be played more than once, each time the same."""

    @property
    def about(self) -> About: ...

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        """In order of time. Pictures are read one by one, so that a long recording needs no more memory than a short one.

        wanted: the others may come without their pictures, which is much quicker. There are the same moments then.
        """
        ...
