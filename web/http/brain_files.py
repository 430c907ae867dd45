"""A brain as a file that a person can keep: what `--save-brain` writes and `--brain` reads, and what the page downloads."""

from __future__ import annotations

import asyncio
import io
import time

from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from disk import State, encode, write_state
from ratslam_core import RatSlam
from ratslam_core.brain_file import read_brain
from web.http.asking import NoAnswer, Submit, told
from web.http.commands import Malformed
from web.messages import ReadBrain

FRESH_S = 10.0  # how old a file may be that is sent to a new request
SENT_WITHIN_S = 300.0  # a reader that does not take the file keeps others from a new one for no longer than this
COPY_TIMEOUT_S = 10.0  # the engine copies between two ticks


def packed(snapshot: State) -> bytes:
    """Takes a while; not for the event loop."""
    file = io.BytesIO()
    write_state(snapshot, file)
    return file.getvalue()


def unpacked(data: bytes) -> RatSlam:
    """ValueError says what is wrong with the file. Takes a while; not for the event loop."""
    return read_brain(io.BytesIO(data))


class BrainDownload:
    """The brain as a download, for one event loop: made once, in one thread, for all who ask meanwhile. One is in memory at a
    time."""

    def __init__(self, submit: Submit) -> None:
        self._submit = submit
        self._file: asyncio.Task[bytes] | None = None
        self._asked_s = 0.0
        self._wanted = 0  # by how many requests the file is in use

    async def answer(self, headers: dict[str, str]) -> Response:
        """The file as an answer. Raises NoAnswer when the engine gives none, or an older one is still being sent."""
        if self._file is not None and time.monotonic() - self._asked_s > FRESH_S:
            raise NoAnswer.of(429, "the brain is being sent to somebody; wait until it is there and ask again")
        if self._file is None:
            self._file, self._asked_s = asyncio.create_task(self._make()), time.monotonic()
        self._wanted += 1
        try:
            data = await asyncio.shield(self._file)
        except BaseException:
            self.done()
            raise
        return _Sent(self, data, headers)

    def done(self) -> None:
        """One request less uses the file; after the last one it is dropped."""
        self._wanted -= 1
        if self._wanted == 0:
            self._file = None

    async def _make(self) -> bytes:
        try:
            copy = (await told(self._submit, ReadBrain(), COPY_TIMEOUT_S)).result
        except Malformed as error:
            raise NoAnswer.of(503, str(error)) from None
        assert isinstance(copy, RatSlam)
        try:
            return await asyncio.to_thread(lambda: packed(encode(copy)))
        except ValueError as error:
            raise NoAnswer.of(507, f"this brain cannot be sent: {error}") from None


class _Sent(Response):
    def __init__(self, download: BrainDownload, data: bytes, headers: dict[str, str]) -> None:
        super().__init__(data, 200, headers, "application/octet-stream")
        self._download = download

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            async with asyncio.timeout(SENT_WITHIN_S):
                await super().__call__(scope, receive, send)
        finally:
            self._download.done()
