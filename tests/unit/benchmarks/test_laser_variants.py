"""Variants of a laser log: what they change, and what they leave as it is."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.laser_drives import Drive, driven
from benchmarks.laser_variants import OF_A_LOG, OF_A_LOG_HELD_OUT, Log, Logged, backwards, log_of, mirrored, with_wheels
from benchmarks.recordings import INTEL_BEGAN_S, of_known, of_truth
from sim2d import load_world


@pytest.fixture(scope="module")
def log() -> Log:
    return driven(load_world("office"), Drive("office", 0.5, 1, beams=61, every_s=0.2))


def test_a_log_is_read_as_it_was_written(log: Log) -> None:
    again = log_of(Logged(log, "log"))
    x, y, heading = log.wheels[0].tolist()
    c, s = math.cos(heading), math.sin(heading)
    from_first = (log.wheels - (x, y, heading)) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    np.testing.assert_allclose(again.wheels, from_first, atol=0.03)  # a way is taken as straight
    assert np.array_equal(again.ranges, log.ranges)


def test_twice_turned_is_as_it_was_and_wheels_without_more_errors_are_those_of_before(log: Log) -> None:
    for turned in (mirrored, backwards):
        twice = turned(turned(log))
        for name in ("times", "was", "wheels", "ranges", "angles"):
            np.testing.assert_allclose(getattr(twice, name), getattr(log, name), atol=1e-6, err_msg=name)
    np.testing.assert_allclose(with_wheels(log).wheels, log.wheels, atol=0.03)
    heading = with_wheels(log, turns=2.0).wheels[:, 2]
    np.testing.assert_allclose(heading - heading[0], 2 * (log.wheels[:, 2] - log.wheels[0, 2]), atol=1e-6)


def test_the_laser_is_told_from_the_right(log: Log) -> None:
    """Walls of the office where the scans put them: seen from two places, they lie on one another."""
    truth = log.truth
    assert truth is not None
    assert (log.angles[0], log.angles[-1]) == pytest.approx((-math.pi / 2, math.pi / 2))

    def walls(k: int) -> np.ndarray:
        (x, y, heading), seen = truth[k], np.isfinite(log.ranges[k])
        a, r = log.angles[seen] + heading, log.ranges[k][seen]
        return np.stack([x + r * np.cos(a), y + r * np.sin(a)], axis=1)

    a, b = walls(25), walls(30)
    nearest = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)).min(axis=1)
    assert np.median(nearest) < 0.1


def test_who_knows_the_way_makes_no_error(log: Log, tmp_path: Path, subtests: pytest.Subtests) -> None:
    """Every variant is judged against the log that it was made from: the true path has no error, the wheels have one."""
    at, rows = log.truth, []
    assert at is not None
    for i in range(0, len(at) - 3, 2):
        c, s = math.cos(at[i, 2]), math.sin(at[i, 2])
        dx, dy, turn = at[i + 3] - at[i]
        rows.append([log.was[i], log.was[i + 3], c * dx + s * dy, -s * dx + c * dy, 0, 0, 0, turn])
    relations = np.array(rows) + np.array([INTEL_BEGAN_S] * 2 + [0.0] * 6)
    np.savetxt(tmp_path / "relations", relations, fmt="%.6f")
    for name, made in {**OF_A_LOG, **OF_A_LOG_HELD_OUT}.items():
        with subtests.test(name):
            variant = made(log)
            assert variant.truth is not None
            true = variant.truth * ((1, -1, -1) if variant.mirrored else 1)
            coarse = "every" in name and "scan" in name
            assert of_known(variant, true, tmp_path / "relations") < (0.2 if coarse else 1e-3)
            assert of_truth(variant.truth, variant.truth) < 1e-9
            assert of_truth(variant.wheels, variant.truth) > 0.0
