"""The moments of a recording by their numbers: in any order they are those of playing it from its beginning."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.recordings.made_odometry import OdometryErrors, WithMadeOdometry
from app.recordings.opening import open_recording
from app.recordings.recording import Moment
from app.recordings.reel import MOST_CURSORS, Reel
from tests.recordings import FORMATS
from tests.unit.app.made_recordings import MadeRecording, recorded


@pytest.fixture(scope="module")
def made() -> MadeRecording:
    return recorded(60)


def same(one: Moment, other: Moment) -> bool:
    told = [(m.frame, m.time_s, m.dt, m.speed, m.yaw_rate, m.throttle, m.truth, m.behaviour) for m in (one, other)]
    arrays = ((one.image, other.image), (one.ranges_m, other.ranges_m))
    return told[0] == told[1] and all(
        np.array_equal(a, b) if a is not None and b is not None else a is b for a, b in arrays
    )


@pytest.mark.parametrize("name", FORMATS)
def test_in_each_format_any_moment_is_there_again(name: str, tmp_path: Path) -> None:
    file, write, _ = FORMATS[name]
    recording = open_recording(write(tmp_path / file))
    straight = list(recording.moments())
    reel, rng = Reel(recording, budget_bytes=0), random.Random(1)
    for number in [rng.randrange(len(straight)) for _ in range(12)]:
        assert same(reel.at(number), straight[number]), number
    assert not reel.has(len(straight))
    with pytest.raises(ValueError, match=f"moment {len(straight)} is not there"):
        reel.at(len(straight))


def test_what_cannot_be_read_has_no_number_and_nothing_else_is_unpacked(tmp_path: Path, monkeypatch) -> None:
    rng = np.random.default_rng(2)
    for k in range(30):
        Image.fromarray(rng.integers(0, 255, (12, 16, 3), dtype=np.uint8)).save(tmp_path / f"{k}.png")
    (tmp_path / "7.png").write_bytes(b"no picture")
    straight = list(open_recording(tmp_path).moments())
    assert [moment.frame for moment in straight][6:8] == [6, 8]
    recording, unpacked = open_recording(tmp_path), list[str]()
    reel = Reel(recording)
    assert same(reel.at(28), straight[28]), "the first time nobody knows which ones can be read"

    from app.recordings.formats import image_folder

    read = image_folder.read_picture
    monkeypatch.setattr(image_folder, "read_picture", lambda path: unpacked.append(path.name) or read(path))
    assert same(reel.at(20), straight[20])
    assert unpacked == ["7.png", "21.png"], "of those that were passed only the one that could not be read"


def test_a_picture_that_is_gone_meanwhile_is_a_sentence(tmp_path: Path) -> None:
    for k in range(8):
        Image.fromarray(np.full((12, 16, 3), 20 * k, np.uint8)).save(tmp_path / f"{k}.png")
    reel = Reel(open_recording(tmp_path), budget_bytes=0)
    assert reel.at(7).frame == 7
    (tmp_path / "3.png").unlink()
    with pytest.raises(ValueError, match=r"3\.png: it could be read before, and cannot be any more"):
        reel.at(3)


def test_odometry_with_errors_is_the_same_again(made: MadeRecording) -> None:
    recording = WithMadeOdometry(made, OdometryErrors(0.1, 0.02, 0.005), seed=4)
    straight, reel = list(recording.moments()), Reel(recording, budget_bytes=0)
    for number in (50, 3, 51, 20, 59):
        assert same(reel.at(number), straight[number]), number


def test_little_is_held_and_few_files_are_open(made: MadeRecording, monkeypatch) -> None:
    size = made.moments().__next__().image.nbytes  # type: ignore[union-attr]
    reel, opened = Reel(made, budget_bytes=10 * size), 0
    moments = made.moments

    def counted(*args: object):
        nonlocal opened
        opened += 1
        return moments(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(made, "moments", counted)
    for number in range(60):
        reel.at(number)
    assert opened == 1
    assert reel.nbytes <= 10 * size
    for number in range(30, 45):
        reel.at(number)
    assert opened == 2, "the present and the past are read on side by side"
    for number in (0, 0, 20, 10, 5, 1):
        reel.at(number)
    assert len(reel._cursors) <= MOST_CURSORS


def test_times_are_found_among_those_that_were_passed(made: MadeRecording) -> None:
    reel = Reel(made)
    reel.at(30)
    assert reel.number_at(-1.0) == 0
    assert reel.number_at(2.0) == 20
    assert reel.number_at(2.04) == 20
    assert reel.number_at(1e9) == 30


def test_a_folder_that_is_gone_is_a_sentence(tmp_path: Path) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    for k in range(5):
        Image.fromarray(np.full((12, 16, 3), 20 * k, np.uint8)).save(folder / f"{k}.png")
    reel = Reel(open_recording(folder), budget_bytes=0)
    assert reel.at(4).frame == 4
    shutil.rmtree(folder)
    with pytest.raises(ValueError, match="could be read before"):
        reel.at(1)
