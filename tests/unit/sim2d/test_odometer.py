from __future__ import annotations

import math

import numpy as np
import pytest

from sim2d import SimParams
from sim2d.sensors import report, true_motion, wrap_angle

EXACT = SimParams(odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.0)


def test_scale_and_bias() -> None:
    rng = np.random.default_rng(0)
    assert report(0.31, -0.7, EXACT, rng) == (0.31, -0.7)
    assert report(0.4, 0.5, SimParams(odometry_noise=0.0, gyro_bias=0.0), rng) == pytest.approx((0.408, 0.5))
    biased = SimParams(odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.01)
    assert report(0.4, 0.5, biased, rng) == pytest.approx((0.4, 0.51))
    assert report(0.4, 0.0, biased, rng) == pytest.approx((0.4, 0.01))


def test_standing_wheels_give_no_counts() -> None:
    rng = np.random.default_rng(0)
    assert report(0.0, 0.0, SimParams(), rng) == report(5e-4, -1e-3, SimParams(), rng) == (0.0, 0.0)
    assert report(0.0, 0.5, SimParams(), rng)[1] != 0.0


def test_random_error_has_the_declared_size() -> None:
    rng, params = np.random.default_rng(1), SimParams(odometry_scale_error=0.0, gyro_bias=0.0)
    got = np.array([report(0.5, 1.0, params, rng) for _ in range(4000)])
    assert got.std(axis=0) == pytest.approx([0.025, 0.05], rel=0.05)
    assert got.mean(axis=0) == pytest.approx([0.5, 1.0], rel=0.005)


def test_noise_adds_up_alike_at_every_rate(subtests: pytest.Subtests) -> None:
    """Over four seconds the way is wrong by as much, whether it is reported in few pieces or in many."""
    for rate in (1, 2, 5, 10, 20, 30, 60):
        with subtests.test(f"{rate} Hz"):
            rng = np.random.default_rng(2)
            params = SimParams(sensor_rate_hz=rate, odometry_scale_error=0.0, gyro_bias=0.0)
            ways = [sum(report(0.5, 1.0, params, rng)[0] / rate for _ in range(4 * rate)) for _ in range(2000)]
            one = 0.05 * 0.5 * 0.1  # standard deviation of a tenth of a second, m
            assert np.std(ways) == pytest.approx(one * math.sqrt(40), rel=0.06)
            assert np.mean(ways) == pytest.approx(2.0, rel=0.002)


def test_true_motion_follows_the_arc() -> None:
    radius, turn = 0.8, 0.6
    after = (radius * math.sin(turn), radius * (1 - math.cos(turn)), turn)
    assert true_motion((0.0, 0.0, 0.0), after, 0.1) == pytest.approx((radius * turn / 0.1, turn / 0.1))
    assert true_motion((0, 0, 0), (-0.02, 0.0, 0.0), 0.1) == pytest.approx((-0.2, 0.0))
    assert true_motion((0, 0, 3.1), (0, 0, 3.2 - 2 * math.pi), 0.1)[1] == pytest.approx(1.0)
    angles = (0.5, math.pi, -math.pi, 3 * math.pi, -7.0)
    assert [wrap_angle(angle) for angle in angles] == pytest.approx([0.5, math.pi, math.pi, math.pi, 2 * math.pi - 7])
