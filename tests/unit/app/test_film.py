"""Going back in a video: whatever is asked for in whatever order, it is the frame that playing from the beginning gives."""

from __future__ import annotations

import random
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from app.recordings.formats import video
from app.recordings.opening import open_recording
from app.recordings.recording import Moment, Recording
from app.sources.recorded import Reel

pytestmark = pytest.mark.slow

FRAMES = 400
CODECS = {"v.mp4": "mp4v", "v.avi": "MJPG", "x.avi": "XVID", "v.webm": "VP80", "m.mpg": "PIM1"}


def written(path: Path, fourcc: str) -> Path:
    """A drive along a wall of pictures, which stands for a while, so that some frames equal each other."""
    rng, size = np.random.default_rng(3), (96, 64)
    wall = cv2.resize(rng.integers(0, 256, (8, 200, 3), np.uint8), (200 * 8, size[1]), interpolation=cv2.INTER_CUBIC)
    out = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*fourcc), 25, size)
    assert out.isOpened(), fourcc
    for k in range(FRAMES):
        x = 3 * min(k, 150) if k < 200 else 3 * (k - 50)
        out.write(np.ascontiguousarray(wall[:, x : x + size[0]]))
    out.release()
    return path


@pytest.fixture(scope="module", params=CODECS)
def recording(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return open_recording(written(tmp_path_factory.mktemp("video") / request.param, CODECS[request.param]))


def grabbed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Counts the frames that are unpacked from now on."""
    count, really = [0], video.opened

    class Counting:
        def __init__(self, path: Path) -> None:
            self._video = really(path)

        def grab(self) -> bool:
            count[0] += 1
            return self._video.grab()

        def __getattr__(self, name: str) -> object:
            return getattr(self._video, name)

    monkeypatch.setattr(video, "opened", Counting)
    return count


def image(moment: Moment) -> NDArray[np.uint8]:
    assert moment.image is not None
    return moment.image


def test_any_frame_is_that_of_playing_from_the_beginning(recording: Recording) -> None:
    straight = [image(moment) for moment in recording.moments()]
    assert len(straight) >= FRAMES - 1
    reel, rng = Reel(recording, budget_bytes=0), random.Random(1)
    for _ in range(25):
        at = rng.randrange(len(straight) - 4)
        for number in range(at, at + 4):
            assert np.array_equal(image(reel.at(number)), straight[number]), number


def test_most_of_the_way_there_is_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reel = Reel(open_recording(written(tmp_path / "v.mp4", "mp4v")), budget_bytes=0)
    reel.at(FRAMES - 1)
    count = grabbed(monkeypatch)
    reel.at(FRAMES - 10)
    assert count[0] < 100


@pytest.mark.parametrize("lands", ["one late", "on another frame of the same time", "past it", "nowhere"])
def test_a_jump_that_lands_elsewhere_is_not_believed(
    lands: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = open_recording(written(tmp_path / "v.mp4", "mp4v"))
    straight, really = [image(moment) for moment in recording.moments()], video.opened

    class Elsewhere:
        """A video whose frames after a jump are not those that their times tell of."""

        def __init__(self, path: Path) -> None:
            self._video, self._jumped = really(path), False

        def set(self, what: int, value: float) -> None:
            self._jumped = True
            self._video.set(what, value + {"past it": 2000.0, "one late": 0.0}.get(lands, 0.0))
            if lands == "on another frame of the same time":
                self._video.set(what, value - 400)

        def grab(self) -> bool:
            return self._video.grab() and not (self._jumped and lands == "nowhere")

        def get(self, what: int) -> float:
            told = self._video.get(what)
            if self._jumped and what == cv2.CAP_PROP_POS_MSEC:
                return told + {"one late": -40.0, "on another frame of the same time": 400.0}.get(lands, 0.0)
            return told

        def __getattr__(self, name: str) -> object:
            return getattr(self._video, name)

    monkeypatch.setattr(video, "opened", Elsewhere)
    reel = Reel(recording, budget_bytes=0)
    for number in (300, 120, 390, 119):
        for near in range(number, number + 5):
            assert np.array_equal(image(reel.at(near)), straight[near]), near


def test_a_file_that_was_cut_off_meanwhile_is_a_sentence(tmp_path: Path) -> None:
    path = written(tmp_path / "v.avi", "MJPG")
    reel = Reel(open_recording(path), budget_bytes=0)
    reel.at(FRAMES - 1)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 4])
    with pytest.raises(ValueError, match="could be read before, and cannot be any more"):
        reel.at(FRAMES - 20)
