"""The moment that is shown, as a link, a file and lines of Python; and opening what somebody else has made of a moment."""

from __future__ import annotations

import asyncio
from typing import Annotated, Protocol

from fastapi import FastAPI, Request
from fastapi.responses import Response
from pydantic import BaseModel, Field, ValidationError

from web.http.asking import ERRORS, Body, Submit, ask_engine, body_of, checked_body, json_response, takes
from web.http.commands import Malformed, wrong
from web.http.proxy import Cameras
from web.http.security import MAX_SITUATION_BYTES, Limits
from web.http.state import to_json
from web.messages import CameraAt, Look, OpenSituation, ReadSituation
from web.messages.commands import Label
from web.messages.situation import Plate

READ_TIMEOUT_S = 20.0  # the engine makes a hash of its whole state
OPEN_TIMEOUT_S = 60.0  # in a world of 10,000 walls


class AskMoment(Body):
    """What the page shows, to be shown again. page: the page's own id, whose camera is looked up."""

    plate: Plate = "all"
    tab: Annotated[Label, Field(max_length=20)] | None = None
    page: Label = ""


class OpenMoment(Body):
    """text: a link (a whole address, or its end from `run=` on), or the text of a situation's file."""

    text: Annotated[str, Field(min_length=1)]


class Made(BaseModel):
    """A moment. link: the end of an address, without #; null when `why` says that it fits into none. name: of the file."""

    link: str | None
    why: str
    name: str
    file: str
    python: str
    tick: int
    time_s: float
    state_hash: str
    orders: int


class Opened(BaseModel):
    """The run that plays up to the moment; `/api/stream` tells how far it is."""

    tick: int
    state_hash: str
    look: Look


class HasMoment(Protocol):
    """A situation, of the program's own class."""

    @property
    def tick(self) -> int: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def look(self) -> Look: ...


class Situations(Protocol):
    """The program's side. Both take a while."""

    def made(self, spec: object, look: Look) -> Made: ...
    def read(self, text: str) -> HasMoment: ...


def add_situations(app: FastAPI, situations: Situations | None, cameras: Cameras, submit: Submit) -> None:
    """Without `situations` there are no such routes."""
    if situations is None:
        return
    limits, one_at_a_time = Limits(), asyncio.Lock()

    @app.post("/api/situation", tags=["situation"], openapi_extra=takes(AskMoment),
              responses={200: {"model": Made}, **ERRORS})  # fmt: skip
    async def make(request: Request) -> Response:
        """The moment that is shown, as a link, as the text of a file, and as lines of Python."""
        asked = await checked_body(request, AskMoment, limits)
        look = Look(plate=asked.plate, tab=asked.tab, camera=_camera_of(cameras, asked.page))
        async with one_at_a_time:
            spec = (await ask_engine(submit, ReadSituation(), READ_TIMEOUT_S)).result
            try:
                made = await asyncio.to_thread(situations.made, spec, look)
            except OSError as error:
                reason = f"the brain that the run began with cannot be read: {error.strerror or error}"
                raise Malformed([wrong(None, None, reason)]) from None
            except ValueError as error:
                raise Malformed([wrong(None, None, str(error))]) from None
        return json_response(to_json(made.model_dump()))

    @app.post("/api/situation/open", tags=["situation"], openapi_extra=takes(OpenMoment),
              responses={200: {"model": Opened}, **ERRORS})  # fmt: skip
    async def open_(request: Request) -> Response:
        """Begin a run that plays, as fast as it can, up to the moment. What is wrong is refused, and the run of now goes on."""
        limits.pass_on("situation")
        text = _text_in(await body_of(request, MAX_SITUATION_BYTES))
        async with one_at_a_time:
            try:
                situation = await asyncio.to_thread(situations.read, text)
            except ValueError as error:
                raise Malformed([wrong("text", text[:40], str(error))]) from None
            await ask_engine(submit, OpenSituation(situation), OPEN_TIMEOUT_S)
        opened = Opened(tick=situation.tick, state_hash=situation.state_hash, look=situation.look)
        return json_response(to_json(opened.model_dump()))


def _text_in(raw: bytes) -> str:
    """A long run has more orders than any command may have parts, so the text is checked by who reads it."""
    try:
        return OpenMoment.model_validate_json(raw).text
    except ValidationError as error:
        reason = f"this takes text, a link or the text of a situation's file: {error.errors()[0]['msg']}"
        raise Malformed([wrong("text", None, reason)]) from None


def _camera_of(cameras: Cameras, page: str) -> CameraAt | None:
    """Where somebody has turned the camera of this page."""
    camera = cameras.turned(page)
    if camera is None:
        return None
    position, look_at = camera.position.tolist(), camera.look_at.tolist()
    return CameraAt.model_validate({"position": position, "look_at": look_at, "fov_rad": float(camera.fov_rad)})
