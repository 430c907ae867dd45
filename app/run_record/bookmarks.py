"""Moments of a run that somebody has named. They lie beside the run's file, and change nothing in it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from disk import whole_file
from disk.words import one_line
from web.messages import Bookmark

FILE = "bookmarks.json"
MOST = 100


@checked(frozen=True, slots=True)
class _Row:
    tick: Annotated[int, Field(ge=0)]
    time_s: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    name: Annotated[str, Field(min_length=1, max_length=60), AfterValidator(one_line)]


_ROWS = TypeAdapter(list[_Row])


class Bookmarks:
    """Those of one run, at most one at a tick."""

    def __init__(self, rows: tuple[Bookmark, ...] = ()) -> None:
        self.rows = rows  # by tick

    def put(self, tick: int, time_s: float, name: str) -> None:
        """Name a moment, or name it otherwise. ValueError says what is wrong with the name."""
        name = one_line(name.strip())
        if not name:
            raise ValueError("a bookmark needs a name")
        others = [row for row in self.rows if row.tick != tick]
        if len(others) >= MOST:
            raise ValueError(f"{name!r} would be bookmark number {MOST + 1}; {MOST} are enough, delete one first")
        self.rows = tuple(sorted([*others, Bookmark(tick, time_s, name)], key=lambda row: row.tick))

    def remove(self, tick: int) -> None:
        self.at(tick)
        self.rows = tuple(row for row in self.rows if row.tick != tick)

    def at(self, tick: int) -> Bookmark:
        """ValueError names the ticks that have one."""
        for row in self.rows:
            if row.tick == tick:
                return row
        known = ", ".join(str(row.tick) for row in self.rows) or "none yet"
        raise ValueError(f"there is no bookmark at tick {tick}; there are: {known}")

    def until(self, tick: int) -> Bookmarks:
        """For a branch that leaves the run at this tick."""
        return Bookmarks(tuple(row for row in self.rows if row.tick <= tick))


def write_bookmarks(rows: tuple[Bookmark, ...], folder: Path) -> None:
    """OSError: the disk does not take them."""
    lines = ",\n".join(json.dumps({"tick": row.tick, "time_s": row.time_s, "name": row.name}) for row in rows)
    with whole_file(folder / FILE) as file:
        file.write(f"[{lines}]\n".encode())


def read_bookmarks(folder: Path) -> Bookmarks:
    """None where the file is missing or damaged: a run is not lost with its bookmarks."""
    try:
        rows = _ROWS.validate_json((folder / FILE).read_bytes())
    except (OSError, ValidationError):
        return Bookmarks()
    found = {row.tick: Bookmark(row.tick, row.time_s, row.name) for row in rows[:MOST]}
    return Bookmarks(tuple(found[tick] for tick in sorted(found)))
