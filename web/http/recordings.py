"""Recordings that a page sends: kept in a folder of their own for as long as they play, opened, and played."""

from __future__ import annotations

import asyncio
import contextlib
import os
import shutil
import tempfile
import threading
from collections.abc import Callable, Generator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fastapi import FastAPI, Query, Request
from fastapi.responses import Response
from pydantic import BaseModel

from web.http.asking import ERRORS, Submit, ask_engine, json_response
from web.http.commands import Declined, Malformed, wrong
from web.http.security import MAX_RECORDING_BYTES, Limits
from web.http.state import to_json
from web.messages import PlayRecording, RecordingView

MOST_FILES, DEEPEST = 100_000, 8
LONGEST = 200  # bytes of a name; most disks take 255
PLAY_TIMEOUT_S = 60.0
MOST_ARRIVING = 4  # recordings in one file that are being sent at once
TOKEN = "^[0-9a-f]{8,64}$"  # which page sends what
LOOK_S = 0.5  # whether whoever sent it is still there, while it is opened
# What plays the recording in a file; ValueError says what is wrong with it. The event calls it off.
Opener = Callable[[Path, threading.Event], object]


class Played(BaseModel):
    """The recording that plays now."""

    name: str
    format: str
    moments: int
    seconds: float
    has: list[str]
    over: bool


class Left(BaseModel):
    """Bytes that the other files of the folder may have."""

    room: int


class SentRecordings:
    """The one that plays. One that is refused is deleted, and what played goes on."""

    def __init__(self, opener: Opener, submit: Submit) -> None:
        self._open, self._submit = opener, submit
        self._limits, self._one = Limits(), asyncio.Lock()
        self._arriving = 0
        self._folder: str | None = None
        self._coming: SentFolder | None = None

    async def take(self, request: Request, name: str) -> bytes:
        """A recording in one file."""
        self._limits.pass_on("recording")
        if self._arriving >= MOST_ARRIVING:
            raise Declined.of(429, f"{MOST_ARRIVING} recordings are being sent already; wait until one is there")
        self._arriving += 1
        try:
            home = await asyncio.to_thread(_new_folder)
            try:
                path = Path(home) / plain(name)
                whole = Room(MAX_RECORDING_BYTES)
                await _write(request, path, whole)
                if whole.left == MAX_RECORDING_BYTES:
                    raise Malformed([wrong("recording", path.name, f"{path.name} is empty")])
                return await self._play_instead(request, path, home)
            except BaseException:
                shutil.rmtree(home, ignore_errors=True)
                raise
        finally:
            self._arriving -= 1

    async def take_part(self, request: Request, token: str, of: str, name: str) -> bytes:
        """A file of the folder `of`. The first one with another token begins another folder."""
        if self._coming is None or self._coming.token != token:
            self._forget_coming()
            self._coming = SentFolder(token, of)
        coming = self._coming
        path = await asyncio.to_thread(coming.place, name)
        await _write(request, path, coming.room)
        return to_json({"room": coming.room.left})

    async def take_folder(self, request: Request, token: str) -> bytes:
        """All files of the folder have been sent: play it."""
        self._limits.pass_on("recording")
        coming = self._coming
        if coming is None or coming.token != token:
            raise Malformed([wrong("folder", token, "no file of this folder has been sent, or another came after it")])
        self._coming = None
        try:
            return await self._play_instead(request, coming.path, coming.home)
        except BaseException:
            coming.forget()
            raise

    async def _play_instead(self, request: Request, path: Path, home: str) -> bytes:
        """Play what lies there, one after the other; then what played before is deleted."""
        async with self._one:
            view = await self._play(request, path)
            self._forget_played()
            self._folder = home
        return to_json(asdict(view))

    def forget(self) -> None:
        """Delete what plays, and what was on its way."""
        self._forget_played()
        self._forget_coming()

    def _forget_played(self) -> None:
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = None

    def _forget_coming(self) -> None:
        if self._coming is not None:
            self._coming.forget()
            self._coming = None

    async def _play(self, request: Request, path: Path) -> RecordingView:
        try:
            player = await self._opened(request, path)
        except ValueError as error:
            reason = str(error).replace(f"{path.parent}{os.sep}", "")
            raise Malformed([wrong("recording", path.name, reason)]) from None
        view = (await ask_engine(self._submit, PlayRecording(player), PLAY_TIMEOUT_S)).result
        assert isinstance(view, RecordingView)
        return view

    async def _opened(self, request: Request, path: Path) -> object:
        """What plays it. Nobody waits behind a recording whose sender has left: opening it is called off."""
        called_off = threading.Event()
        opening = asyncio.ensure_future(asyncio.to_thread(self._open, path, called_off))
        try:
            while not (await asyncio.wait({opening}, timeout=LOOK_S))[0]:
                if await request.is_disconnected():
                    called_off.set()
            return opening.result()
        finally:
            called_off.set()


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
        request: Request, name: str = Query(min_length=1, max_length=200, description="of the file, with its ending"),
        folder: str | None = Query(None, pattern=TOKEN, description="play the folder whose files were put with this"),
    ) -> Response:  # fmt: skip
        """Play a recording of a robot, in one file or in a folder that was sent before. One that cannot be played is
        refused, and the session goes on."""
        return json_response(await (sent.take(request, name) if folder is None else sent.take_folder(request, folder)))

    @app.put("/api/recordings", tags=["recordings"], openapi_extra={"requestBody": body},
             responses={200: {"model": Left}, **ERRORS})  # fmt: skip
    async def put(
        request: Request, folder: str = Query(pattern=TOKEN, description="the same for all files of a folder"),
        of: str = Query(min_length=1, max_length=200, description="the folder's name"),
        name: str = Query(min_length=1, max_length=1000, description="of the file in the folder, with / between"),
    ) -> Response:  # fmt: skip
        """Send a file of a folder that is to be played. The folder that was sent before and not played is deleted."""
        return json_response(await sent.take_part(request, folder, of, name))

    return sent


class Room:
    """Bytes that a recording may still have."""

    def __init__(self, most: int) -> None:
        self.most = self.left = most

    def take(self, size: int) -> None:
        """Declined when there are not so many."""
        if size > self.left:
            raise Declined.of(413, f"a recording may have at most {self.most} bytes")
        self.left -= size


class SentFolder:
    """A folder that is sent file by file; its files lie where they lay, and nowhere else. It is made at once; whoever asked for
    it deletes it (`forget`) or takes it over (`home`)."""

    def __init__(self, token: str, name: str) -> None:
        """name: of the folder, as the page tells it."""
        self.token, self.home = token, _new_folder()
        self.path = Path(self.home) / plain(name)
        try:
            with kept():
                self.path.mkdir()
        except Declined:
            self.forget()
            raise
        self.room = Room(MAX_RECORDING_BYTES)
        self._files = 0

    def place(self, name: str) -> Path:
        """Where a file of this name belongs, its folder made. Malformed: it would lie elsewhere, or there are too many."""
        parts = name.replace("\\", "/").split("/")
        if not all(map(_is_plain, parts)) or len(parts) > DEEPEST:
            reason = f"a file's name in a folder must be up to {DEEPEST} plain names of at most {LONGEST} bytes with / between"
            raise Malformed([wrong("name", name[:80], reason)])
        self._files += 1
        if self._files > MOST_FILES:
            raise Malformed([wrong("name", name[:80], f"a folder with more than {MOST_FILES} files")])
        path = self.path.joinpath(*parts)
        try:
            with kept():
                path.parent.mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            reason = "a file of this folder has the name of one of its folders"
            raise Malformed([wrong("name", name[:80], reason)]) from None
        if path.is_dir():
            raise Malformed([wrong("name", name[:80], "a folder of this folder has this name")])
        return path

    def forget(self) -> None:
        shutil.rmtree(self.home, ignore_errors=True)


async def _write(request: Request, path: Path, room: Room) -> None:
    """The body into a file, part by part. Raises Declined when there is no room for it or the disk is full."""
    with kept(), contextlib.closing(await asyncio.to_thread(path.open, "wb")) as file:
        async for part in request.stream():
            room.take(len(part))
            await asyncio.to_thread(file.write, part)


def _new_folder() -> str:
    with kept():
        return tempfile.mkdtemp(prefix="ratslam-recording-")


@contextlib.contextmanager
def kept() -> Generator[None]:
    """What is written here is kept, or Declined says why not. Names that are taken are for the caller."""
    try:
        yield
    except (FileExistsError, NotADirectoryError):
        raise
    except OSError as error:
        raise Declined.of(507, f"the recording cannot be kept: {error.strerror or error}") from None


def _is_plain(name: str) -> bool:
    """Whether this can be the name of a file or a folder on any disk."""
    return name.strip(". ") != "" and name.isprintable() and len(name.encode(errors="replace")) <= LONGEST


def plain(name: str) -> str:
    """The bare name in what a browser calls a file, without folders and control characters; of a long one the end, which tells
    the format."""
    bare = "".join(c for c in name.replace("\\", "/").rpartition("/")[2] if c.isprintable())
    while len(bare.encode(errors="replace")) > LONGEST:
        bare = bare[1:]
    return bare if _is_plain(bare) else "recording"
