"""A video, with a CSV file of wheels beside it (same name, .csv) or without any."""

from __future__ import annotations

import os
import zlib
from array import array
from bisect import bisect_left
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.files import open_whole
from app.recordings.formats.pictures import require_size
from app.recordings.formats.sensed import Problems, Rates, Sensed
from app.recordings.formats.streamed import StreamedRecording
from app.recordings.formats.table import Table
from disk.words import plain

VIDEOS = (".mp4", ".avi", ".mkv", ".mov", ".webm", ".m4v", ".mpg", ".mpeg")
_FIRST_BYTES = (b"RIFF", b"\x1aE\xdf\xa3", b"\x00\x00\x01\xba", b"\x00\x00\x01\xb3")
_BOXES = (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip")


def open_video(path: Path) -> StreamedRecording:
    """Frames have the times that the file gives them. ValueError: it is no video, or nothing in it can be read."""
    _require_video(path)
    beside = path.with_suffix(".csv")
    table = Table(beside) if beside.is_file() else None
    if table is not None:
        table.survey()
    if table is not None and "time" not in table.columns:
        raise ValueError(f"{beside.name}: line 1: a video's CSV needs a column 'time_s', since the video's start")
    uses = (f"camera: {plain(path.name)}", *(() if table is None else table.uses))
    name = "video" if table is None else "video with CSV"
    return StreamedRecording(path.name, name, partial(_sensed, _Film(path), table), uses=uses)


def _require_video(path: Path) -> None:
    with open_whole(path) as file:
        first = file.read(12)
    if not (first.startswith(_FIRST_BYTES) or first[4:8] in _BOXES):
        raise ValueError(f"{path.name}: not a video that can be read; expected MP4, AVI, MKV or MPEG")


def _sensed(film: _Film, table: Table | None, problems: Problems) -> Iterator[Sensed]:
    """Frames and rows in the order of their times."""
    rows = iter(()) if table is None else _rows(table, problems)
    row = next(rows, None)
    for frame in film.frames(problems):
        while row is not None and row.time_ns <= frame.time_ns:
            yield row
            row = next(rows, None)
        yield frame
    if row is not None:  # covers the last frames, too
        yield row


def _rows(table: Table, problems: Problems) -> Iterator[Sensed]:
    """Times since the video's start; those since 1970 begin with it."""
    rates, first = Rates(), None
    for number, cells in table.rows(problems):
        where = table.where(number)
        try:
            time = table.time_ns(cells)
            if time is None:
                raise ValueError("it has no time")
            if first is None:
                first = time if time > 10**17 else 0
            yield table.sensed(cells, time - first, where, rates, None)
        except ValueError as error:
            problems.add("lines left out", where, f"left out: {error}")


FAR = 60  # frames: so many are sooner passed than jumped over
BROKEN = -1  # in place of a checksum: the frame cannot be unpacked
_OPTIONS = "protocol_whitelist;file|threads;1"  # a file may not make us read another, or one from a network


class _Film:
    """The frames of one file by their numbers. [ours] Going back, it jumps to a keyframe and does not unpack all anew.

    Where a jump lands differs between formats. So time and checksum of each frame are noted when it is read first, and
    a frame after a jump counts only if it is that very frame; the first one that is not ends all jumps in this
    video, and it is read from its beginning as before. test_film.py.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._times, self._sums = array("q"), array("q")  # ns, and CRC-32, of each frame
        self._whole = False  # whether all are known
        self.jumps = True  # whether every frame after a jump was the right one so far

    def frames(self, problems: Problems) -> Iterator[Sensed]:
        """In order. Those of a film that was read once are only unpacked when they are asked for."""
        if not self._whole:
            yield from self._anew(problems)
            return
        reading = _Reading(self, self._path)
        for number, time in enumerate(self._times):
            yield Sensed(time, self._where(number), partial(self._again, reading, number))

    def is_frame(self, number: int, frame: NDArray[np.uint8]) -> bool:
        """Whether this is the frame of this number, to the bit."""
        return self._sums[number] == _sum(frame)

    def time(self, number: int) -> int:
        """ns."""
        return self._times[number]

    def number_at(self, time: int) -> int | None:
        """Of the frame that has this very time."""
        number = bisect_left(self._times, time)
        return number if number < len(self._times) and self._times[number] == time else None

    def _where(self, number: int) -> str:
        return f"{plain(self._path.name)}: frame {number}"

    def _anew(self, problems: Problems) -> Iterator[Sensed]:
        """Read it for the first time, and note what is there."""
        video = opened(self._path)
        del self._times[:], self._sums[:]
        try:
            rate = video.get(cv2.CAP_PROP_FPS)
            step_ns = round(1e9 / rate) if 0.01 < rate < 10_000 else 100_000_000
            number, last = 0, -1
            while video.grab():
                time = _grabbed_ns(video)
                if time <= last:  # formats without times of their own
                    time = last + step_ns if number else 0
                frame = _retrieved(video)  # at once: when it is asked for, the next one may be there already
                self._times.append(time)
                self._sums.append(BROKEN if frame is None else _sum(frame))
                yield Sensed(time, self._where(number), partial(_unpacked, frame))
                number, last = number + 1, time
        except cv2.error as error:
            problems.add("the rest of the video", self._path.name, f"left out: {error.err}")
        finally:
            video.release()
        self._whole = True

    def _again(self, reading: _Reading, number: int) -> NDArray[np.uint8]:
        return _unpacked(None if self._sums[number] == BROKEN else reading.frame(number))


class _Reading:
    """A place at which a film that is known is being read. The file is open from the first frame that is asked for,
    until nobody can ask for another."""

    def __init__(self, film: _Film, path: Path) -> None:
        self._film, self._path = film, path
        self._video: cv2.VideoCapture | None = None
        self._next = 0  # number of the frame that comes next
        self._jumped = False  # so that what comes has to be checked

    def frame(self, number: int) -> NDArray[np.uint8] | None:
        """The frame of this number; None: it cannot be unpacked any more."""
        if self._film.jumps and number > FAR and not self._next <= number <= self._next + FAR:
            self._jump(number)
        frame = self._read(number)
        if self._jumped and (frame is None or not self._film.is_frame(number, frame)):
            self._film.jumps = False
            self._begin()
            frame = self._read(number)
        return frame

    def _jump(self, number: int) -> None:
        """Go to some frame before this one, if the file can be read from there."""
        video = self._video or self._begin()
        video.set(cv2.CAP_PROP_POS_MSEC, self._film.time(number - 1) / 1e6)
        there = self._film.number_at(_grabbed_ns(video)) if video.grab() else None
        if there is None or there >= number:
            self._film.jumps = False
            self._begin()
        else:
            self._next, self._jumped = there + 1, True

    def _read(self, number: int) -> NDArray[np.uint8] | None:
        """Go on to this frame, from the beginning if it was passed."""
        video = self._begin() if self._video is None or number < self._next else self._video
        try:
            while self._next <= number:
                if not video.grab():
                    return None
                self._next += 1
            return _retrieved(video)
        except cv2.error:
            return None

    def _begin(self) -> cv2.VideoCapture:
        self._video, self._next, self._jumped = opened(self._path), 0, False
        return self._video


def opened(path: Path) -> cv2.VideoCapture:
    """ValueError: it cannot be read, or its frames are too large."""
    os.environ.setdefault("OPENCV_FFMPEG_CAPTURE_OPTIONS", _OPTIONS)
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)  # what is wrong is said here, once
    try:
        video = cv2.VideoCapture(str(path.absolute()), cv2.CAP_FFMPEG)
    except cv2.error:
        raise ValueError(f"{path.name}: the video cannot be read") from None
    if not video.isOpened():
        raise ValueError(f"{path.name}: the video cannot be read")
    require_size(int(video.get(cv2.CAP_PROP_FRAME_WIDTH)), int(video.get(cv2.CAP_PROP_FRAME_HEIGHT)))
    return video


def _grabbed_ns(video: cv2.VideoCapture) -> int:
    """The time of the frame that was grabbed last, as the file has it, ns; -1: it has none."""
    ms = video.get(cv2.CAP_PROP_POS_MSEC)
    return round(ms * 1e6) if abs(ms) < 5e12 else -1  # in 64 bits


def _retrieved(video: cv2.VideoCapture) -> NDArray[np.uint8] | None:
    """The frame that was grabbed last; None: it cannot be unpacked."""
    good, frame = video.retrieve()
    return np.asarray(frame, np.uint8) if good and frame.ndim == 3 else None


def _sum(frame: NDArray[np.uint8]) -> int:
    return zlib.crc32(np.ascontiguousarray(frame).data)


def _unpacked(frame: NDArray[np.uint8] | None) -> NDArray[np.uint8]:
    if frame is None:
        raise ValueError("the frame cannot be unpacked")
    return cv2.cvtColor(frame, cv2.COLOR_BGR2RGB).astype(np.uint8, copy=False)
