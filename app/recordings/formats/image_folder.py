"""A folder of pictures, with a CSV file or in the order of their numbers."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from app.recordings.formats.pictures import PICTURES, read_picture, within
from app.recordings.formats.problems import Problems, plain
from app.recordings.formats.sensed import Rates, Sensed
from app.recordings.formats.streamed import StreamedRecording
from app.recordings.formats.table import Table, header_of

RATE_HZ = 10.0
MOST_FILES = 2_000_000


def open_image_folder(folder: Path, rate_hz: float | None = None) -> StreamedRecording:
    """rate_hz: pictures a second where no file tells their times (default 10). ValueError: nothing in it can be played."""
    table, pictures = _table(folder), pictures_in(folder)
    if table is None:
        hz = RATE_HZ if rate_hz is None else rate_hz
        uses = (f"camera: {len(pictures)} pictures in the order of their numbers, {hz:g} a second",)
        return StreamedRecording(folder.name, "folder of images", lambda _problems: _numbered(pictures, hz), uses=uses)
    if "image" not in table.columns and not pictures:
        raise ValueError(f"{folder}: no pictures in it, and {table.path.name} names none")
    source = partial(_rows, folder, table, pictures, rate_hz)
    return StreamedRecording(folder.name, "folder of images with CSV", source, uses=table.uses)


def pictures_in(folder: Path) -> list[Path]:
    """The pictures of a folder, or of `images` in it, in the order of the numbers in their names."""
    for place in (folder, folder / "images"):
        try:
            with os.scandir(place) as entries:
                names = [entry.name for entry in entries if Path(entry.name).suffix.lower() in PICTURES]
        except OSError:
            continue
        if len(names) > MOST_FILES:
            raise ValueError(f"{place}: {len(names)} pictures; at most {MOST_FILES}")
        if names:
            return [place / name for name in sorted(names, key=by_number)]
    return []


def by_number(name: str) -> list[tuple[int, int, str]]:
    """Orders `img2` before `img10`."""
    parts = re.split(r"([0-9]+)", name)
    return [(1, int(part[:300]), "") if k % 2 else (0, 0, part) for k, part in enumerate(parts)] + [(0, 0, name)]


def _table(folder: Path) -> Table | None:
    """The CSV file that tells times or motion; one that names pictures rather than one that does not."""
    found = {True: list[Path](), False: list[Path]()}
    for path in sorted(folder.glob("*.csv"))[:100]:
        if (columns := header_of(path)) and {"time", "image", "speed"} & set(columns):
            found["image" in columns].append(path)
    files = found[True] or found[False]
    if len(files) > 1:
        names = ", ".join(plain(path.name, 40) for path in files[:5])
        raise ValueError(
            f"{folder}: {len(files)} CSV files could tell of its pictures ({names}); leave one of them there"
        )
    return Table(files[0]) if files else None


def _numbered(pictures: list[Path], hz: float) -> Iterator[Sensed]:
    for number, path in enumerate(pictures):
        yield Sensed(round(number * 1e9 / hz), plain(path.name), partial(read_picture, path))


def _rows(
    folder: Path, table: Table, pictures: list[Path], rate_hz: float | None, problems: Problems
) -> Iterator[Sensed]:
    """Each row with its picture. Without a column of times, there are `rate_hz` rows a second; without one of pictures,
    each row is that of the next picture."""
    rates = Rates()
    for row, (number, cells) in enumerate(table.rows(problems)):
        where = table.where(number)
        try:
            if "time" in table.columns:
                time_ns = table.time_ns(cells)
                if time_ns is None:
                    raise ValueError("it has no time")
            else:
                time_ns = round(row * 1e9 / (rate_hz or RATE_HZ))
            image = _picture_of(folder, table.text(cells, "image"), pictures)
            if "image" not in table.columns:
                image = pictures[row] if row < len(pictures) else None
            picture = None if image is None else partial(read_picture, image)
            sensed = table.sensed(cells, time_ns, where, rates, picture)
        except ValueError as error:
            problems.add("lines left out", where, f"left out: {error}")
            continue
        yield sensed


def _picture_of(folder: Path, name: str, pictures: list[Path]) -> Path | None:
    """The file that a cell names: in the folder, or where its pictures are."""
    if not name:
        return None
    path = within(folder, name)
    if not path.exists() and pictures:
        beside = within(folder, f"{pictures[0].parent.name}/{name}") if pictures[0].parent != folder else path
        return beside if beside.exists() else path
    return path
