"""What a spreadsheet, a logger or a data set's author calls a table: found out from its first lines. [ours]

Encoding, `sep=`, delimiter, decimal comma, thousands, comments, header or none: test_folders.py holds the kinds that are read.
"""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice, pairwise
from pathlib import Path

from app.recordings.formats.files import lines_of
from app.recordings.formats.pictures import PICTURES
from app.recordings.formats.sensed import ns_of

_LINES = 60  # that are looked at
_ALIKE = 0.9  # this share of the lines must have the same number of cells
_COMMENT = ("#", "%", "//")
_COMMA = re.compile(r"[+-]?(\d{1,3}(\.\d{3})+|\d*),\d+(e[+-]?\d+)?", re.IGNORECASE)  # 0,5 and 1.234,5
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+(\.\d*)?")  # 1,234 and 1,234.5
_DOTTED = re.compile(r"[+-]?\d{1,3}(\.\d{3})+")  # 1.234, beside numbers with a comma
_POINT = re.compile(r"[+-]?\d*\.\d+(e[+-]?\d+)?", re.IGNORECASE)
_DATE = re.compile(r"(\d{4})[-/.](\d\d?)[-/.](\d\d?)[ T_]+(\d\d?):(\d\d):(\d\d)(?:[.,](\d{1,9}))?Z?")
_CLOCK = re.compile(r"(\d\d?):(\d\d):(\d\d)(?:[.,](\d{1,9}))?")


@dataclass(frozen=True, slots=True)
class Style:
    """How a table is written. header: the names of its columns, empty if it has none; first: the number of the first line
    after it; sample: the cells of its first rows."""

    delimiter: str  # " ": any white space
    comma: bool  # numbers have a decimal comma
    header: tuple[str, ...]
    first: int
    sample: tuple[tuple[str, ...], ...]

    def cells(self, line: str) -> list[str]:
        """Of one line, without the empty ones at its end. csv.Error: it cannot be cut into cells."""
        return _cut(line, self.delimiter)

    def plain(self, text: str) -> str:
        """A number as Python reads it."""
        text = re.sub(r"(?<=\d)[\s'\u2019\u00a0\u202f](?=\d{3})", "", text.strip())
        if self.comma:
            return text.replace(".", "").replace(",", ".") if _COMMA.fullmatch(text) else text.replace(",", ".")
        return text.replace(",", "") if _THOUSANDS.fullmatch(text) else text


def style_of(path: Path) -> Style | None:
    """How a text file is written as a table; None: it has no row. ValueError: it cannot be read."""
    with closing(lines_of(path)) as lines:
        some = [(number, line) for number, line in islice(lines, _LINES) if line.strip()]
    told = re.fullmatch(r'"?sep=(.)"?[;,\t]*', some[0][1].strip("\r\n"), re.IGNORECASE) if some else None
    if told:
        some.pop(0)
    comments = [line for _, line in some if line.lstrip().startswith(_COMMENT)]
    rows = [(number, line) for number, line in some if not line.lstrip().startswith(_COMMENT)]
    if not rows:
        return None
    delimiter = told[1] if told else _delimiter([line for _, line in rows])
    cut = [(number, tuple(_cut(line, delimiter))) for number, line in rows]
    usual = Counter(len(cells) for _, cells in cut).most_common(1)[0][0]
    while len(cut) > 1 and len(cut[0][1]) < usual and not _number_of(cut[0][1][0]):  # a title above the header
        cut.pop(0)
    header, first = tuple[str, ...](), cut[0][0]
    if _is_header(cut[0][1]):
        header, first = cut[0][1], first + 1
        cut.pop(0)
    else:
        header = _commented(comments, delimiter, usual)
    sample = tuple(cells for _, cells in cut)
    return Style(delimiter, _has_comma(sample, delimiter), header, first, sample)


def _cut(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=delimiter != "\t"), list[str]())
    while cells and not cells[-1].strip():
        cells.pop()
    return cells or [""]


def _delimiter(lines: list[str]) -> str:
    """By which nearly all lines have the same number of cells, more than one. A comma may be part of a number."""
    if all(ns_of_date(line) is not None for line in lines):
        return ","
    if all(is_picture(line) and not _number_of(re.split(r"[\s,;]", line.strip())[0]) for line in lines) and not any(
        mark in line for line in lines for mark in "\t;|,"
    ):
        return ","  # names with blanks
    best, share = ",", 0.0
    for delimiter in ("\t", ";", "|", ",", " "):
        try:
            counts = Counter(len(_cut(line, delimiter)) for line in lines)
        except csv.Error:
            continue
        cells, often = counts.most_common(1)[0]
        if cells > 1 and often >= _ALIKE * len(lines):
            return delimiter
        if cells > 1 and often / len(lines) > share:
            best, share = delimiter, often / len(lines)
    return best


def _is_header(cells: tuple[str, ...]) -> bool:
    return any(cells) and not any(
        _number_of(cell) or is_picture(cell) or ns_of_date(cell) is not None for cell in cells
    )


def _commented(comments: list[str], delimiter: str, cells: int) -> tuple[str, ...]:
    """The names of columns in the last comment that has as many words as a row has cells."""
    for comment in reversed(comments):
        for by in (delimiter, ",", " "):
            names = _cut(comment.strip().lstrip("#%/").strip(), by)
            if len(names) == cells and _is_header(tuple(names)):
                return tuple(names)
    return ()


def _has_comma(sample: tuple[tuple[str, ...], ...], delimiter: str) -> bool:
    cells = [cell.strip() for row in sample for cell in row]
    if delimiter == ",":  # one in a quoted cell may be that of thousands
        cells = [cell for cell in cells if not _THOUSANDS.fullmatch(cell)]
    commas = sum(_COMMA.fullmatch(cell) is not None for cell in cells)
    points = sum(_POINT.fullmatch(cell) is not None and _DOTTED.fullmatch(cell) is None for cell in cells)
    return commas > points


def _number_of(cell: str) -> bool:
    return bool(re.fullmatch(r"\s*[+-]?(nan|inf|[\d.,'\s]*\d[\d.,'\s]*(e[+-]?\d+)?)\s*", cell, re.IGNORECASE))


def _is_date(cell: str) -> bool:
    return ns_of_date(cell) is not None


def is_picture(cell: str) -> bool:
    return cell.strip().lower().endswith(PICTURES)


def ns_of_date(text: str) -> int | None:
    """Nanoseconds since 1970 of a date with a time, or since midnight of a time of the day; None: it is neither."""
    text = text.strip()
    if found := _DATE.fullmatch(text):
        return date_ns(*found.groups())
    if found := _CLOCK.fullmatch(text):
        hours, minutes, seconds = map(int, found.groups()[:3])
        return (hours * 3600 + minutes * 60 + seconds) * 10**9 + int((found[4] or "0").ljust(9, "0"))
    return None


def date_ns(year: str, month: str, day: str, hour: str, minute: str, second: str, part: str | None) -> int | None:
    """Nanoseconds since 1970; part: the digits after the seconds."""
    try:
        whole = datetime(int(year), int(month), int(day), int(hour), int(minute), int(second), tzinfo=UTC)
    except ValueError:
        return None
    return round(whole.timestamp()) * 10**9 + int((part or "0").ljust(9, "0"))


# ------------------------------------------------------------ tables without a header

_POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
# What the columns of well-known files without a header are, by what is in them: p a picture, n a number, t a date.
_LAYOUTS = {
    "pppnnnn": ("center", "left", "right", "steering", "throttle", "brake", "speed_mph"),  # Udacity's simulator
    "nnnnnnnn": ("time", *_POSE),  # TUM
    "nnnnnnnnnnnn": tuple(f"pose_{row}{column}" for row in range(3) for column in range(4)),  # KITTI
}


def columns_without_header(style: Style) -> tuple[str, ...]:
    """Names of the columns of a table that has no header; empty ones where nobody knows."""
    width = min((len(row) for row in style.sample), default=0)
    columns = [[row[k] for row in style.sample] for k in range(width)]
    kinds = "".join(map(_kind, columns))
    known = _LAYOUTS.get(kinds)
    if known is not None and _fits(kinds, columns, style):
        return known
    names = [""] * width
    for k, kind in enumerate(kinds):
        if kind == "p":
            names[k] = f"pictures {k + 1}"
    times = [k for k, kind in enumerate(kinds) if kind == "t" or (kind == "n" and _rises(columns[k], style))]
    if times and (times[0] < kinds.find("p") or width == 1):
        names[times[0]] = "time"
    return tuple(names)


def _kind(cells: list[str]) -> str:
    for kind, is_one in (("p", is_picture), ("n", _number_of), ("t", _is_date)):
        if cells and all(is_one(cell) for cell in cells):
            return kind
    return "x"


def _fits(kinds: str, columns: list[list[str]], style: Style) -> bool:
    """Whether numbers are the pose that their count suggests."""
    if "p" in kinds:
        return True
    try:
        rows = [[float(style.plain(cell)) for cell in row] for row in zip(*columns, strict=True)]
    except ValueError:
        return False
    if kinds == "n" * 8:
        return all(abs(math.hypot(*row[4:]) - 1) < 0.05 for row in rows) and _rises(columns[0], style, False)
    return all(abs(math.hypot(*row[at : at + 3]) - 1) < 0.05 for row in rows for at in (0, 4, 8))


def _rises(cells: list[str], style: Style, may_count: bool = True) -> bool:
    """Whether these can be times: they never go back, and do not merely number the rows."""
    try:
        values = [ns_of(style.plain(cell)) for cell in cells]
    except ValueError:
        return False
    steps = {after - before for before, after in pairwise(values)}
    return all(step >= 0 for step in steps) and not (may_count and steps == {10**9} and values[0] in (0, 10**9))


def samples(style: Style, at: int) -> Iterator[str]:
    """The first cells of a column."""
    return (row[at].strip() for row in style.sample if at < len(row))
