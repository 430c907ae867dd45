"""When a robot is kidnapped, by chance; and the judge of a kidnap: when the robot was right again, what it believed before, and
when its map was one again."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluation.evaluation import Kidnapping
from app.headless.run import kidnap_times
from ratslam_core import Pose2

MINUTES, SEEDS = st.floats(1.0, 600.0), st.integers(0, 2**32 - 1)


@given(st.integers(1, 60), MINUTES, SEEDS)
def test_a_third_comes_in_the_first_five_minutes(count: int, minutes: float, seed: int) -> None:
    times = kidnap_times(count, minutes, seed)
    assert len(times) == count
    assert times == sorted(times) == kidnap_times(count, minutes, seed)
    assert times[0] >= 20.0
    assert times[-1] < minutes * 60
    assert sum(at <= 300.0 for at in times) >= count / 3


@given(st.integers(1, 9), SEEDS)
def test_where_there_is_time_each_has_four_minutes(count: int, seed: int) -> None:
    times = [*kidnap_times(count, 90.0, seed), 5400.0]
    early, late = [at for at in times if at <= 300.0], [at for at in times if at > 300.0]
    assert all(b - a >= 239.8 for a, b in pairwise(late))
    assert late[0] >= 539.8
    assert all(b - a >= 55.8 for a, b in pairwise(early))


def test_other_seeds_have_other_times_none_are_none_and_no_time_is_refused() -> None:
    assert kidnap_times(3, 30.0, 1) != kidnap_times(3, 30.0, 2)
    assert kidnap_times(0, 0.0, 1) == []
    with pytest.raises(ValueError, match=r"0.5 minutes are too short for a kidnap"):
        kidnap_times(1, 0.5, 1)


def judged(beliefs: str, carried: str = "") -> Kidnapping:
    """A kidnap at 10 s. beliefs: r right, w wrong, - none; a tick (0.1 s, 0.03 m) each."""
    kidnap = Kidnapping(10.0, Pose2(0.0, 0.0, 0.0), known=5, ticks=100)
    for k, belief in enumerate(beliefs, start=1):
        kidnap.drive(0.03)
        kidnap.carried(10.0 + 0.1 * k, carried[k - 1 : k] == "c")
        kidnap.believes(10.0 + 0.1 * k, {"r": True, "w": False, "-": None}[belief])
    return kidnap


def test_right_is_half_a_second_at_a_stretch_and_wrong_counts_before_it() -> None:
    for beliefs, after_s, wrong_s in [
        ("-" * 9 + "r" * 6, 1.0, 0.0),
        ("-" * 9 + "r" * 5, None, 0.0),
        ("rrrrr-rrrrrr", 0.7, 0.0),  # half a second at a stretch
        ("wwwwwwww--www" + "r" * 6, 1.4, 0.7),  # the longest stretch
        ("r" * 6 + "w" * 50, 0.1, 0.0),  # first
    ]:
        kidnap = judged(beliefs)
        assert kidnap.after_s == (None if after_s is None else pytest.approx(after_s)), beliefs
        assert kidnap.after_m == (None if after_s is None else pytest.approx(0.3 * after_s)), beliefs
        assert kidnap.wrong.most_s == pytest.approx(wrong_s), beliefs


def test_only_a_map_that_was_left_is_joined() -> None:
    for carried, joined_s in [("cccc....", 0.5), ("..cc....", 0.5), ("cccccccc", None), ("", None)]:
        joined = None if joined_s is None else pytest.approx(joined_s)
        assert judged("--------", carried).joined_s == joined, carried


def test_what_2004_calls_relocalised_is_judged_apart() -> None:
    kidnap = judged("wwwwwwww")
    for k in range(6):
        kidnap.agrees(11.0 + 0.1 * k, True)
    assert (kidnap.consistent_s, kidnap.after_s, kidnap.judged) == (pytest.approx(1.0), None, False)
