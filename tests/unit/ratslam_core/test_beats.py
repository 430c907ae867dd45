"""Beats: whatever the rate of the sensors, ten in a second, and no movement is lost between them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core import Odometry
from ratslam_core.beats import MOST, Beats, shared, weight


@pytest.mark.parametrize("rate", [1, 3, 7, 8, 10, 12, 15, 16, 24, 30, 48, 60, 100])
def test_there_are_ten_in_a_second_at_every_rate(rate: int) -> None:
    beats, counted = Beats(), []
    for _ in range(100 * rate + 1):
        due = beats.due(1 / rate)
        counted.append(beats.take(Odometry(0.3, 0.1, 1 / rate)).beats)
        assert counted[-1] == due
    assert counted[0] == 1  # however long the first tick is
    assert sum(counted) == 1001
    assert set(counted[1:]) <= {10 // rate, -(-10 // rate)}


def test_at_10_hz_each_tick_is_a_beat_and_nothing_is_computed() -> None:
    beats = Beats()
    for k in range(1000):
        odometry = Odometry(0.1 * k, 0.3, 0.1)
        tick = beats.take(odometry)
        assert tick.beats == 1
        assert tick.moved is tick.latest is odometry
        assert tick.turned_rad == beats.turned_by(odometry) == odometry.yaw_rate * odometry.dt


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-2, 2), st.floats(0.01, 3.0)), min_size=1, max_size=60))
def test_no_movement_and_no_time_is_lost(ticks: list[tuple[float, float, float]]) -> None:
    beats, told, given_back = Beats(), [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    for speed, yaw_rate, dt in ticks:
        odometry = Odometry(speed, yaw_rate, dt)
        told = [told[0] + speed * dt, told[1] + yaw_rate * dt, told[2] + dt]
        tick = beats.take(odometry)
        counted, each = tick.beats, tick.moved
        for _ in range(counted):
            given_back = [
                given_back[0] + each.speed * each.dt, given_back[1] + each.yaw_rate * each.dt, given_back[2] + each.dt
            ]  # fmt: skip
        if counted:
            assert given_back == pytest.approx(told, abs=1e-9)
        else:
            assert told[1] - given_back[1] == pytest.approx(beats.turned_by(Odometry(0.0, 0.0, 1.0)), abs=1e-9)


def test_a_tick_a_little_early_is_on_the_beat_and_after_a_long_pause_the_count_begins_anew() -> None:
    beats = Beats()
    for k in range(1000):
        assert beats.take(Odometry(0.0, 0.0, 0.095 if k % 2 else 0.105)).beats == 1
    tick = beats.take(Odometry(0.3, 0.0, 3600.0))
    assert tick.beats == MOST
    assert tick.moved.dt == pytest.approx(3600.0 / MOST)
    assert beats.take(Odometry(0.3, 0.0, 0.1)).beats == 1


def test_a_bias_is_taken_off_while_the_wheels_turn() -> None:
    assert Beats().take(Odometry(0.3, 0.2, 0.1)).without(0.05).moved == Odometry(0.3, 0.2 - 0.05, 0.1)
    assert Beats().take(Odometry(0.0, 0.2, 0.1)).without(0.05).latest.yaw_rate == pytest.approx(0.15)
    still = Beats().take(Odometry(0.0, 0.0, 0.1))
    assert still.without(0.05) == still


def test_the_weight_is_that_of_so_many_steps() -> None:
    mean = 0.0
    for beats in range(1, 8):
        mean += 0.05 * (1.0 - mean)
        assert weight(0.05, beats) == pytest.approx(mean, abs=1e-15)


def test_a_movement_is_cut_into_equal_pieces() -> None:
    whole = Odometry(0.4, -0.2, 0.6)
    piece = shared(whole, 3)
    assert (piece.speed, piece.yaw_rate, 3 * piece.dt) == (0.4, -0.2, pytest.approx(0.6))
    assert shared(whole, 1) is whole
