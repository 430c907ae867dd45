"""Recordings that the tests write themselves: the same drive in each format gives the same moments."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from app.recordings.opening import open_recording
from tests.recordings import FORMATS, HZ, N, drive

POSES_ONLY = {"carmen", "carmen packed", "carmen robot", "carmen raw", "scans", "mcap poses"}
VIDEOS = {"avi", "mp4"}


@pytest.mark.parametrize("name", FORMATS)
def test_the_same_drive_in_each_format_gives_the_same_moments(name: str, tmp_path: Path) -> None:
    file, write, has = FORMATS[name]
    recording = open_recording(write(tmp_path / file))
    about, moments, rows = recording.about, list(recording.moments()), drive()
    assert about.has == has
    assert about.problems == ()
    assert about.moments == len(moments) == N
    assert about.seconds == pytest.approx((N - 1) / HZ)
    assert [moment.frame for moment in moments] == list(range(N))
    assert [moment.dt for moment in moments] == [1 / HZ] * N
    for k, (moment, row) in enumerate(zip(moments, rows, strict=True)):
        assert moment.time_s == k / HZ
        if "camera" in has and name not in VIDEOS:
            assert np.array_equal(moment.image, row.image)
        if name in VIDEOS:
            red, _, blue = moment.image.reshape(-1, 3).mean(axis=0)
            assert red == pytest.approx(30 * k, abs=8)
            assert blue == pytest.approx(250 - 30 * k, abs=8)
        if "ranges" in has:
            assert np.array_equal(moment.ranges_m, row.ranges.astype(float))
        if "truth" in has:
            assert moment.truth == pytest.approx(row.pose, abs=1e-9)
        if "speed" in has and name in POSES_ONLY:
            motion = (moment.speed, moment.yaw_rate) if k else (row.speed, row.yaw_rate)
            assert motion == pytest.approx((row.speed, row.yaw_rate), abs=1e-6)
        elif "speed" in has:
            assert (moment.speed, moment.yaw_rate) == (row.speed, pytest.approx(row.yaw_rate, rel=1e-12))
        if "throttle" in has:
            assert moment.throttle == row.speed / 2


@pytest.mark.parametrize("name", FORMATS)
def test_a_recording_plays_again_in_the_same_way(name: str, tmp_path: Path) -> None:
    file, write, _ = FORMATS[name]
    recording = open_recording(write(tmp_path / file))
    for one, other in zip(recording.moments(), recording.moments(), strict=True):
        assert (one.time_s, one.dt, one.speed, one.yaw_rate) == (other.time_s, other.dt, other.speed, other.yaw_rate)
        assert np.array_equal(one.image, other.image) if one.image is not None else other.image is None


def test_beams_are_from_the_right_to_the_left(tmp_path: Path) -> None:
    for name in ("carmen", "carmen raw", "mcap"):
        file, write, _ = FORMATS[name]
        angles = open_recording(write(tmp_path / file)).about.beam_angles_rad
        assert angles == tuple(sorted(angles))
        assert angles[0] < 0 < angles[-1] < math.pi
