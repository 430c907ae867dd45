"""A video, with a CSV file of wheels beside it (same name, .csv) or without any."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.lines import open_whole
from app.recordings.formats.pictures import require_size
from app.recordings.formats.problems import Problems, plain
from app.recordings.formats.sensed import Picture, Rates, Sensed
from app.recordings.formats.streamed import StreamedRecording
from app.recordings.formats.table import Table

VIDEOS = (".mp4", ".avi", ".mkv", ".mov", ".webm", ".m4v", ".mpg", ".mpeg")
_FIRST_BYTES = (b"RIFF", b"\x1aE\xdf\xa3", b"\x00\x00\x01\xba", b"\x00\x00\x01\xb3")
_BOXES = (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip")
_OPTIONS = "protocol_whitelist;file|threads;1"  # a file may not make us read another, or one from a network


def open_video(path: Path) -> StreamedRecording:
    """Frames have the times that the file gives them. ValueError: it is no video, or nothing in it can be read."""
    _require_video(path)
    beside = path.with_suffix(".csv")
    table = Table(beside) if beside.is_file() else None
    if table is not None and "time" not in table.columns:
        raise ValueError(f"{beside.name}: line 1: a video's CSV needs a column 'time_s', since the video's start")
    uses = (f"camera: {plain(path.name)}", *(() if table is None else table.uses))
    name = "video" if table is None else "video with CSV"
    return StreamedRecording(path.name, name, partial(_sensed, path, table), uses=uses)


def _require_video(path: Path) -> None:
    with open_whole(path) as file:
        first = file.read(12)
    if not (first.startswith(_FIRST_BYTES) or first[4:8] in _BOXES):
        raise ValueError(f"{path.name}: not a video that can be read; expected MP4, AVI, MKV or MPEG")


def _sensed(path: Path, table: Table | None, problems: Problems) -> Iterator[Sensed]:
    """Frames and rows in the order of their times."""
    rows = iter(()) if table is None else _rows(table, problems)
    row = next(rows, None)
    for frame in _frames(path, problems):
        while row is not None and row.time_ns <= frame.time_ns:
            yield row
            row = next(rows, None)
        yield frame
    if row is not None:  # covers the last frames, too
        yield row


def _frames(path: Path, problems: Problems) -> Iterator[Sensed]:
    os.environ.setdefault("OPENCV_FFMPEG_CAPTURE_OPTIONS", _OPTIONS)
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    try:
        video = cv2.VideoCapture(str(path.absolute()), cv2.CAP_FFMPEG)
    except cv2.error:
        raise ValueError(f"{path.name}: the video cannot be read") from None
    try:
        if not video.isOpened():
            raise ValueError(f"{path.name}: the video cannot be read")
        require_size(int(video.get(cv2.CAP_PROP_FRAME_WIDTH)), int(video.get(cv2.CAP_PROP_FRAME_HEIGHT)))
        rate = video.get(cv2.CAP_PROP_FPS)
        step_ns = round(1e9 / rate) if 0.01 < rate < 10_000 else 100_000_000
        number, last = 0, -1
        while video.grab():
            told = video.get(cv2.CAP_PROP_POS_MSEC)
            time = round(told * 1e6) if abs(told) < 1e14 else -1
            if time <= last:  # formats without times of their own
                time = last + step_ns if number else 0
            yield Sensed(time, f"{plain(path.name)}: frame {number}", _picture(video))
            number, last = number + 1, time
    except cv2.error as error:
        problems.add("the rest of the video", path.name, f"left out: {error.err}")
    finally:
        video.release()


def _picture(video: cv2.VideoCapture) -> Picture:
    """The frame that was grabbed last. It is unpacked at once: when it is asked for, the next one may be there already."""
    good, frame = video.retrieve()

    def unpacked() -> NDArray[np.uint8]:
        if not good or frame.ndim != 3:
            raise ValueError("the frame cannot be unpacked")
        return cv2.cvtColor(frame, cv2.COLOR_BGR2RGB).astype(np.uint8, copy=False)

    return unpacked


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
