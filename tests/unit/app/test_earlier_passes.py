"""An estimate that need not be Cartesian is held against those of earlier passes through the same place."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluation.evaluation import off_earlier_passes, off_same_estimate
from ratslam_core import Pose2

STRAIGHT = np.column_stack([np.arange(0.0, 6.0, 0.03), np.zeros(200), np.zeros(200)])  # 6 m along x


FRAMES = st.builds(Pose2, st.floats(-20, 20), st.floats(-20, 20), st.floats(-3, 3))


def seen_from(frame: Pose2) -> np.ndarray:
    """The way along x, as cells have it whose plane lies so."""
    return np.array([[p.x, p.y, p.heading_rad] for p in (frame.compose(Pose2(*row)) for row in STRAIGHT.tolist())])


@given(FRAMES, st.floats(-0.3, 0.3), st.floats(-0.2, 0.2))
def test_wherever_the_cells_have_it_the_same_state_again_is_right(frame: Pose2, aside: float, facing: float) -> None:
    """The cells' plane may lie anywhere and be turned: what counts is that the same place is the same state."""
    estimated, here = seen_from(frame), Pose2(1.0, aside, facing)
    metres, radians = off_earlier_passes(STRAIGHT, estimated, here, frame.compose(here))
    assert metres == pytest.approx(0.0, abs=1e-9)
    assert radians == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("passes_up", "off_m"), [([0], 1.0), ([0, 3], 1.0), ([0, 3, 3], 2.0), ([0, 0, 3], 1.0)])
def test_another_state_is_as_far_off_as_it_is_from_half_of_the_passes(passes_up: list[int], off_m: float) -> None:
    """passes_up: how many metres farther up the cells had the robot on each pass. Now they have it one metre up."""
    away = np.array([[9.0, 0.0, 0.0]])
    true = np.concatenate([np.concatenate([STRAIGHT[:100], away.repeat(5, axis=0)]) for _ in passes_up])
    estimated = true.copy()
    estimated[:, 1] += np.repeat(passes_up, 105)
    metres, radians = off_earlier_passes(true, estimated, Pose2(1.05, 0.0, 0.0), Pose2(1.05, 1.0, 0.5))
    assert metres == pytest.approx(off_m, abs=1e-9)
    assert radians == pytest.approx(0.5)


def test_new_ground_and_this_pass_say_nothing() -> None:
    beside, the_other_way, still_going_on = Pose2(1.0, 0.6, 0.0), Pose2(1.0, 0.0, math.pi), Pose2(5.5, 0.0, 0.0)
    for here in (beside, the_other_way, still_going_on):
        assert math.isnan(off_earlier_passes(STRAIGHT, STRAIGHT, here, here)[0])
    assert math.isnan(off_earlier_passes(STRAIGHT[:0], STRAIGHT[:0], beside, beside)[0])


@given(FRAMES, st.floats(0.2, 5.8), st.floats(-0.4, 0.4), st.floats(-0.5, 0.5))
def test_an_estimate_stands_for_where_the_robot_was_when_it_had_it(
    frame: Pose2, ahead: float, aside: float, facing: float
) -> None:
    """However the cells lie: the robot is where it is, and its estimate is one that it had elsewhere on the way."""
    here, estimate = Pose2(1.0, 2.0, 0.3), frame.compose(Pose2(ahead, aside, facing))
    metres, radians = off_same_estimate(STRAIGHT, seen_from(frame), here, estimate)
    assert metres == pytest.approx(math.hypot(ahead - 1.0, aside - 2.0), abs=1e-9)
    assert radians == pytest.approx(abs(facing - 0.3), abs=1e-9)


def test_an_estimate_that_it_never_had_stands_for_no_place() -> None:
    for estimate in (Pose2(3.0, 0.6, 0.0), Pose2(3.0, 0.0, 0.7), Pose2(-1.0, 0.0, 0.0)):
        assert math.isnan(off_same_estimate(STRAIGHT, STRAIGHT, Pose2(3.0, 0.0, 0.0), estimate)[0])
