"""Logs of a laser that nobody tuned on: one real log, changed as other robots would have written it.

Half of the variants are for developing (`python -m benchmarks.recordings variants`), the other half is looked at only in
the end (`held-out`). laser_drives.py has drives of ours in other buildings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.sensed import Rates
from app.recordings.recording import About, Moment, Recording, Wanted, every
from ratslam_core import wrap_angles

Array = NDArray[np.float64]
DT = 0.1  # of a first moment, s


@dataclass(frozen=True, slots=True)
class Log:
    """Scans and the poses that wheels led to, one row a scan."""

    times: Array  # (n,) s
    was: Array  # (n,) s, when this scan was taken in the log that it was made from
    wheels: Array  # (n, 3)
    ranges: Array  # (n, beams) m; inf: nothing in range
    angles: Array  # (beams,) rad
    limit_m: float
    truth: Array | None = None  # (n, 3)
    mirrored: bool = False


class Logged:
    """A log as a recording."""

    def __init__(self, log: Log, name: str) -> None:
        has, n = frozenset({"speed", "yaw rate", "ranges"}), len(log.times)
        angles = tuple(log.angles.tolist())
        seconds = float(log.times[-1] - log.times[0])
        self.about = About(name, "made", n, seconds, has, beam_angles_rad=angles, range_limit_m=log.limit_m)
        self._log = log

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:  # noqa: ARG002  # there are no pictures
        log, rates, before = self._log, Rates(), float(self._log.times[0]) - DT
        for k, time in enumerate(log.times.tolist()):
            x, y, heading = log.wheels[k].tolist()
            speed, yaw_rate = rates.since(round(time * 1e9), (x, y, heading)) or (0.0, 0.0)
            yield Moment(
                k, time - float(log.times[0]), time - before, speed=speed, yaw_rate=yaw_rate, ranges_m=log.ranges[k]
            )
            before = time


def log_of(recording: Recording) -> Log:
    """The wheels are added up from what the moments tell."""
    about, at = recording.about, np.zeros(3)
    times: list[float] = []
    wheels: list[Array] = []
    ranges: list[Array] = []
    for moment in recording.moments():
        if moment.ranges_m is None:
            continue
        at = moved(at, (moment.speed or 0.0) * moment.dt, (moment.yaw_rate or 0.0) * moment.dt)
        times.append(moment.time_s)
        wheels.append(at)
        ranges.append(moment.ranges_m)
    clock = np.array(times)
    angles, limit = np.array(about.beam_angles_rad), about.range_limit_m or 80.0
    return Log(clock, clock, np.array(wheels), np.array(ranges), angles, limit)


# ------------------------------------------------------------ variants


def _picked(log: Log, rows: Any) -> Log:
    truth = None if log.truth is None else log.truth[rows]
    return replace(
        log, times=log.times[rows], was=log.was[rows], wheels=log.wheels[rows], ranges=log.ranges[rows], truth=truth
    )


def every_nth(log: Log, n: int) -> Log:
    return _picked(log, slice(None, None, n))


def part(log: Log, first: float, last: float) -> Log:
    """From one share of the scans to another."""
    n = len(log.times)
    return _picked(log, slice(int(first * n), int(last * n)))


def backwards(log: Log) -> Log:
    """Time runs the other way, so the robot drives backwards."""
    turned = _picked(log, slice(None, None, -1))
    return replace(turned, times=log.times[-1] - turned.times)


def mirrored(log: Log) -> Log:
    """Left is right. `judged` mirrors the path back."""
    return replace(
        log, wheels=log.wheels * (1.0, -1.0, -1.0), ranges=log.ranges[:, ::-1], angles=-log.angles[::-1], mirrored=True
    )


def with_wheels(
    log: Log, scale: float = 1.0, turns: float = 1.0, bias: float = 0.0, noise: float = 0.0, seed: int = 0
) -> Log:
    """Wheels with more errors: ways and turns times a factor, rad/s while they turn, and noise as a share of ways and turns."""
    rng, steps = np.random.default_rng(seed), np.diff(log.wheels, axis=0)
    turn = wrap_angles(steps[:, 2])
    middle = log.wheels[:-1, 2] + turn / 2
    way = steps[:, 0] * np.cos(middle) + steps[:, 1] * np.sin(middle)
    dt = np.minimum(np.diff(log.times), 5.0)  # a pause is no drive
    shaken = rng.standard_normal((2, len(way)))
    drives = (way != 0) | (turn != 0)
    way = way * scale * (1 + noise * shaken[0])
    turn = turn * turns * (1 + noise * shaken[1]) + bias * dt * drives
    at = [log.wheels[0]]
    for step, angle in zip(way.tolist(), turn.tolist(), strict=True):
        at.append(moved(at[-1], step, angle))
    return replace(log, wheels=np.array(at))


def cut(log: Log, limit_m: float) -> Log:
    """A laser that sees no farther."""
    return replace(log, ranges=np.where(log.ranges >= limit_m, np.inf, log.ranges), limit_m=limit_m)


def beams(log: Log, n: int) -> Log:
    """Every nth beam."""
    return replace(log, ranges=log.ranges[:, ::n], angles=log.angles[::n])


def narrow(log: Log, half_rad: float) -> Log:
    """A laser that sees ahead only."""
    seen = np.abs(log.angles) <= half_rad
    return replace(log, ranges=log.ranges[:, seen], angles=log.angles[seen])


def noisy(log: Log, sigma_m: float = 0.0, lost: float = 0.0, seed: int = 0) -> Log:
    """Ranges with more noise, and a share of the beams that come back from nowhere."""
    rng = np.random.default_rng(seed)
    ranges = np.maximum(log.ranges + sigma_m * rng.standard_normal(log.ranges.shape), 0.02)
    return replace(log, ranges=np.where(rng.random(log.ranges.shape) < lost, np.inf, ranges))


Change = Callable[[Log], Log]
OF_A_LOG: dict[str, Change] = {
    "as it is": lambda log: log,
    "every second scan": lambda log: every_nth(log, 2),
    "first half": lambda log: part(log, 0.0, 0.5),
    "mirrored": mirrored,
    "turns 7 % too large, ways 5 % too short": lambda log: with_wheels(log, scale=0.95, turns=1.07),
    "wheels 15 % noise": lambda log: with_wheels(log, noise=0.15),
    "ranges up to 8 m": lambda log: cut(log, 8.0),
    "range noise 3 cm": lambda log: noisy(log, 0.03),
    "10 % of beams lost": lambda log: noisy(log, lost=0.1),
}
OF_A_LOG_HELD_OUT: dict[str, Change] = {
    "every third scan": lambda log: every_nth(log, 3),
    "second half": lambda log: part(log, 0.5, 1.0),
    "from a quarter on": lambda log: part(log, 0.25, 1.0),
    "backwards in time": backwards,
    "bias of 1 deg/s": lambda log: with_wheels(log, bias=math.radians(1.0)),
    "ways 10 % too long": lambda log: with_wheels(log, scale=1.1),
    "every second beam": lambda log: beams(log, 2),
    "120 degrees": lambda log: narrow(log, math.radians(60)),
    "range noise 5 cm": lambda log: noisy(log, 0.05, seed=1),
    "mirrored, noise 2 cm, up to 12 m, wheels 10 %": lambda log: cut(
        noisy(with_wheels(mirrored(log), noise=0.1, seed=2), 0.02, seed=2), 12.0
    ),
}


def moved(at: Array, way: float, turn: float) -> Array:
    middle = float(at[2]) + turn / 2
    return at + np.array([way * math.cos(middle), way * math.sin(middle), turn])
