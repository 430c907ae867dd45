"""A folder as data sets and driving courses come: pictures, tables that tell of them, and times in tables or in names. [ours]

There is no reader for each of them. The pictures of one camera are played. A table that names them tells their times and
motion; one with times of its own is merged by its times, where these are those of the pictures; one with as many rows as
there are pictures goes with them one by one. Whatever else lies there is told of, and why it is not used.
test_folders.py has EuRoC, TUM, KITTI, Udacity's and their like.
"""

from __future__ import annotations

import heapq
import posixpath
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.lying import by_number, cameras_of, files_in, left_over, times_in_names
from app.recordings.formats.pictures import read_picture, within
from app.recordings.formats.sensed import Picture, Problems, Rates, Sensed
from app.recordings.formats.streamed import StreamedRecording
from app.recordings.formats.table import Table
from disk.words import plain

RATE_HZ = 10.0
TABLES = (".csv", ".tsv", ".txt", ".dat", ".tum", ".asc")
MOST_TABLES = 60  # in one folder: more are files of one moment each
_APART_S = (
    5.0  # tables that begin so long after the last picture, or end so long before the first, are not of this drive
)
_DISAGREE = 0.05  # of the whole time, between those of a table and those in the names
_LOOKED_AT = 200  # rows, to find whose pictures a table names


def open_image_folder(folder: Path, rate_hz: float | None = None) -> StreamedRecording:
    """rate_hz: pictures a second where no file tells their times (default 10). ValueError: nothing in it can be played."""
    found = _Folder(folder, rate_hz)
    with_table = found.primary is not None or found.beside or found.merged
    kind = "folder of images with CSV" if with_table else "folder of images"
    return StreamedRecording(folder.name, kind, found.sensed, uses=found.uses, unused=found.unused)


class _Folder:
    """What is played of a folder, and how it fits together."""

    def __init__(self, folder: Path, rate_hz: float | None) -> None:
        self._folder = folder
        self._hz = RATE_HZ if rate_hz is None else rate_hz
        self._names = files_in(folder)
        self._reasons: dict[str, str] = {}
        self._cameras = cameras_of(self._names)
        self._of_camera = {name: camera for camera, some in self._cameras.items() for name in some}
        self._by_base: defaultdict[str, list[str]] = defaultdict(list)
        for name in self._of_camera:
            self._by_base[posixpath.basename(name).lower()].append(name)
        tables = self._tables()
        naming = {name: table for name, table in tables.items() if "image" in table.columns}
        self.camera = self._camera(naming)
        self._pictures = self._cameras.get(self.camera, [])
        self.primary: Table | None = None
        self._home = ""
        self._named = self._choose(naming)
        self._times = times_in_names(self._pictures) if self.primary is None or not self._timed(self.primary) else None
        if self._times is not None and self.primary is None:
            order = sorted(range(len(self._times)), key=self._times.__getitem__)
            self._pictures = [self._pictures[k] for k in order]
            self._times = [self._times[k] for k in order]
        self.beside: list[tuple[str, Table]] = []  # row k is of picture k
        self.merged: list[tuple[str, Table]] = []  # by time
        for name in sorted(
            tables, key=lambda name: ("time" not in tables[name].columns, -self._near(name), by_number(name))
        ):
            if name not in naming:
                self._once(name, tables[name])
                self._fit(name, tables[name])
        self._require()
        self._disagreeing = self._compared()

    # ------------------------------------------------------------ what it is

    def _tables(self) -> dict[str, Table]:
        """All text files of which a column is known, by their names."""
        by_place: defaultdict[tuple[str, str], list[str]] = defaultdict(list)
        for name in self._names:
            if name.lower().removesuffix(".gz").endswith(TABLES):
                by_place[posixpath.dirname(name), PurePosixPath(name).suffix].append(name)
        tables: dict[str, Table] = {}
        for some in by_place.values():
            for name in some:
                if len(some) > MOST_TABLES:
                    self._reasons[name] = "one file a moment is not read"
                    continue
                try:
                    tables[name] = table = Table(within(self._folder, name), name)
                    table.survey()
                except ValueError as error:
                    self._reasons[name] = str(error).removeprefix(f"{name}: ")
        return {name: table for name, table in tables.items() if self._has_rows(name, table)}

    def _has_rows(self, name: str, table: Table) -> bool:
        if not table.count or not table.columns:
            self._reasons[name] = "no row of it can be read" if not table.count else "nothing in it is known"
        return bool(table.count and table.columns)

    def _camera(self, naming: dict[str, Table]) -> str:
        """The first of the cameras that a table names; where none does, the first."""
        named = {camera for name, table in naming.items() for camera in self._cameras_in(name, table)}
        whole = [camera for camera in self._cameras if not self._is_poor(camera)]
        return next((camera for camera in whole if camera in named), next(iter(self._cameras), ""))

    def _is_poor(self, camera: str) -> bool:
        return len(self._cameras[camera]) * 10 < max(map(len, self._cameras.values()))

    def _cameras_in(self, name: str, table: Table) -> set[str]:
        some = islice(table.rows(Problems()), _LOOKED_AT)
        found = (self._find(table.text(cells, "image"), posixpath.dirname(name)) for _, cells in some)
        return {self._of_camera[picture] for picture in found if picture is not None}

    def _choose(self, naming: dict[str, Table]) -> set[str]:
        """Of the tables that name pictures, the one that tells most of this camera's. Returns the pictures that it names."""
        fits = {name: self.camera in self._cameras_in(name, table) for name, table in naming.items()}
        order = sorted(naming, key=lambda name: (not fits[name], -len(naming[name].columns), by_number(name)))
        for name in order:
            if self.primary is None and (fits[name] or not self._pictures):
                self.primary, self._home = naming[name], posixpath.dirname(name)
                self._used_name = name
            else:
                same = (
                    "names the same pictures as " + self._used_name
                    if fits[name]
                    else "names pictures that are not played"
                )
                self._reasons[name] = same
        if self.primary is None:
            return set(self._pictures)
        cells = (self.primary.text(cells, "image") for _, cells in self.primary.rows(Problems()))
        named = {self._find(cell, self._home) for cell in cells}
        for picture in self._pictures:
            if picture not in named:
                self._reasons[picture] = f"named by no line of {self.primary.name}"
        return {name for name in named if name is not None and self._of_camera[name] == self.camera}

    def _timed(self, table: Table) -> bool:
        return "time" in table.columns

    def _near(self, name: str) -> int:
        """How many folders a file shares with the pictures."""
        return len(posixpath.commonprefix([name.split("/")[:-1], self.camera.split("/")]))

    def _once(self, name: str, table: Table) -> None:
        """What one table tells, no other does: which is right nobody could say. The first and nearest counts."""
        for other in self._read():
            if twice := table.tells & other.tells:
                table.leave(twice)
                self._reasons[name] = f"{other.name} tells the {' and the '.join(sorted(twice))}"

    def _fit(self, name: str, table: Table) -> None:
        """Whether a table that names no pictures goes with them: by its times, or row by row."""
        tells, span = table.tells, self._span()
        if not tells and name in self._reasons:
            return
        apart = _APART_S * 1e9
        if (
            tells
            and self._timed(table)
            and span
            and span[0] - apart <= table.last_ns
            and table.first_ns <= span[1] + apart
        ):
            self.merged.append((name, table))
            return
        if not tells and table.left:
            self._reasons[name] = f"no use is known for its columns ({', '.join(table.left[:8])})"
        elif not self._pictures:
            self._reasons[name] = "there are no pictures that it could tell of"
        elif self.primary is None and (tells or span is None) and self._rows_fit(table):
            self.beside.append((name, table))
        elif not tells:
            self._reasons[name] = (
                "the pictures have their times from elsewhere" if span is not None
                else f"it has {table.count} times, but there are {len(self._pictures)} pictures"
            )  # fmt: skip
        elif self._timed(table) and span is not None:
            self._reasons[name] = "its times are not those of the pictures"
        else:
            self._reasons[name] = f"it has {table.count} rows, but there are {len(self._pictures)} pictures"

    def _rows_fit(self, table: Table) -> bool:
        """As many as there are pictures; a log that somebody put beside pictures without any times may be longer or shorter."""
        loose = self._timed(table) and self._span() is None and bool(table.tells)
        return table.count == len(self._pictures) or loose

    def _span(self) -> tuple[int, int] | None:
        """The first and the last time of the pictures, if they are known."""
        if self.primary is not None and self._timed(self.primary):
            return self.primary.first_ns, self.primary.last_ns
        if self._times is not None:
            return min(self._times), max(self._times)
        return next(((t.first_ns, t.last_ns) for _, t in self.beside if self._timed(t)), None)

    def _compared(self) -> str | None:
        """What is wrong when the table tells other times than the pictures' names. The table's are taken."""
        told = times_in_names(sorted(self._named, key=by_number)) if self.primary is not None else None
        if self.primary is None or not self._timed(self.primary) or not told:
            return None
        names, table = (max(told) - min(told)) / 1e9, (self.primary.last_ns - self.primary.first_ns) / 1e9
        if abs(names - table) <= max(0.5, _DISAGREE * max(names, table)):
            return None
        return f"its times span {table:.6g} s, those in the names of its pictures {names:.6g} s; the table's are taken"

    def _require(self) -> None:
        plan = next((name for name in self._names if name.lower().endswith((".yaml", ".yml"))), None)
        if len(self._pictures) == 1 and plan is not None and self.primary is None:
            raise ValueError(
                f"{self._folder}: one picture and {plan}: a map, and no recording; open the two files together, as a world"
            )
        if self._pictures or (self.primary is not None and "image" in self.primary.columns):
            return
        found = "; ".join(left_over(self._names, set(), self._reasons)[:6])
        raise ValueError(
            f"{self._folder}: nothing in this folder can be played: no pictures in it. "
            + (f"Found: {found}" if found else "It is empty")
        )

    # ------------------------------------------------------------ what is told

    @property
    def uses(self) -> tuple[str, ...]:
        lines: list[str] = []
        if self.primary is None or not self._timed(self.primary):
            timed = next((table.name for _, table in self.beside if self._timed(table)), None)
            how = (
                "at the times in their names" if self._times is not None
                else f"at the times of {timed}" if timed is not None
                else f"in the order of their numbers, {self._hz:g} a second"
            )  # fmt: skip
            where = "" if self.camera in ("", ".") else f" of {plain(self.camera, 80)}"
            lines.append(f"camera: {len(self._pictures)} pictures{where} {how}")
        for table in self._read():
            lines += [
                sentence for sentence in table.uses if not (table is not self.primary and sentence.startswith("time"))
            ]
        return tuple(lines)

    def _read(self) -> list[Table]:
        primary = [] if self.primary is None else [self.primary]
        return primary + [table for _, table in (*self.beside, *self.merged)]

    @property
    def unused(self) -> tuple[str, ...]:
        used = {name for name, _ in (*self.beside, *self.merged)} | self._named
        if self.primary is not None:
            used.add(self._used_name)
        for picture in self._of_camera:
            if self._of_camera[picture] != self.camera:
                self._reasons[picture] = "pictures of another camera"
        lines = list(left_over(self._names, used, self._reasons))
        for table in self._read():
            if table.left:
                many = "columns" if len(table.left) > 1 else "column"
                lines.append(f"{many} {', '.join(map(repr, table.left[:12]))} of {table.name}: no use for it is known")
        for _, table in self.beside:
            if self.primary is None and table.count != len(self._pictures):
                lines.append(f"{table.name}: it has {table.count} rows, but there are {len(self._pictures)} pictures")
        return tuple(lines)

    # ------------------------------------------------------------ what is sensed

    def sensed(self, problems: Problems) -> Iterator[Sensed]:
        pictures = self._rows(self.primary, problems) if self.primary is not None else self._numbered(problems)
        if self._disagreeing is not None and self.primary is not None:
            problems.add("times that disagree", self.primary.name, self._disagreeing)
        if not self.merged:
            yield from pictures
            return
        others = [self._timed_rows(table, problems) for _, table in self.merged]
        yield from heapq.merge(*others, pictures, key=lambda sensed: sensed.time_ns)

    def _timed_rows(self, table: Table, problems: Problems) -> Iterator[Sensed]:
        rates, last = Rates(), -(10**30)
        for number, cells in table.rows(problems):
            where = table.where(number)
            try:
                time_ns = table.time_ns(cells)
                if time_ns is None or time_ns < last:
                    raise ValueError("it has no time" if time_ns is None else "its time goes back")
                last = time_ns
                yield table.sensed(cells, time_ns, where, rates, None)
            except ValueError as error:
                problems.add("lines left out", where, f"left out: {error}")

    def _numbered(self, problems: Problems) -> Iterator[Sensed]:
        """The pictures one after the other, each with the row of its number where there are tables beside them."""
        beside = [(table, Rates(), table.rows(problems)) for _, table in self.beside]
        for number, name in enumerate(self._pictures):
            where, what = plain(name), f"pictures{'' if self.camera in ('', '.') else f' of {plain(self.camera, 80)}'}"
            sensed = Sensed(round(number * 1e9 / self._hz), where, self._picture(name), frame=number, source=what)
            problems.seen(what)
            if self._times is not None:
                sensed = replace(sensed, time_ns=self._times[number])
            for table, rates, rows in beside:
                row = next(rows, None)
                if row is None and self._times is None and self._timed(table):
                    for _ in self._pictures[number + 1 :]:
                        problems.seen(what)
                    return  # nobody knows when the others were taken
                if row is None:
                    continue
                try:
                    sensed = self._joined(sensed, table, row, rates)
                    problems.read(table.source)
                except ValueError as error:
                    problems.add("lines left out", table.where(row[0]), f"left out: {error}")
                    if self._times is None and self._timed(table):
                        break
            else:
                yield sensed

    def _joined(self, sensed: Sensed, table: Table, row: tuple[int, list[str]], rates: Rates) -> Sensed:
        """With what its row tells. ValueError: one of its values is wrong."""
        time_ns = table.time_ns(row[1]) if self._timed(table) and self._times is None else sensed.time_ns
        if time_ns is None:
            raise ValueError("it has no time")
        more = table.sensed(row[1], time_ns, sensed.where, rates, None)
        told = {name: getattr(more, name) for name in ("speed", "yaw_rate", "throttle", "truth")}
        return replace(sensed, time_ns=time_ns, **{name: value for name, value in told.items() if value is not None})

    def _rows(self, table: Table, problems: Problems) -> Iterator[Sensed]:
        """Each row with the picture that it names. Without a column of times, those in the names count, or else there are so
        many rows a second."""
        rates, frame = Rates(), -1
        at = dict(zip(self._pictures, self._times or (), strict=False))
        for row, (number, cells) in enumerate(table.rows(problems)):
            where, named = table.where(number), table.text(cells, "image")
            frame += bool(named)
            try:
                picture = self._find(named, self._home) if named else None
                if named and picture is None:
                    raise ValueError(f"cannot be read: No such file: {plain(named, 80)!r}")
                other = picture is not None and self._of_camera[picture] != self.camera
                if self._timed(table):
                    if (time_ns := table.time_ns(cells)) is None:
                        raise ValueError("it has no time")
                else:
                    time_ns = at.get(picture or "", round(row * 1e9 / self._hz))
                image = None if picture is None or other else self._picture(picture)
                frame -= other
                sensed = table.sensed(cells, time_ns, where, rates, image)
            except ValueError as error:
                problems.add("lines left out", where, f"left out: {error}")
                continue
            yield replace(sensed, frame=frame)

    def _picture(self, name: str) -> Picture:
        return partial(_read, self._folder, name)

    def _find(self, cell: str, home: str) -> str | None:
        """The picture that a cell names, wherever the folder was when that was written: of those of this name, the one whose
        path ends most alike, and then the nearest to the table. Nothing outside of the folder has such a name."""
        path = cell.replace("\\", "/").strip().strip('"')
        some = self._by_base.get(posixpath.basename(path).lower(), [])
        if len(some) <= 1:
            return some[0] if some else None
        parts = path.lower().split("/")

        def alike(name: str) -> tuple[int, bool, bool]:
            ends = name.lower().split("/")
            same = next(
                (k for k, (a, b) in enumerate(zip(reversed(ends), reversed(parts), strict=False)) if a != b), 99
            )
            return same, name.startswith(f"{home}/") or not home, self._of_camera[name] == getattr(self, "camera", "")

        exact = posixpath.normpath(posixpath.join(home, path))
        return exact if exact in some else max(some, key=alike)


def _read(folder: Path, name: str) -> NDArray[np.uint8]:
    return read_picture(within(folder, name))
