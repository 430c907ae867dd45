"""Intervals: the same as another implementation's, and as their definition says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from app.experiments.intervals import bootstrap_mean, bootstrap_median, wilson


@pytest.mark.parametrize(("successes", "of"), [(0, 1), (1, 1), (0, 30), (25, 30), (54, 60), (60, 60), (333, 1000)])
def test_wilsons_interval_is_that_of_scipy(successes: int, of: int) -> None:
    theirs = stats.binomtest(successes, of).proportion_ci(0.95, "wilson")
    ours = wilson(successes, of)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)
    assert ours.value == successes / of
    assert ours.n == of


def test_a_rate_of_nothing_may_be_anything() -> None:
    nothing = wilson(0, 0)
    assert math.isnan(nothing.value)
    assert (nothing.low, nothing.high, nothing.n) == (0.0, 1.0, 0)


@pytest.mark.parametrize(("successes", "of"), [(3, 2), (-1, 2)])
def test_more_successes_than_trials_are_refused(successes: int, of: int) -> None:
    with pytest.raises(ValueError, match=f"from 0 to of = 2, got {successes}"):
        wilson(successes, of)


@pytest.mark.parametrize(("ours", "statistic"), [(bootstrap_median, np.median), (bootstrap_mean, np.mean)])
def test_the_bootstrap_is_that_of_scipy(ours, statistic) -> None:
    values = np.random.default_rng(7).gamma(2.0, 3.0, 40)
    theirs = stats.bootstrap(
        (values,), statistic, n_resamples=20_000, method="percentile", rng=np.random.default_rng(1)
    ).confidence_interval
    found = ours(list(values))
    width = theirs.high - theirs.low
    assert found.value == statistic(values)
    assert found.low == pytest.approx(theirs.low, abs=0.1 * width)
    assert found.high == pytest.approx(theirs.high, abs=0.1 * width)
    assert ours(list(values)) == found


def test_the_interval_of_a_mean_is_that_of_its_standard_error() -> None:
    values = np.random.default_rng(3).normal(10.0, 2.0, 5000)
    found, half = bootstrap_mean(list(values)), 1.96 * 2.0 / math.sqrt(5000)
    assert (found.low, found.high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.2 * half)


def test_one_value_has_no_interval_and_no_value_nothing() -> None:
    one, none = bootstrap_median([4.0]), bootstrap_median([])
    assert (one.value, one.n) == (4.0, 1)
    assert math.isnan(one.low)
    assert math.isnan(one.high)
    assert math.isnan(none.value)
    assert none.n == 0
