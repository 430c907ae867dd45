"""A video, with a CSV file of wheels beside it (same name, .csv) or without any."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from app.recordings.formats.film import Film
from app.recordings.formats.lines import open_whole
from app.recordings.formats.problems import Problems
from app.recordings.formats.sensed import Rates, Sensed
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
    return StreamedRecording(path.name, name, partial(_sensed, Film(path), table), uses=uses)


def _require_video(path: Path) -> None:
    with open_whole(path) as file:
        first = file.read(12)
    if not (first.startswith(_FIRST_BYTES) or first[4:8] in _BOXES):
        raise ValueError(f"{path.name}: not a video that can be read; expected MP4, AVI, MKV or MPEG")


def _sensed(film: Film, table: Table | None, problems: Problems) -> Iterator[Sensed]:
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
