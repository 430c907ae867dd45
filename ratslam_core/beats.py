"""[ours] The beat of the engine: what the papers count in iterations of their 10 Hz loop is counted in tenths of a second.

A view injects, learns and is counted, the attractor iterates and the map is corrected once in each beat, however often
the sensors report. Between two beats only odometry is summed up. A tick that lasts longer than a beat counts for
several. At 10 Hz each tick is a beat, as in the papers. test_beats.py, test_rates.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from ratslam_core.types import Odometry

BEAT_S = 0.1
BEATS_A_SECOND = 10.0  # 0.1 s of it are exactly one beat
EARLY = 0.1  # of a beat: a tick may come so much too early and still be on the beat
MOST = 100  # beats in one tick; a longer one counts for no more, since nobody was looking


@dataclass(frozen=True, slots=True)
class Tick:
    """What odometry says at the end of a tick, in equal parts, one for each beat that ends with it."""

    beats: int  # 0 between two
    moved: Odometry  # since the beat before; without a beat it means nothing
    latest: Odometry  # in this tick alone
    turned_rad: float  # since the beat before, as the wheels say, left positive

    def without(self, yaw_bias: float) -> Tick:
        """[ours] The same without this bias of the yaw rate (rad/s). Wheels that stand still have none."""
        if yaw_bias == 0.0:
            return self
        moved, latest = _without(self.moved, yaw_bias), _without(self.latest, yaw_bias)
        return Tick(self.beats, moved, latest, self.turned_rad)


@kind("beats/1")
class Beats:
    """The time and the movement since the last beat."""

    def __init__(self) -> None:
        self._begun = False
        self._over = 0.0  # beats since the last one; a little below 0 when it came too early
        self._distance_m = self._turn_rad = self._time_s = 0.0  # summed up since

    def due(self, dt: float) -> int:
        """How many beats end with a tick of `dt` seconds; 0 between two. The very first tick is one beat, however long."""
        return min(math.floor(self._passed(dt) + EARLY), MOST) if self._begun else 1

    def turned_by(self, odometry: Odometry) -> float:
        """The turn (rad, left positive) since the last beat, this tick included."""
        return self._turn_rad + odometry.yaw_rate * odometry.dt

    def take(self, odometry: Odometry) -> Tick:
        """Count a tick."""
        beats, whole, turned_rad = self.due(odometry.dt), odometry, self.turned_by(odometry)
        self._over = self._passed(odometry.dt) - beats if self._begun and beats < MOST else 0.0
        self._begun = True
        if beats == 0 or self._time_s > 0:
            self._distance_m += odometry.speed * odometry.dt
            self._turn_rad += odometry.yaw_rate * odometry.dt
            self._time_s += odometry.dt
            whole = Odometry(self._distance_m / self._time_s, self._turn_rad / self._time_s, self._time_s)
        if beats:
            self._distance_m = self._turn_rad = self._time_s = 0.0
        return Tick(beats, shared(whole, beats), shared(odometry, beats), turned_rad)

    def _passed(self, dt: float) -> float:
        return self._over + dt * BEATS_A_SECOND


def shared(odometry: Odometry, beats: int) -> Odometry:
    """The same movement, cut into so many equal pieces; one of them."""
    return odometry if beats <= 1 else Odometry(odometry.speed, odometry.yaw_rate, odometry.dt / beats)


def _without(odometry: Odometry, yaw_bias: float) -> Odometry:
    return odometry if odometry.still else Odometry(odometry.speed, odometry.yaw_rate - yaw_bias, odometry.dt)


def weight(rate: float, beats: int) -> float:
    """The weight of the newest value in a running mean that moves by `rate` in each beat, after so many alike."""
    return rate if beats == 1 else 1.0 - (1.0 - rate) ** beats
