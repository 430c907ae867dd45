"""Bars delay what crosses them, for a while."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.pilot import PilotParams, bars
from app.pilot.bars import BAR_DELAY_S, BAR_M, Bars, crosses
from ratslam_core import Pose2
from tests.unit.ratslam_core import literal

from .pilots import DT

USUAL = PilotParams(bar_fade_s=20.0)

LINKS = np.array([(0, 1), (2, 3), (0, 3)])
PLACES = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (1.0, 2.0, 0.0)])  # the first link crosses a bar


def after(seconds: float, made: Bars) -> Bars:
    for _ in range(round(seconds / DT)):
        made.fade(DT)
    return made


def test_a_bar_delays_what_crosses_it_and_fades() -> None:
    made = Bars()
    assert made.delays(LINKS, PLACES) is None
    made.add(Pose2(0.0, 0.0, -0.5), 0.5, USUAL)
    for seconds in (0.0, 10.0, 8.0):
        after(seconds, made)
    left = 1 - 18 / USUAL.bar_fade_s
    assert made.delays(LINKS, PLACES) == pytest.approx(np.array([1.0, 0.0, 0.0]) * BAR_DELAY_S * left)
    assert made.failures == pytest.approx(left)
    assert made.between(0.0, 0.0, PLACES[1:3, :2]).tolist() == [True, False]
    assert len(after(2.1, made)) == 0
    assert made.delays(LINKS, PLACES) is None


def test_failing_again_at_a_bar_makes_it_last_longer() -> None:
    made = Bars()
    for times in range(1, 9):
        made.add(Pose2(0.0, 0.05 * times, 0.0), 0.0, USUAL)
        assert len(made) == 1
        delays = made.delays(LINKS, PLACES)
        assert delays is not None
        assert delays[0] == pytest.approx(times * BAR_DELAY_S)
        after(0.9 * USUAL.bar_fade_s * 2 ** (times - 1), made)
        assert len(made) == 1  # the second lasts twice as long, the third four times
    made.add(Pose2(0.0, 1.5, 0.0), 0.0, USUAL)
    assert len(made) == 2
    made.forget()
    assert len(made) == 0
    made.add(Pose2(0.0, 0.0, 0.0), 0.0, PilotParams(bar_fade_s=0.0))  # one of the paper stays
    assert len(after(1000.0, made)) == 1


@pytest.mark.parametrize("interpreted", [False, True])
@settings(max_examples=50)
@given(st.lists(st.tuples(*[st.floats(-1, 1)] * 2), min_size=4, max_size=8), st.floats(-math.pi, math.pi))
def test_what_is_delayed_is_what_crosses(interpreted: bool, places: list[tuple[float, float]], heading: float) -> None:
    with pytest.MonkeyPatch.context() as patch:
        if interpreted:
            literal.interpret(bars, patch)
        made = Bars()
        made.add(Pose2(0.0, 0.0, heading), 0.0, USUAL)
        ends = np.array([(i, j) for i in range(len(places)) for j in range(i)])
        xy = np.array(places)
        bar = bars.bar_ahead(Pose2(0.0, 0.0, heading), 0.0, BAR_M)
        delays = made.delays(ends, xy)
        assert delays is not None
        assert ((delays > 0) == crosses(bar, xy[ends[:, 0]], xy[ends[:, 1]])).all()
