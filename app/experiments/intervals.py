"""How sure a figure is: Wilson's interval for a rate, the bootstrap for the rest."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Z_95 = 1.959963984540054  # 95 % of a normal distribution lie within so many standard deviations of its mean
_PER_CENT = 2.5, 97.5
_RESAMPLES = 2000
_LEAST_RESAMPLES = 200
_DRAWS = 2_000_000  # at most, in all resamples: ten thousand values need fewer of them
_SEED = 2006

_Statistic = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value, the ends of its 95 % interval, and what n values it is from. NaN: cannot be told from so few."""

    value: float
    low: float
    high: float
    n: int


def wilson(successes: int, of: int) -> Estimate:
    """A rate from 0 to 1 and its interval, after Wilson (1927). ValueError if there are more successes than trials."""
    if not 0 <= successes <= of:
        raise ValueError(f"successes must be from 0 to of = {of}, got {successes}")
    if of == 0:
        return Estimate(math.nan, 0.0, 1.0, 0)
    rate, z2 = successes / of, Z_95**2
    middle = (rate + z2 / (2 * of)) / (1 + z2 / of)
    half = Z_95 / (1 + z2 / of) * math.sqrt(rate * (1 - rate) / of + z2 / (4 * of * of))
    low = 0.0 if successes == 0 else middle - half  # exactly, where the sum would leave a rounding error
    return Estimate(rate, low, 1.0 if successes == of else middle + half, of)


def bootstrap_median(values: Sequence[float]) -> Estimate:
    """The median and its interval. The same values in the same order give the same interval."""
    return _bootstrap(values, np.median)


def bootstrap_mean(values: Sequence[float]) -> Estimate:
    """The mean and its interval. The same values in the same order give the same interval."""
    return _bootstrap(values, np.mean)


def _bootstrap(values: Sequence[float], statistic: _Statistic) -> Estimate:
    """Percentiles of the statistic over samples drawn from the values with replacement (Efron 1979)."""
    sample: NDArray[np.float64] = np.asarray(values, np.float64)
    n = len(sample)
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan, 0)
    if n == 1:
        return Estimate(float(sample[0]), math.nan, math.nan, 1)
    resamples = max(_LEAST_RESAMPLES, min(_RESAMPLES, _DRAWS // n))
    drawn = sample[np.random.default_rng(_SEED).integers(0, n, (resamples, n))]
    low, high = np.percentile(statistic(drawn, axis=1), _PER_CENT)
    return Estimate(float(statistic(sample)), float(low), float(high), n)
