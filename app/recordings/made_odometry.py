"""Odometry made from a recording's truth, with errors of known size, for recordings that have poses but no wheels."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from app.recordings.formats.sensed import Rates
from app.recordings.recording import About, Moment, Recording, Wanted, every


@dataclass(frozen=True, slots=True)
class OdometryErrors:
    """The errors that wheels would have made."""

    speed_noise: float  # standard deviation, as a share of the speed
    yaw_noise: float  # standard deviation (rad/s)
    yaw_bias: float  # rad/s, the same all the time

    def __post_init__(self) -> None:
        for name, low in (("speed_noise", 0.0), ("yaw_noise", 0.0), ("yaw_bias", -10.0)):
            if not low <= getattr(self, name) <= 10.0:
                raise ValueError(f"{name} must be from {low:g} to 10, got {getattr(self, name):g}")


def parse_errors(text: str) -> OdometryErrors:
    """SPEED_NOISE,YAW_NOISE,BIAS as numbers. ValueError."""
    parts = text.split(",")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) != 3:
        raise ValueError(
            f"--odometry-from-truth takes SPEED_NOISE,YAW_NOISE,BIAS (such as 0.1,0.02,0.005), got {text[:60]!r}"
        )
    return OdometryErrors(*values)


class WithMadeOdometry:
    """A recording whose speed and yaw rate are made from its truth. The same seed makes the same errors."""

    def __init__(self, recording: Recording, errors: OdometryErrors, seed: int) -> None:
        """ValueError: it has no truth."""
        if "truth" not in recording.about.has:
            raise ValueError(f"{recording.about.name}: has no truth that odometry could be made from")
        self._recording, self._errors, self._seed = recording, errors, seed

    @property
    def about(self) -> About:
        about, e = self._recording.about, self._errors
        made = (
            f"speed and yaw rate: made from the truth, with noise of {e.speed_noise:g} of the speed and "
            f"{e.yaw_noise:g} rad/s, and a bias of {e.yaw_bias:g} rad/s"
        )
        return replace(
            about,
            has=about.has | {"speed", "yaw rate"},
            uses=(*(use for use in about.uses if not use.startswith("no odometry")), made),
        )

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        rng, rates = np.random.default_rng(self._seed), Rates()
        for moment in self._recording.moments(wanted):
            speed = turn = 0.0
            if moment.truth is not None:
                speed, turn = rates.since(round(moment.time_s * 1e9), moment.truth) or (0.0, 0.0)
            noise = rng.standard_normal(2)
            speed *= 1 + self._errors.speed_noise * float(noise[0])
            turn += self._errors.yaw_noise * float(noise[1]) + self._errors.yaw_bias
            if not math.isfinite(speed + turn):
                speed = turn = 0.0
            yield replace(moment, speed=speed, yaw_rate=turn)
