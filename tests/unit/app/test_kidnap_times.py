from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.headless.kidnap_times import kidnap_times

MINUTES, SEEDS = st.floats(1.0, 600.0), st.integers(0, 2**32 - 1)


@given(st.integers(1, 60), MINUTES, SEEDS)
def test_a_third_comes_in_the_first_five_minutes(count: int, minutes: float, seed: int) -> None:
    times = kidnap_times(count, minutes, seed)
    assert len(times) == count
    assert times == sorted(times)
    assert times == kidnap_times(count, minutes, seed)
    assert times[0] >= 20.0
    assert times[-1] < minutes * 60
    assert sum(at <= 300.0 for at in times) >= count / 3


@given(st.integers(1, 9), SEEDS)
def test_where_there_is_time_each_has_four_minutes(count: int, seed: int) -> None:
    times = [*kidnap_times(count, 90.0, seed), 5400.0]
    late = [at for at in times if at > 300.0]
    assert all(b - a >= 239.8 for a, b in pairwise(late))
    assert late[0] >= 539.8
    early = [at for at in times if at <= 300.0]
    assert all(b - a >= 55.8 for a, b in pairwise(early))


def test_other_seeds_have_other_times() -> None:
    assert kidnap_times(3, 30.0, 1) != kidnap_times(3, 30.0, 2)


def test_none_are_none_and_no_time_is_refused() -> None:
    assert kidnap_times(0, 0.0, 1) == []
    with pytest.raises(ValueError, match=r"0.5 minutes are too short for a kidnap"):
        kidnap_times(1, 0.5, 1)
