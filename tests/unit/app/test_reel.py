"""Recordings that the tests write themselves: the same drive in each format gives the same moments, in any order."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.recordings.formats import image_folder
from app.recordings.motion import OdometryErrors, WithMadeOdometry
from app.recordings.opening import open_recording
from app.recordings.recording import Moment, Wanted, every
from app.sources.recorded import MOST_CURSORS, Reel
from tests.recordings import FORMATS, HZ, N, drive
from tests.unit.app.made_recordings import MadeRecording, recorded

POSES_ONLY = {"carmen", "carmen packed", "carmen robot", "carmen raw", "scans", "mcap poses"}
VIDEOS = {"avi", "mp4"}


@pytest.fixture(scope="module")
def made() -> MadeRecording:
    return recorded(60)


def pictures(folder: Path, count: int) -> Path:
    rng = np.random.default_rng(2)
    for k in range(count):
        Image.fromarray(rng.integers(0, 255, (12, 16, 3), dtype=np.uint8)).save(folder / f"{k}.png")
    return folder


def same(one: Moment, other: Moment) -> bool:
    told = [(m.frame, m.time_s, m.dt, m.speed, m.yaw_rate, m.throttle, m.truth, m.behaviour) for m in (one, other)]
    arrays = ((one.image, other.image), (one.ranges_m, other.ranges_m))
    return told[0] == told[1] and all(
        np.array_equal(a, b) if a is not None and b is not None else a is b for a, b in arrays
    )


@pytest.mark.parametrize("name", FORMATS)
def test_the_same_drive_in_each_format_gives_the_same_moments_in_any_order(name: str, tmp_path: Path) -> None:
    file, write, has = FORMATS[name]
    recording = open_recording(write(tmp_path / file))
    about, moments = recording.about, list(recording.moments())
    assert (about.has, about.problems, about.moments) == (has, (), N)
    assert about.seconds == pytest.approx((N - 1) / HZ)
    angles = about.beam_angles_rad
    assert angles == tuple(sorted(angles)), "beams are from the right to the left"
    assert not angles or angles[0] < 0 < angles[-1] < math.pi
    for k, (moment, row) in enumerate(zip(moments, drive(), strict=True)):
        assert (moment.frame, moment.time_s, moment.dt) == (k, k / HZ, 1 / HZ)
        if name in VIDEOS:
            red, _, blue = moment.image.reshape(-1, 3).mean(axis=0)  # type: ignore[union-attr]
            assert (red, blue) == pytest.approx((30 * k, 250 - 30 * k), abs=8)
        elif "camera" in has:
            assert np.array_equal(moment.image, row.image)  # type: ignore[arg-type]
        if "ranges" in has:
            assert np.array_equal(moment.ranges_m, row.ranges.astype(float))  # type: ignore[arg-type]
        if "truth" in has:
            assert moment.truth == pytest.approx(row.pose, abs=1e-9)
        if "speed" in has and name in POSES_ONLY:
            motion = (moment.speed, moment.yaw_rate) if k else (row.speed, row.yaw_rate)
            assert motion == pytest.approx((row.speed, row.yaw_rate), abs=1e-6)
        elif "speed" in has:
            assert (moment.speed, moment.yaw_rate) == (row.speed, pytest.approx(row.yaw_rate, rel=1e-12))
        if "throttle" in has:
            assert moment.throttle == row.speed / 2
    reel, rng = Reel(recording, budget_bytes=0), random.Random(1)
    for number in [rng.randrange(N) for _ in range(12)]:
        assert same(reel.at(number), moments[number]), number
    assert not reel.has(N)
    with pytest.raises(ValueError, match=f"moment {N} is not there"):
        reel.at(N)


def test_what_cannot_be_read_has_no_number_and_nothing_else_is_unpacked(tmp_path: Path, monkeypatch) -> None:
    (pictures(tmp_path, 30) / "7.png").write_bytes(b"no picture")
    straight, read = list(open_recording(tmp_path).moments()), image_folder.read_picture
    assert [moment.frame for moment in straight][6:8] == [6, 8]
    unpacked, reel = list[str](), Reel(open_recording(tmp_path))
    assert same(reel.at(28), straight[28]), "the first time nobody knows which ones can be read"
    monkeypatch.setattr(image_folder, "read_picture", lambda path: unpacked.append(path.name) or read(path))
    assert same(reel.at(20), straight[20])
    assert unpacked == ["7.png", "21.png"], "of those that were passed only the one that could not be read"


def test_what_is_gone_meanwhile_is_a_sentence(tmp_path: Path) -> None:
    reel = Reel(open_recording(pictures(tmp_path, 8)), budget_bytes=0)
    assert reel.at(7).frame == 7
    (tmp_path / "3.png").unlink()
    with pytest.raises(ValueError, match=r"3\.png: it could be read before, and cannot be any more"):
        reel.at(3)
    for picture in tmp_path.iterdir():
        picture.unlink()
    tmp_path.rmdir()
    with pytest.raises(ValueError, match="could be read before"):
        reel.at(1)


def test_odometry_with_errors_is_the_same_again(made: MadeRecording) -> None:
    recording = WithMadeOdometry(made, OdometryErrors(0.1, 0.02, 0.005), seed=4)
    straight, reel = list(recording.moments()), Reel(recording, budget_bytes=0)
    for number in (50, 3, 51, 20, 59):
        assert same(reel.at(number), straight[number]), number


class Counted(MadeRecording):
    """How often it was begun, and how often it is being read now."""

    begun = read = 0

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        self.begun, self.read = self.begun + 1, self.read + 1
        try:
            yield from super().moments(wanted)
        finally:
            self.read -= 1


def test_little_is_held_and_few_files_are_open(made: MadeRecording) -> None:
    counted = Counted(list(made.moments()))
    size = next(made.moments()).image.nbytes  # type: ignore[union-attr]
    reel = Reel(counted, budget_bytes=10 * size)
    for number in range(60):
        reel.at(number)
    assert (counted.begun, reel.nbytes <= 10 * size) == (1, True)
    for number in range(30, 45):
        reel.at(number)
    assert counted.begun == 2, "the present and the past are read on side by side"
    for number in (0, 0, 20, 10, 5, 1):
        reel.at(number)
    assert counted.read <= MOST_CURSORS


def test_times_are_found_among_those_that_were_passed(made: MadeRecording) -> None:
    reel = Reel(made)
    reel.at(30)
    assert [reel.number_at(time_s) for time_s in (-1.0, 2.0, 2.04, 1e9)] == [0, 20, 20, 30]
