"""Intervals: the same as another implementation's, and as their definition says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from app.experiments.summary import bootstrap_mean, bootstrap_median, wilson


def test_wilsons_interval_is_that_of_scipy() -> None:
    for successes, of in [(0, 1), (1, 1), (0, 30), (25, 30), (54, 60), (60, 60), (333, 1000)]:
        theirs, ours = stats.binomtest(successes, of).proportion_ci(0.95, "wilson"), wilson(successes, of)
        assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)
        assert (ours.value, ours.n) == (successes / of, of)
    nothing = wilson(0, 0)  # may be anything
    assert (math.isnan(nothing.value), nothing.low, nothing.high, nothing.n) == (True, 0.0, 1.0, 0)
    for successes in (3, -1):
        with pytest.raises(ValueError, match=f"from 0 to of = 2, got {successes}"):
            wilson(successes, 2)


@pytest.mark.parametrize(("ours", "statistic"), [(bootstrap_median, np.median), (bootstrap_mean, np.mean)])
def test_the_bootstrap_is_that_of_scipy(ours, statistic) -> None:
    values = np.random.default_rng(7).gamma(2.0, 3.0, 40)
    theirs = stats.bootstrap(
        (values,), statistic, n_resamples=20_000, method="percentile", rng=np.random.default_rng(1)
    ).confidence_interval
    found, width = ours(list(values)), theirs.high - theirs.low
    assert found.value == statistic(values)
    assert (found.low, found.high) == pytest.approx((theirs.low, theirs.high), abs=0.1 * width)
    assert ours(list(values)) == found


def test_the_interval_of_a_mean_is_that_of_its_standard_error() -> None:
    values = np.random.default_rng(3).normal(10.0, 2.0, 5000)
    found, half = bootstrap_mean(list(values)), 1.96 * 2.0 / math.sqrt(5000)
    assert (found.low, found.high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.2 * half)


def test_one_value_has_no_interval_and_no_value_nothing() -> None:
    one, none = bootstrap_median([4.0]), bootstrap_median([])
    assert (one.value, one.n, none.n) == (4.0, 1, 0)
    assert all(map(math.isnan, (one.low, one.high, none.value)))
