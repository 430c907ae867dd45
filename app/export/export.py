"""One run to one format: plays it, and writes files that are whole or not there at all; from the command line, and from
the page's menu.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Literal, Protocol, TypeAlias, get_args

from app.export.mcap_file import Pictures, write_mcap
from app.export.pictures import map_pictures, write_mp4
from app.export.text_formats import g2o_text, graphml_text, tum_files, write_csv
from app.session import Session
from app.session_snapshot import restore_session
from disk import State, require_writable, whole_file
from ratslam_live import command_of
from web.http.asking import Submit, ask_engine
from web.http.commands import Malformed
from web.http.export import ExportRequest, Offer
from web.messages import ReadSession

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


Progress = Callable[[float, str], None]  # simulated seconds since the last call, what is being done
_CLOSE_S = 1e-6  # the times of ticks are rounded, those that people give are not


class Played(Protocol):
    """A run that was kept, or that can be made again in another way."""

    def replay(self, until: int | None = None) -> Iterator[Session]:
        """The session before its first tick and after each tick up to this one, always the same object. The orders of a
        tick are carried out after it was handed out."""
        ...


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of a run in simulated seconds, both ends within. ValueError when it is none."""

    from_s: float = 0.0
    until_s: float = math.inf

    def __post_init__(self) -> None:
        if not 0 <= self.from_s < math.inf:
            raise ValueError(f"--from must be a number of seconds from 0 on, got {self.from_s:g}")
        if not self.until_s >= self.from_s:
            raise ValueError(f"--until must not be before --from ({self.from_s:g} s), got {self.until_s:g}")

    def holds(self, time_s: float) -> bool:
        return self.from_s - _CLOSE_S <= time_s <= self.until_s + _CLOSE_S


def ticks_in(run: Played, window: Window, progress: Progress, what: str) -> Iterator[Session]:
    """The session after each tick of the window. ValueError when the run ended before it."""
    said_s = end_s = 0.0
    some = False
    for session in run.replay():
        end_s = session.time_s
        if end_s - said_s >= 1.0:
            progress(end_s - said_s, what)
            said_s = end_s
        if window.holds(end_s):
            some = True
            yield session
        if end_s + session.frame.dt > window.until_s + _CLOSE_S:  # the next tick would be in the same object
            break
    if not some:
        raise ValueError(f"the run is {end_s:g} s long, so there is nothing in it from {window.from_s:g} s on")


def last_of(ticks: Iterator[Session]) -> Session:
    """The session as it is after the last tick."""
    session = None
    for session in ticks:  # noqa: B007
        pass
    assert session is not None
    return session


COPY_TIMEOUT_S = 10.0  # the engine copies between two ticks
WORDS: dict[Format, str] = {
    "mcap": "MCAP: ROS 2 messages of every tick, for ROS 2, Foxglove, Rerun",
    "tum": "TUM: true path and estimate, for evo",
    "g2o": "g2o: the experience map as a pose graph",
    "graphml": "GraphML: the experience map as a graph",
    "csv": "CSV: a row for each tick",
    "png": "PNG: pictures of map, temporal map and paths",
    "mp4": "MP4: a film of camera, map and pose cells",
}
NOT_KEPT = "this run does not keep itself, so it cannot be played again; start the program with room for it, as --keep-runs 200"


class PageExports:
    """kept: gives the file in which the run on the page keeps itself, None while it does not."""

    def __init__(self, kept: Callable[[], Path | None] = lambda: None) -> None:
        self._kept = kept
        self.done = 0.0  # the share of the file that is being written

    def offers(self) -> list[Offer]:
        kept = self._kept() is not None
        return [
            Offer(format=to, words=WORDS[to], refusal=None if kept or to in AT_A_MOMENT else NOT_KEPT) for to in FORMATS
        ]

    async def write(self, to: str, submit: Submit, out: Path, wanted: ExportRequest) -> list[Path]:
        """Write the run on the page, or a stretch of it. ValueError says why it cannot be."""
        self.done = 0.0
        if to not in FORMATS:
            raise ValueError(f"a run can be had as {', '.join(FORMATS)}, got {to!r}")
        state = await _state(submit) if to in AT_A_MOMENT and wanted.whole else None
        if state is not None:
            await asyncio.to_thread(_write_now, to, state, out)
        else:  # also of a recording, which is no part of a state
            await self._play_again(to, out, wanted)
        return [file for file in files_of(to, out) if file.exists()]

    async def _play_again(self, to: Format, out: Path, wanted: ExportRequest) -> None:
        """In a process of its own: it takes as long as minutes, and the engine must not wait for it."""
        kept = self._kept()
        if kept is None:
            raise ValueError(NOT_KEPT)
        command = [*command_of("app"), "export", str(kept), "--to", to, "--out", str(out), "--say-share"]
        command += ["--pictures", wanted.pictures]
        for name, time_s in (("--from", wanted.from_s), ("--until", wanted.until_s)):
            command += [] if time_s is None else [name, repr(time_s)]
        nothing, pipe = asyncio.subprocess.DEVNULL, asyncio.subprocess.PIPE
        process = await asyncio.create_subprocess_exec(*command, stdin=nothing, stdout=pipe, stderr=pipe)
        assert process.stdout is not None
        assert process.stderr is not None
        try:
            _, said = await asyncio.gather(self._hear(process.stdout), process.stderr.read())
            await process.wait()
        finally:
            if process.returncode is None:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
                await process.wait()
        if process.returncode != 0:
            lines = said.decode(errors="replace").strip().splitlines()
            raise ValueError(
                lines[-1].removeprefix("ratslam: ") if lines else f"it ended with code {process.returncode}"
            )

    async def _hear(self, lines: asyncio.StreamReader) -> None:
        async for line in lines:
            word, _, share = line.decode(errors="replace").partition(" ")
            if word == "done":
                self.done = float(share)


async def _state(submit: Submit) -> State | None:
    """None: the session is that of a recording."""
    try:
        state = (await ask_engine(submit, ReadSession(), COPY_TIMEOUT_S)).result
    except Malformed as error:
        raise ValueError(str(error)) from None
    assert state is None or isinstance(state, State)
    return state


def _write_now(to: Format, state: State, out: Path) -> None:
    write_parts(out, at_a_moment(to, restore_session(state)))
