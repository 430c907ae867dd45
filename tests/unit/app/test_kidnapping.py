"""The judge of a kidnap: when the robot was right again, what it believed before, and when its map was one again."""

from __future__ import annotations

import pytest

from app.evaluation.kidnapping import Kidnapping
from ratslam_core import Pose2


def judged(beliefs: str, carried: str = "") -> Kidnapping:
    """A kidnap at 10 s. beliefs: r right, w wrong, - none; a tick (0.1 s, 0.03 m) each."""
    kidnap = Kidnapping(10.0, Pose2(0.0, 0.0, 0.0), known=5, ticks=100)
    for k, belief in enumerate(beliefs, start=1):
        kidnap.drive(0.03)
        kidnap.carried(10.0 + 0.1 * k, carried[k - 1 : k] == "c")
        kidnap.believes(10.0 + 0.1 * k, {"r": True, "w": False, "-": None}[belief])
    return kidnap


@pytest.mark.parametrize(
    ("beliefs", "after_s", "wrong_s"),
    [
        ("-" * 9 + "r" * 6, 1.0, 0.0),
        ("-" * 9 + "r" * 5, None, 0.0),
        ("rrrrr-rrrrrr", 0.7, 0.0),  # half a second at a stretch
        ("wwwwwwww--www" + "r" * 6, 1.4, 0.7),  # the longest stretch
        ("r" * 6 + "w" * 50, 0.1, 0.0),  # first
    ],
)
def test_right_is_half_a_second_at_a_stretch_and_wrong_counts_before_it(
    beliefs: str, after_s: float | None, wrong_s: float
) -> None:
    kidnap = judged(beliefs)
    assert kidnap.after_s == (None if after_s is None else pytest.approx(after_s))
    assert kidnap.after_m == (None if after_s is None else pytest.approx(0.3 * after_s))
    assert kidnap.wrong.most_s == pytest.approx(wrong_s)


@pytest.mark.parametrize(
    ("carried", "joined_s"), [("cccc....", 0.5), ("..cc....", 0.5), ("cccccccc", None), ("", None)]
)
def test_only_a_map_that_was_left_is_joined(carried: str, joined_s: float | None) -> None:
    kidnap = judged("--------", carried)
    assert kidnap.joined_s == (None if joined_s is None else pytest.approx(joined_s))


def test_what_2004_calls_relocalised_is_judged_apart() -> None:
    kidnap = judged("wwwwwwww")
    for k in range(6):
        kidnap.agrees(11.0 + 0.1 * k, True)
    assert kidnap.consistent_s == pytest.approx(1.0)
    assert kidnap.after_s is None
    assert not kidnap.judged
