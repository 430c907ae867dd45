"""One run to one format: plays it, and writes files that are whole or not there at all."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Literal, TypeAlias, get_args

from app.export.film import write_mp4
from app.export.map_pictures import map_pictures
from app.export.mcap_file import Pictures, write_mcap
from app.export.played import Played, Progress, Window, last_of, ticks_in
from app.export.text_formats import g2o_text, graphml_text, tum_files, write_csv
from app.session import Session
from disk import require_writable, whole_file

Format: TypeAlias = Literal["mcap", "tum", "g2o", "graphml", "csv", "png", "mp4"]
FORMATS: tuple[Format, ...] = get_args(Format)
SEVERAL: dict[Format, tuple[str, ...]] = {"tum": ("truth", "estimate", "believed"), "png": ("map", "times", "paths")}
OF_OFFICES: tuple[Format, ...] = ("mcap", "png", "mp4")  # a recording has its own pictures, and no floor plan
AT_A_MOMENT: tuple[Format, ...] = ("g2o", "graphml", "png")  # need a session as it is and nothing of what was before


@dataclass(frozen=True, slots=True)
class Choices:
    """How some formats are written. pictures: in mcap; speed: of the film, in times of the run's."""

    pictures: Pictures = "png"
    speed: float = 10.0


def files_of(to: Format, out: Path) -> list[Path]:
    """The files that an export writes at most: `out`, or beside it one for each part, as run-truth.tum."""
    return [_part(out, part) for part in SEVERAL[to]] if to in SEVERAL else [out]


def check_export(to: Format, out: Path) -> None:
    """ValueError when the files cannot be written; better before a long run than after it."""
    for file in files_of(to, out):
        require_writable("--out", file)


def at_a_moment(to: Format, session: Session) -> dict[str, bytes]:
    """The files, by part, of a format that needs no more than the session as it is. A format with one file: its part is ""."""
    if to == "png":
        return map_pictures(session)
    return {"": g2o_text(session) if to == "g2o" else graphml_text(session)}


def export_run(
    run: Played, to: Format, out: Path, window: Window, progress: Progress, choices: Choices | None = None
) -> list[Path]:
    """Play a run and write it. Returns the files. OSError names the file; what was there before is then still there."""
    chosen, said = choices or Choices(), f"to {to}"
    ticks = _suitable(to, ticks_in(run, window, progress, said))
    if to in AT_A_MOMENT:
        return write_parts(out, at_a_moment(to, last_of(ticks)))
    if to == "tum":
        return write_parts(out, tum_files(ticks))
    write: dict[Format, Callable[[IO[bytes]], int]] = {
        "mcap": lambda file: write_mcap(ticks, file, chosen.pictures),
        "csv": lambda file: write_csv(ticks, file),
        "mp4": lambda file: write_mp4(ticks, file, chosen.speed),
    }
    with whole_file(out) as file:
        write[to](file)
    return [out]


def _suitable(to: Format, ticks: Iterator[Session]) -> Iterator[Session]:
    """ValueError at the first tick: the format shows an office, and the run is that of a recording."""
    for session in ticks:
        if not session.source.worlds and to in OF_OFFICES:
            others = ", ".join(other for other in FORMATS if other not in OF_OFFICES)
            raise ValueError(f"{to} is for runs in an office; the run of a recording can be had as {others}")
        yield session


def write_parts(out: Path, parts: dict[str, bytes]) -> list[Path]:
    """Returns the files."""
    files = {_part(out, part): data for part, data in parts.items()}
    for path, data in files.items():
        with whole_file(path) as file:
            file.write(data)
    return [*files]


def _part(out: Path, part: str) -> Path:
    return out.with_name(f"{out.stem}-{part}{out.suffix}") if part else out
