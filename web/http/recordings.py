"""Recordings that are sent to the page: kept in a folder of their own for as long as they play, opened, and played."""

from __future__ import annotations

import asyncio
import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fastapi import FastAPI, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel

from web.http.asking import Submit, told
from web.http.bodies import ERRORS, json_response
from web.http.commands import Declined, Malformed, wrong
from web.http.security import MAX_RECORDING_BYTES, Limits
from web.http.state import recording_fields, to_json
from web.messages import PlayRecording, RecordingView

PLAY_TIMEOUT_S = 60.0
Opener = Callable[[Path], object]  # what plays the recording in a file; ValueError says what is wrong with it


class Played(BaseModel):
    """The recording that plays now."""

    name: str
    format: str
    moments: int
    seconds: float
    has: list[str]
    over: bool


class SentRecordings:
    """The one that plays. One that is refused is deleted, and what played goes on."""

    def __init__(self, opener: Opener, submit: Submit) -> None:
        self._open, self._submit = opener, submit
        self._limits, self._one = Limits(), asyncio.Lock()
        self._folder: str | None = None

    async def take(self, request: Request, name: str) -> bytes:
        self._limits.pass_on("recording")
        async with self._one:
            folder = await asyncio.to_thread(tempfile.mkdtemp, prefix="ratslam-recording-")
            try:
                path = Path(folder) / _plain(name)
                await _write(request, path)
                view = await self._play(path)
            except BaseException:
                shutil.rmtree(folder, ignore_errors=True)
                raise
            self.forget()
            self._folder = folder
        return to_json(recording_fields(view))

    def forget(self) -> None:
        """Delete the file of the recording before."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = None

    async def _play(self, path: Path) -> RecordingView:
        try:
            player = await asyncio.to_thread(self._open, path)
        except ValueError as error:
            reason = str(error).replace(f"{path.parent}{os.sep}", "")
            raise Malformed([wrong("recording", path.name, reason)]) from None
        view = (await told(self._submit, PlayRecording(player), PLAY_TIMEOUT_S)).result
        assert isinstance(view, RecordingView)
        return view


def add_recordings(app: FastAPI, opener: Opener | None, submit: Submit) -> SentRecordings | None:
    """The route, and who keeps what was sent. Without an opener no recording is taken."""
    if opener is None:
        return None
    sent = SentRecordings(opener, submit)
    body: dict[str, Any] = {"required": True, "content": {"application/octet-stream": {
        "schema": {"type": "string", "format": "binary"}}}}  # fmt: skip

    @app.post("/api/recordings", tags=["recordings"], openapi_extra={"requestBody": body},
              responses={200: {"model": Played}, **ERRORS})  # fmt: skip
    async def play(
        request: Request, name: str = Query(min_length=1, max_length=200, description="of the file, with its ending")
    ) -> Response:
        """Play a recording of a robot, in one file. One that cannot be played is refused, and the session goes on."""
        return json_response(await sent.take(request, name))

    return sent


async def _write(request: Request, path: Path) -> None:
    """The body into a file, part by part. Raises Declined when it is too long or the disk is full."""
    size = 0
    try:
        with contextlib.closing(await asyncio.to_thread(path.open, "wb")) as file:
            async for part in request.stream():
                size += len(part)
                if size > MAX_RECORDING_BYTES:
                    raise Declined.of(413, f"a recording may have at most {MAX_RECORDING_BYTES} bytes")
                await asyncio.to_thread(file.write, part)
    except OSError as error:
        raise Declined.of(507, f"the recording cannot be kept: {error.strerror or error}") from None
    if size == 0:
        raise Malformed([wrong("recording", path.name, f"{path.name} is empty")])


def _plain(name: str) -> str:
    """The bare file name in what a browser calls a file, without folders and control characters."""
    bare = "".join(c for c in name.replace("\\", "/").rpartition("/")[2] if c.isprintable())
    return bare if bare.strip(". ") else "recording"
