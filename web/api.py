"""The one port's routes: the page, the state, commands, the page's stream, and the way to viser."""

from __future__ import annotations

import asyncio
import pathlib
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI, Path, Query, Request, WebSocket
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, RedirectResponse, Response
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp

from ratslam_core.brain_snapshot import BrainSnapshot
from web.brain_files import packed, unpacked
from web.commands import READER, CommandAccepted, Malformed, Problem, check, problem, problem_of, read_object, wrong
from web.latest import Latest
from web.messages import Accepted, ExperienceReport, ReadBrain, ReadExperience, Refused, Snapshot, UseBrain
from web.proxy import PAGE_ID, Cameras, StageLike, ViserProxy
from web.security import MAX_BODY_BYTES, MAX_BRAIN_BYTES, Guard, Limits
from web.state import experience_fields, to_json
from web.stream import NoAnswer, Stream, Submit, ask
from web.worlds import add_worlds

STATIC = pathlib.Path(__file__).parent / "static"
_REF = "#/components/schemas/{model}"
_ERRORS: dict[int | str, dict[str, Any]] = {
    403: {"model": Problem, "description": "Not our Host or Origin"},
    413: {"model": Problem, "description": "More than 64 KiB"},
    415: {"model": Problem, "description": "Not JSON"},
    422: {"model": Problem, "description": "Malformed, or refused by the engine: field, value and what would be right"},
    429: {"model": Problem, "description": "More than 60 drive or 10 other commands a second"},
    503: {"model": Problem, "description": "The engine did not answer within 3 s"},
}


def create_app(latest: Latest[Snapshot], submit: Submit, stage: StageLike, port: int) -> ASGIApp:
    """The whole application behind its guard. `port` is the one that Host and Origin must name."""
    cameras = Cameras(stage)
    stream = Stream(latest, submit, stage, cameras)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        cameras.listen()
        publishing = asyncio.create_task(stream.publish())
        yield
        publishing.cancel()

    app = FastAPI(
        title="RatSLAM",
        summary="A robot in a simulated office, its brain, and the commands that steer it.",
        version="1",
        lifespan=lifespan,
        docs_url=None,  # FastAPI's pages load scripts from elsewhere; ours is static/docs.html
        redoc_url=None,
        redirect_slashes=False,
    )
    _add_state(app, latest, stream)
    _add_experience(app, submit)
    _add_brain(app, latest, submit)
    _add_commands(app, submit)
    add_worlds(app, latest, submit)
    _add_stream(app, stream)
    _add_viser(app, ViserProxy(stage, cameras))
    _add_pages(app)
    _add_errors(app)
    return Guard(app, port)


def _add_state(app: FastAPI, latest: Latest[Snapshot], stream: Stream) -> None:
    @app.get("/healthz", tags=["state"])
    def healthz() -> Response:
        """Alive, and at which tick."""
        _, snapshot = latest.get()
        return _json(to_json({"status": "ok", "tick": None if snapshot is None else snapshot.tick}))

    @app.get("/api/state", tags=["state"], responses={422: {"model": Problem}, 503: {"model": Problem}})
    async def state(
        full: int = Query(0, alias="map", ge=0, le=1, description="1: with the map's nodes, `ids` and `xy`"),
    ) -> Response:
        """The newest snapshot. SI and radians; numbers that are not finite are null; speed 0 = as fast as possible."""
        _, snapshot = latest.get()
        if snapshot is None:
            return _json(problem("the engine has not finished its first tick yet; try again in a moment"), 503)
        return _json(stream.text.full(snapshot) if full else stream.text.light(snapshot))


def _add_experience(app: FastAPI, submit: Submit) -> None:
    limits = Limits()
    route: dict[str, Any] = {"responses": {status: _ERRORS[status] for status in (422, 429, 503)}}

    @app.get("/api/experience/{number}", tags=["state"], **route)
    async def experience(number: int = Path(ge=0, description="its number in the map")) -> Response:
        """One experience: pose-cell state, place in the map, stored view, energy now, links, Hebbian links of its view."""
        refusal = limits.refusal("experience")
        if refusal is not None:
            return _json(problem(refusal), 429)
        try:
            answer = await ask(submit, ReadExperience(number))
        except NoAnswer as error:
            return _json(problem(str(error)), error.status)
        if isinstance(answer, Refused):
            return _json(to_json({"detail": problem_of(answer)}), 422)
        assert isinstance(answer.result, ExperienceReport)
        return _json(to_json(experience_fields(answer.result)))


def _add_brain(app: FastAPI, latest: Latest[Snapshot], submit: Submit) -> None:
    limits = Limits()
    binary: dict[str, Any] = {
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}
    }

    @app.get("/api/brain", tags=["brain"], responses={200: binary, 429: _ERRORS[429], 503: _ERRORS[503]})
    async def save() -> Response:
        """The whole brain as one file, as `--save-brain` writes it."""
        refusal = limits.refusal("brain")
        if refusal is not None:
            return _json(problem(refusal), 429)
        try:
            answer = await ask(submit, ReadBrain())
        except NoAnswer as error:
            return _json(problem(str(error)), error.status)
        assert isinstance(answer, Accepted)
        assert isinstance(answer.result, BrainSnapshot)
        data = await asyncio.to_thread(packed, answer.result)
        _, snapshot = latest.get()
        world = "" if snapshot is None else f"-{re.sub(r'[^A-Za-z0-9]+', '-', snapshot.world.name)}-seed{snapshot.seed}"
        headers = {"Cache-Control": "no-store", "Content-Disposition": f'attachment; filename="brain{world}.npz"'}
        return Response(data, 200, headers, "application/octet-stream")

    body = {"required": True} | binary

    @app.post("/api/brain", tags=["brain"], openapi_extra={"requestBody": body}, responses=_ERRORS)
    async def use(request: Request) -> Response:
        """Start anew in the same world with a saved brain. What is no brain is refused, and the session goes on."""
        refusal = limits.refusal("brain")
        if refusal is not None:
            return _json(problem(refusal), 429)
        raw = await _body(request, MAX_BRAIN_BYTES)
        if raw is None:
            return _json(problem(f"a brain may have at most {MAX_BRAIN_BYTES} bytes"), 413)
        try:
            brain = await asyncio.to_thread(unpacked, raw)
            answer = await ask(submit, UseBrain(brain))
        except ValueError as error:
            return _json(to_json({"detail": [wrong("brain", None, f"this file is {error}")]}), 422)
        except NoAnswer as error:
            return _json(problem(str(error)), error.status)
        if isinstance(answer, Refused):
            return _json(to_json({"detail": problem_of(answer)}), 422)
        return _json(to_json({"accepted": True, "tick": answer.tick}))


def _add_commands(app: FastAPI, submit: Submit) -> None:
    limits = Limits()
    schema = READER.json_schema(ref_template=_REF)
    definitions = schema.pop("$defs")
    body = {"required": True, "content": {"application/json": {"schema": schema}}}
    route: dict[str, Any] = {"responses": {200: {"model": CommandAccepted}, **_ERRORS}}

    @app.post("/api/commands", tags=["commands"], openapi_extra={"requestBody": body}, **route)
    async def command(request: Request) -> Response:
        """One command. The answer comes when the engine has taken or refused it; nothing is half done."""
        raw = await _body(request)
        if raw is None:
            return _json(problem(f"a body may have at most {MAX_BODY_BYTES} bytes"), 413)
        try:
            document = read_object(raw)
            refusal = limits.refusal(str(document.get("type")))
            if refusal is not None:
                return _json(problem(refusal), 429)
            answer = await ask(submit, check(document))
        except Malformed as error:
            return _json(to_json({"detail": error.wrongs}), 422)
        except NoAnswer as error:
            return _json(problem(str(error)), error.status)
        if isinstance(answer, Refused):
            return _json(to_json({"detail": problem_of(answer)}), 422)
        return _json(to_json({"accepted": True, "tick": answer.tick}))

    plain = app.openapi

    def openapi() -> dict[str, Any]:
        document = plain()
        document["components"]["schemas"].update(definitions)
        return document

    app.openapi = openapi  # type: ignore[method-assign]


def _add_stream(app: FastAPI, stream: Stream) -> None:
    @app.websocket("/api/stream")
    async def api_stream(socket: WebSocket, page: str = "", got: bool = False) -> None:
        if page and not PAGE_ID.fullmatch(page):
            await _deny(socket, 422, "page must be 22 to 64 letters, digits, - or _")
        elif stream.full:
            await _deny(socket, 503, "32 pages are open already; close one")
        else:
            await stream.serve(socket, page, got)


def _add_viser(app: FastAPI, proxy: ViserProxy) -> None:
    @app.get("/viser/", include_in_schema=False)
    async def viser_page(request: Request) -> Response:
        return await proxy.page(request)

    @app.websocket("/viser/ws/{page}")
    async def viser_socket(socket: WebSocket, page: str) -> None:
        if not PAGE_ID.fullmatch(page):
            await _deny(socket, 404, "there is no such page")
        elif proxy.full:
            await _deny(socket, 503, "32 stages are open already; close one")
        else:
            await proxy.relay(socket, page)


def _add_pages(app: FastAPI) -> None:
    @app.get("/", include_in_schema=False)
    def index() -> Response:
        return FileResponse(STATIC / "index.html", headers={"Cache-Control": "no-cache"})

    @app.get("/docs", include_in_schema=False)
    def docs() -> Response:
        return FileResponse(STATIC / "docs.html", headers={"Cache-Control": "no-cache"})

    @app.get("/favicon.ico", include_in_schema=False)
    def favicon() -> Response:
        return RedirectResponse("/static/icon.svg")

    app.mount("/static", StaticFiles(directory=STATIC), name="static")


def _add_errors(app: FastAPI) -> None:
    @app.exception_handler(HTTPException)
    async def http_error(request: Request, error: HTTPException) -> Response:
        sentence = {404: f"there is nothing at {request.url.path[:80]}", 405: f"{request.method} is not allowed here"}
        return _json(problem(sentence.get(error.status_code, str(error.detail))), error.status_code, error.headers)

    @app.exception_handler(RequestValidationError)
    async def bad_query(_: Request, error: RequestValidationError) -> Response:
        wrongs = [{"field": e["loc"][-1], "value": str(e["input"])[:80], "reason": e["msg"]} for e in error.errors()]
        return _json(to_json({"detail": wrongs}), 422)


async def _body(request: Request, most: int = MAX_BODY_BYTES) -> bytes | None:
    """The body, or None when it is too long; never more than the limit is kept."""
    parts = bytearray()
    async for part in request.stream():
        parts += part
        if len(parts) > most:
            return None
    return bytes(parts)


async def _deny(socket: WebSocket, status: int, reason: str) -> None:
    await socket.send_denial_response(_json(problem(reason), status))


def _json(body: bytes, status: int = 200, headers: Any = None) -> Response:
    return Response(body, status, {"Cache-Control": "no-store", **(headers or {})}, "application/json")
