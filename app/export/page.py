"""The exports of the page's menu: from a copy of the session where that is enough, else from the run that keeps itself."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from pathlib import Path

from app.export.export import AT_A_MOMENT, FORMATS, Format, at_a_moment, files_of, write_parts
from app.session_snapshot import restore_session
from disk import State
from ratslam_live import command_of
from web.http.asking import Submit, told
from web.http.commands import Malformed
from web.http.export import Offer, Wish
from web.messages import ReadSession

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

    async def write(self, to: str, submit: Submit, out: Path, wish: Wish) -> list[Path]:
        """Write the run on the page, or a stretch of it. ValueError says why it cannot be."""
        self.done = 0.0
        if to not in FORMATS:
            raise ValueError(f"a run can be had as {', '.join(FORMATS)}, got {to!r}")
        state = await _state(submit) if to in AT_A_MOMENT and wish.whole else None
        if state is not None:
            await asyncio.to_thread(_write_now, to, state, out)
        else:  # also of a recording, which is no part of a state
            await self._play_again(to, out, wish)
        return [file for file in files_of(to, out) if file.exists()]

    async def _play_again(self, to: Format, out: Path, wish: Wish) -> None:
        """In a process of its own: it takes as long as minutes, and the engine must not wait for it."""
        kept = self._kept()
        if kept is None:
            raise ValueError(NOT_KEPT)
        command = [*command_of("app"), "export", str(kept), "--to", to, "--out", str(out), "--say-share"]
        command += ["--pictures", wish.pictures]
        for name, time_s in (("--from", wish.from_s), ("--until", wish.until_s)):
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
        state = (await told(submit, ReadSession(), COPY_TIMEOUT_S)).result
    except Malformed as error:
        raise ValueError(str(error)) from None
    assert state is None or isinstance(state, State)
    return state


def _write_now(to: Format, state: State, out: Path) -> None:
    write_parts(out, at_a_moment(to, restore_session(state)))
