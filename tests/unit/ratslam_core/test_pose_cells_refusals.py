"""What the pose cells refuse, and that a refusal changes nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import PoseCellParams, PoseCells

from .packets import DT, rest, settled


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused(bad: float) -> None:
    pose_cells = PoseCells()
    with pytest.raises(ValueError, match="speed must be a finite number, got"):
        pose_cells.step(speed=bad, yaw_rate=0.0, dt=DT)
    with pytest.raises(ValueError, match="yaw_rate must be a finite number, got"):
        pose_cells.step(speed=0.0, yaw_rate=bad, dt=DT)
    with pytest.raises(ValueError, match="dt must be a positive number of seconds, got"):
        pose_cells.step(speed=0.0, yaw_rate=0.0, dt=bad)
    assert pose_cells.activity[0, 32, 32] == 1.0  # nothing moved


@pytest.mark.parametrize("dt", [0.0, -0.1])
def test_time_must_pass(dt: float) -> None:
    with pytest.raises(ValueError, match=f"dt must be a positive number of seconds, got {dt}"):
        PoseCells().step(speed=0.0, yaw_rate=0.0, dt=dt)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ((64, 0, 0), "x must be a cell from 0 to 63, got 64"),
        ((0, -1, 0), "y must be a cell from 0 to 63, got -1"),
        ((0, 0, 36), "theta must be a cell from 0 to 35, got 36"),
        ((0.5, 0, 0), "x must be a cell from 0 to 63, got 0.5"),
        ((0, True, 0), "y must be a cell from 0 to 63, got True"),
        ((0, 0, math.nan), "theta must be a cell from 0 to 35, got nan"),
        (("3", 0, 0), "x must be a cell from 0 to 63, got '3'"),
    ],
)
def test_a_place_outside_is_refused(place: tuple[int, int, int], message: str) -> None:
    pose_cells = PoseCells()
    with pytest.raises(ValueError, match=message):
        pose_cells.place(*place)
    assert pose_cells.activity[0, 32, 32] == 1.0


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_movement_that_is_not_finite_is_refused(bad: float) -> None:
    pose_cells = PoseCells()
    with pytest.raises(ValueError, match="distance_m must be a finite number, got"):
        pose_cells.integrate(bad, 0.0)
    with pytest.raises(ValueError, match="turn_rad must be a finite number, got"):
        pose_cells.integrate(0.0, bad)
    assert pose_cells.activity[0, 32, 32] == 1.0


CELLS, VALUES = np.array([5, 9], np.int32), np.array([0.1, 0.2], np.float32)


@pytest.mark.parametrize(
    ("cells", "values", "message"),
    [
        ([5, 9], VALUES, r"cells must be an int32 array of shape \(k,\), got \[5, 9\]"),
        (CELLS.astype(np.int64), VALUES, r"cells must be an int32 array of shape \(k,\), got int64 \(2,\)"),
        (CELLS.reshape(1, 2), VALUES, r"cells must be an int32 array of shape \(k,\), got int32 \(1, 2\)"),
        (CELLS, VALUES.astype(np.float64), r"values must be a float32 array of shape \(2,\), got float64 \(2,\)"),
        (CELLS, VALUES[:1], r"values must be a float32 array of shape \(2,\), got float32 \(1,\)"),
        (CELLS, 0.1, r"values must be a float32 array of shape \(2,\), got 0.1"),
        (
            np.array([5, -1], np.int32),
            VALUES,
            r"from 0 to 147455 and values finite and >= 0, got cell -1 with 0.2 in row 1",
        ),
        (np.array([147456, 9], np.int32), VALUES, "got cell 147456 with 0.1 in row 0"),
        (CELLS, np.array([0.1, -0.5], np.float32), "got cell 9 with -0.5 in row 1"),
        (CELLS, np.array([0.1, math.nan], np.float32), "got cell 9 with nan in row 1"),
        (CELLS, np.array([math.inf, 0.1], np.float32), "got cell 5 with inf in row 0"),
    ],
)
def test_an_injection_that_is_none_is_refused(cells: object, values: object, message: str) -> None:
    pose_cells = settled()
    before = pose_cells.activity
    with pytest.raises(ValueError, match=message):
        pose_cells.inject(cells, values)  # type: ignore[arg-type]
    assert np.array_equal(pose_cells.activity, before)


def test_a_cell_injected_twice_gets_both_and_nothing_is_no_fault() -> None:
    pose_cells = PoseCells()
    pose_cells.inject(np.array([7, 7], np.int32), np.array([0.25, 0.5], np.float32))
    pose_cells.inject(np.zeros(0, np.int32), np.zeros(0, np.float32))
    assert pose_cells.activity[0, 0, 7] == 0.75
    pose_cells.inject(np.arange(90_000, 90_100, dtype=np.int32), np.zeros(100, np.float32))
    assert pose_cells.attract() == pose_cells.winner
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


def test_inhibition_that_takes_all_activity_is_refused_and_changes_nothing() -> None:
    pose_cells = settled()
    before, packet, carry = pose_cells.activity, pose_cells.winner, pose_cells.carry
    too_much = PoseCellParams(excite_sigma=3.0, inhibit=0.02)
    pose_cells.set_params(too_much)
    with pytest.raises(ValueError, match=r"inhibit = 0\.02 is above the activity of every cell"):
        pose_cells.attract()
    assert np.array_equal(pose_cells.activity, before)
    assert pose_cells.winner == packet
    assert pose_cells.carry == pytest.approx(carry, abs=1e-12)
    pose_cells.set_params(PoseCellParams())
    rest(pose_cells, 1)
    assert pose_cells.winner.id == packet.id
