"""Brains that outlive their run: as a file that a person keeps (what `--save-brain` writes and `--brain` reads, and what the page
downloads); and what an earlier run of the program left, offered to whoever opens the page: a run that was cut off goes on, or a
brain is woken up, or it is put aside for good."""

from __future__ import annotations

import asyncio
import io
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from fastapi import FastAPI, Request
from pydantic import BaseModel
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from disk import State, encode, write_state
from ratslam_core import RatSlam
from ratslam_core.brain_file import read_brain
from sim2d import World, load_world
from web.http.asking import ERRORS, Body, NoAnswer, Submit, ask_engine, checked_body, json_response, takes
from web.http.commands import Malformed, wrong
from web.http.security import Limits
from web.http.state import to_json
from web.latest import Latest
from web.messages import GoOn, ReadBrain, ReadFiled, Snapshot, UseBrain

# ------------------------------------------------------------ as a file

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
            copy = (await ask_engine(self._submit, ReadBrain(), COPY_TIMEOUT_S)).result
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


# ------------------------------------------------------------ of an earlier run

LOOK_S = 0.3  # between two looks whether anybody still waits
WAKE_TIMEOUT_S = 60.0  # in a world of 10,000 walls


@dataclass(frozen=True, slots=True)
class Offered:
    """What the kept brain is of. `read` gives the brain; its ValueError names the file. It waits for the disk.

    run: id of a run that was cut off; `go_on` runs it again to where it was, which may take a minute. It tells the share
    that is done, and gives up when it is raised at.
    """

    world: str
    seed: int
    time_s: float  # simulated
    experiences: int
    kept_at: float  # seconds since 1970
    read: Callable[[], RatSlam] | None = None
    run: str | None = None
    go_on: Callable[[Callable[[float], object]], GoOn] | None = None


class GivenUpError(Exception):
    """Nobody waits for the run any more."""


class AnswerOffer(Body):
    """`use`: begin anew with this brain, in its world and with its seed. Otherwise it is not offered again."""

    use: bool


class KeptBrain(BaseModel):
    """A brain that an earlier program kept. run: id of the run that can go on, with its brain; null for a brain alone."""

    world: str
    title: str
    seed: int
    time_s: float
    experiences: int
    kept_at: float
    run: str | None


class Answered(BaseModel):
    used: bool


class KeptOffer:
    """One brain, or none. Whoever answers first answers for all."""

    def __init__(self, offered: Offered | None, latest: Latest[Snapshot], submit: Submit) -> None:
        self._offered, self._latest, self._submit = offered, latest, submit
        self._limits, self._answering = Limits(), asyncio.Lock()
        self.done: float | None = None  # the share of a run that has been run again

    def to_json(self) -> bytes:
        """The description of the kept brain as JSON, or null."""
        kept = self._offered
        if kept is None:
            return b"null"
        _, snapshot = self._latest.get()
        title = dict(snapshot.worlds if snapshot is not None else ()).get(kept.world, kept.world)
        return to_json(KeptBrain(
            world=kept.world, title=title, seed=kept.seed, time_s=kept.time_s, experiences=kept.experiences,
            kept_at=kept.kept_at, run=kept.run,
        ).model_dump())  # fmt: skip

    async def take(self, request: Request) -> bytes:
        use = (await checked_body(request, AnswerOffer, self._limits)).use
        async with self._answering:
            if self._offered is None:
                raise Malformed([wrong("use", use, "no brain is offered, or somebody has answered already")])
            if use:
                await self._wake(self._offered, request)
            self._offered = None
        return to_json({"used": use})

    async def _wake(self, kept: Offered, request: Request) -> None:
        """Begin a new run with the brain, or go on with the run. Raises Malformed, and leaves everything as it was, when
        that fails."""
        if kept.go_on is not None:
            await self._go_on(kept.go_on, request)
            return
        assert kept.read is not None
        world = (await ask_engine(self._submit, ReadFiled(kept.world))).result
        try:
            if not isinstance(world, World):
                world = await asyncio.to_thread(load_world, kept.world)
            brain = await asyncio.to_thread(kept.read)
        except ValueError as error:
            raise Malformed([wrong("use", True, f"this brain cannot be woken up: {error}")]) from None
        await ask_engine(self._submit, UseBrain(brain, world, kept.seed), WAKE_TIMEOUT_S)

    async def _go_on(self, go_on: Callable[[Callable[[float], object]], GoOn], request: Request) -> None:
        """Run it again to where it was, in a thread; give it up when the page that asked has gone or cancelled."""
        gone = threading.Event()

        def report(share: float) -> None:
            self.done = share
            if gone.is_set():
                raise GivenUpError

        self.done = 0.0
        running = asyncio.create_task(asyncio.to_thread(go_on, report))
        try:
            while not (await asyncio.wait({running}, timeout=LOOK_S))[0]:
                if await request.is_disconnected():
                    gone.set()
            there = running.result()
        except GivenUpError:
            raise NoAnswer.of(503, "nobody waits for this run any more") from None
        except ValueError as error:
            raise Malformed([wrong("use", True, f"this run cannot go on: {error}")]) from None
        finally:
            gone.set()
            self.done = None
        await ask_engine(self._submit, there, WAKE_TIMEOUT_S)


def add_kept_offer(app: FastAPI, offered: Offered | None, latest: Latest[Snapshot], submit: Submit) -> None:
    offer = KeptOffer(offered, latest, submit)

    @app.get("/api/brain/kept", tags=["brain"], responses={200: {"model": KeptBrain | None}})
    async def kept() -> Response:
        """The run that was cut off, or the brain that was kept last; null when there is none or somebody has answered."""
        return json_response(offer.to_json())

    @app.get("/api/brain/kept/done", tags=["brain"], responses={200: {"model": float | None}})
    async def done() -> Response:
        """The share, 0 to 1, of the run that has been run again; null when nobody has asked for it."""
        return json_response(to_json(offer.done))

    @app.post("/api/brain/kept", tags=["brain"], openapi_extra=takes(AnswerOffer),
              responses={200: {"model": Answered}, **ERRORS})  # fmt: skip
    async def answer(request: Request) -> Response:
        """Go on with the run, or begin anew with the kept brain in its world and seed; or never offer it again."""
        return json_response(await offer.take(request))
