"""Recordings of AirSim: `airsim_rec.txt` with exact poses, and pictures beside it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from app.recordings.formats.files import lines_of
from app.recordings.formats.pictures import beside, read_picture
from app.recordings.formats.sensed import Problems, Sensed, heading_of, ns_of
from app.recordings.formats.streamed import StreamedRecording

FILE = "airsim_rec.txt"
_NEEDED = ("TimeStamp", "POS_X", "POS_Y", "Q_W", "Q_X", "Q_Y", "Q_Z", "ImageFile")
_FAR_M = 1e7
_LINES = f"lines of {FILE}"


def open_airsim(folder: Path, used: set[str]) -> StreamedRecording:
    """used: is filled with the names of the files that belong to it.

    AirSim's axes are north, east, down; ours are x, y, up, so y and the heading change their signs. ValueError.

    Its speedometer counts simulated seconds, but the times are those of the computer's clock, so it is not used.
    """
    uses = (
        f"camera: column 'ImageFile' of {FILE}",
        f"truth: columns POS_X, POS_Y, Q_* of {FILE}, with y and heading turned over (north-east-down)",
        "no odometry in it: --odometry-from-truth makes one with errors of known size",
    )
    used.add(FILE)
    return StreamedRecording(folder.name, "AirSim", partial(_sensed, folder, used), uses=uses)


def _sensed(folder: Path, used: set[str], problems: Problems) -> Iterator[Sensed]:
    columns: dict[str, int] = {}
    row = -1
    for number, line in lines_of(folder / FILE):
        cells = line.split("\t")
        where = f"{FILE}: line {number}"
        if not columns:
            columns = {name.strip(): at for at, name in enumerate(cells)}
            if missing := [name for name in _NEEDED if name not in columns]:
                raise ValueError(f"{where}: the columns {', '.join(missing)} are missing")
        elif line.strip():
            row += 1
            problems.seen(_LINES)
            try:
                yield _row(folder, used, [cells[columns[name]] for name in _NEEDED], where, row)
            except (ValueError, IndexError) as error:
                what = "too few columns" if isinstance(error, IndexError) else str(error)
                problems.add("lines left out", where, f"left out: {what}")


def _row(folder: Path, used: set[str], cells: list[str], where: str, row: int) -> Sensed:
    x, y, w, qx, qy, qz = (float(cell) for cell in cells[1:7])
    if not (math.hypot(x, y) < _FAR_M and 0.5 < math.hypot(w, qx, qy, qz) < 2):
        raise ValueError("its pose is none")
    name = cells[7].strip().split(";")[0]
    path = beside(folder, name)
    used.add(path.relative_to(folder.resolve()).as_posix())
    heading = -heading_of(w, qx, qy, qz)
    return Sensed(ns_of(cells[0], 1_000_000), where, partial(read_picture, path), truth=(x, -y, heading), frame=row,
                  source=_LINES)  # fmt: skip
