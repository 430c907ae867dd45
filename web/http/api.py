"""The one port's routes: the page, the state, commands, the page's stream, and the way to viser."""

from __future__ import annotations

import asyncio
import pathlib
import re
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI, Path, Query, Request, WebSocket
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from web.http.asking import Submit, ask_engine, body_of, json_response
from web.http.brains import BrainDownload, Offered, add_kept_offer, unpacked
from web.http.class_door import Classroom, add_classroom
from web.http.commands import READER, CommandAccepted, Declined, Malformed, Problem, check, problem, read_object, wrong
from web.http.export import Exports, add_exports
from web.http.gallery import Gallery, Lessons, add_experiments, add_lessons
from web.http.pictures import add_pictures, add_stage_picture
from web.http.proxy import PAGE_ID, Cameras, ViewersLike, ViserProxy, spoken
from web.http.recordings import Opener, add_recordings
from web.http.security import MAX_BRAIN_BYTES, NO, Guard, Limits, comes_from_class, looks_on
from web.http.situations import Situations, add_situations
from web.http.state import experience_fields, places_of, title, to_json
from web.http.stream import Stream
from web.http.worlds import add_worlds
from web.latest import Latest
from web.messages import ExperienceReport, ReadExperience, Snapshot, UseBrain
from web.themes import Themes

STATIC = pathlib.Path(__file__).parents[1] / "static"
_REF = "#/components/schemas/{model}"
_ERRORS: dict[int | str, dict[str, Any]] = {
    403: {"model": Problem, "description": "Not our Host or Origin"},
    413: {"model": Problem, "description": "More than 64 KiB"},
    415: {"model": Problem, "description": "Not JSON"},
    422: {"model": Problem, "description": "Malformed, or refused by the engine: field, value and what would be right"},
    429: {"model": Problem, "description": "More than 60 drive or 10 other commands a second"},
    503: {"model": Problem, "description": "The engine did not answer within 3 s"},
}


def create_app(
    latest: Latest[Snapshot], submit: Submit, viewers: ViewersLike, port: int, offered: Offered | None = None,
    experiments: Gallery | None = None, exports: Exports | None = None, opener: Opener | None = None,
    situations: Situations | None = None, lessons: Lessons | None = None, classroom: Classroom | None = None,
) -> Guard:  # fmt: skip
    """The whole application behind its guard.

    port: the one that Host and Origin must name. offered: a kept brain. experiments: those of the page's gallery.
    exports: the formats in which the run can be had. opener: opens recordings that are sent. situations: links to moments.
    lessons: those of the page. classroom: where a class finds its door, which has the same application behind it.
    """
    cameras, themes = Cameras(), Themes()
    stream = Stream(latest, submit, cameras, themes, viewers.switches)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncGenerator[None, None]:
        publishing = asyncio.create_task(stream.publish())
        yield
        publishing.cancel()
        if sent is not None:
            sent.forget()

    app = FastAPI(
        title="RatSLAM",
        summary="A robot in a simulated office, its brain, and the commands that steer it.",
        version="1",
        lifespan=lifespan,
        docs_url=None,  # FastAPI's pages load scripts from elsewhere; ours is static/docs/docs.html
        redoc_url=None,
        redirect_slashes=False,
    )
    _add_state(app, latest, stream)
    _add_experience(app, submit)
    _add_places(app, latest)
    _add_brain(app, latest, submit)
    add_kept_offer(app, offered, latest, submit)
    _add_commands(app, submit)
    add_worlds(app, latest, submit)
    add_experiments(app, experiments)
    add_lessons(app, lessons)
    add_classroom(app, classroom, submit)
    add_exports(app, exports, latest, submit)
    sent = add_recordings(app, opener, submit)
    add_situations(app, situations, cameras, submit)
    add_pictures(app, latest, viewers.switches)
    _add_stream(app, stream)
    _add_viser(app, ViserProxy(viewers, cameras, themes))
    add_stage_picture(app, latest, viewers.switches)
    _add_pages(app)
    _add_errors(app)
    return Guard(app, port)


def _add_state(app: FastAPI, latest: Latest[Snapshot], stream: Stream) -> None:
    @app.get("/healthz", tags=["state"])
    def healthz() -> Response:
        """Whether the engine is alive, and at which tick; 503 while it is starting, and what it is doing."""
        _, snapshot = latest.get()
        if snapshot is None:
            return json_response(to_json({"status": "starting", "doing": latest.waking, "tick": None}), 503)
        return json_response(to_json({"status": "ok", "tick": snapshot.tick}))

    @app.get("/api/state", tags=["state"], responses={422: {"model": Problem}, 503: {"model": Problem}})
    async def state(
        full: int = Query(0, alias="map", ge=0, le=1, description="1: with the map's nodes, `ids` and `xy`"),
    ) -> Response:
        """The newest snapshot. SI and radians; numbers that are not finite are null; speed 0 = as fast as possible."""
        _, snapshot = latest.get()
        if snapshot is None:
            words = f"the engine has not finished its first tick yet ({latest.waking}); try again in a moment"
            return json_response(problem(words), 503)
        return json_response(stream.text.full(snapshot) if full else stream.text.light(snapshot))


def _add_places(app: FastAPI, latest: Latest[Snapshot]) -> None:
    @app.get("/api/places", tags=["state"], responses={503: {"model": Problem}})
    async def places() -> Response:
        """What a goal can be: places with a name, those of the office, and all experiences. Map frame, metres; `seconds`:
        the quickest way from the robot to there (to the goal, while there is one), null: no way is known; `why`: why a
        place of the office cannot be one, null: it can."""
        _, snapshot = latest.get()
        if snapshot is None:
            return json_response(problem(f"the engine has not finished its first tick yet ({latest.waking})"), 503)
        return json_response(to_json(places_of(snapshot)))


def _add_experience(app: FastAPI, submit: Submit) -> None:
    limits = Limits()
    route: dict[str, Any] = {"responses": {status: _ERRORS[status] for status in (422, 429, 503)}}

    @app.get("/api/experience/{number}", tags=["state"], **route)
    async def experience(number: int = Path(ge=0, description="its number in the map")) -> Response:
        """One experience: pose-cell state, place in the map, stored view, energy now, links, Hebbian links of its view."""
        limits.pass_on("experience")
        report = (await ask_engine(submit, ReadExperience(number))).result
        assert isinstance(report, ExperienceReport)
        return json_response(to_json(experience_fields(report)))


def _add_brain(app: FastAPI, latest: Latest[Snapshot], submit: Submit) -> None:
    limits, download = Limits(), BrainDownload(submit)
    too_large = {"model": Problem, "description": "Too large for a file"}
    binary: dict[str, Any] = {
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}
    }

    @app.get(
        "/api/brain",
        tags=["brain"],
        responses={200: binary, 403: _ERRORS[403], 429: _ERRORS[429], 503: _ERRORS[503], 507: too_large},
    )
    async def save() -> Response:
        """The whole brain as one file, as `--save-brain` writes it. Requests while it is made or sent get the same file."""
        limits.pass_on("brain")
        _, snapshot = latest.get()
        world = "" if snapshot is None else f"-{re.sub(r'[^A-Za-z0-9]+', '-', _name(snapshot))}-seed{snapshot.seed}"
        headers = {"Cache-Control": "no-store", "Content-Disposition": f'attachment; filename="brain{world}.npz"'}
        return await download.answer(headers)

    body = {"required": True} | binary

    @app.post("/api/brain", tags=["brain"], openapi_extra={"requestBody": body}, responses=_ERRORS)
    async def use(request: Request) -> Response:
        """Start anew in the same world with a saved brain. A file that is no brain is refused, and the session goes on."""
        limits.pass_on("brain")
        raw = await body_of(request, MAX_BRAIN_BYTES)
        try:
            brain = await asyncio.to_thread(unpacked, raw)
        except ValueError as error:
            raise Malformed([wrong("brain", None, f"this file is {error}")]) from None
        answer = await ask_engine(submit, UseBrain(brain))
        return json_response(to_json({"accepted": True, "tick": answer.tick}))


def _name(snapshot: Snapshot) -> str:
    """Of the world or the recording."""
    return title(snapshot) if snapshot.recording is not None or snapshot.world is None else snapshot.world.name


def _add_commands(app: FastAPI, submit: Submit) -> None:
    limits = Limits()
    schema = READER.json_schema(ref_template=_REF)
    definitions = schema.pop("$defs")
    body = {"required": True, "content": {"application/json": {"schema": schema}}}
    route: dict[str, Any] = {"responses": {200: {"model": CommandAccepted}, **_ERRORS}}

    @app.post("/api/commands", tags=["commands"], openapi_extra={"requestBody": body}, **route)
    async def command(request: Request) -> Response:
        """One command. The answer comes when the engine has taken or refused it. A command is carried out wholly or not."""
        document = read_object(await body_of(request))
        limits.pass_on(str(document.get("type")))
        answer = await ask_engine(submit, check(document))
        return json_response(to_json({"accepted": True, "tick": answer.tick}))

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
        elif comes_from_class(socket) and not looks_on(page):
            await _deny(socket, 403, NO)
        elif stream.full:
            await _deny(socket, 503, "32 pages are open already; close one")
        else:
            await stream.serve(socket, page, got, looks_on(page))


def _add_viser(app: FastAPI, proxy: ViserProxy) -> None:
    @app.get("/viser/", include_in_schema=False)
    async def viser_page(request: Request) -> Response:
        return await proxy.page(request)

    @app.websocket("/viser/ws/{page}")
    async def viser_socket(socket: WebSocket, page: str) -> None:
        if not PAGE_ID.fullmatch(page):
            await _deny(socket, 404, "there is no such page")
        elif comes_from_class(socket) and not looks_on(page):
            await _deny(socket, 403, NO)
        elif not spoken(socket):
            await _deny(
                socket, 400, "this websocket needs viser's subprotocol: viser-v and the version, as viser-v1.1.1"
            )
        elif proxy.full:
            await _deny(socket, 503, "32 viewers are open already; close one")
        else:
            await proxy.relay(socket, page, looks_on(page))


def _add_pages(app: FastAPI) -> None:
    @app.get("/", include_in_schema=False)
    def index(request: Request) -> Response:
        """The page; `/?watch`: the same, only to look at; `/?vote`: only the question of a lesson, for a class."""
        headers, asked = {"Cache-Control": "no-cache"}, request.query_params
        if "vote" in asked or (comes_from_class(request) and "watch" not in asked):
            return FileResponse(STATIC / "lessons" / "vote.html", headers=headers)
        if "watch" in asked:
            text = (STATIC / "index.html").read_text(encoding="utf-8")
            return HTMLResponse(text.replace("<body>", '<body data-watch="true">', 1), headers=headers)
        return FileResponse(STATIC / "index.html", headers=headers)

    @app.get("/docs", include_in_schema=False)
    def docs() -> Response:
        return FileResponse(STATIC / "docs" / "docs.html", headers={"Cache-Control": "no-cache"})

    @app.get("/favicon.ico", include_in_schema=False)
    def favicon() -> Response:
        return RedirectResponse("/static/icon.svg")

    @app.websocket("/{path:path}")
    async def nothing(socket: WebSocket, path: str) -> None:
        await _deny(socket, 404, f"there is no websocket at /{path[:80]}")

    app.mount("/static", StaticFiles(directory=STATIC), name="static")


def _add_errors(app: FastAPI) -> None:
    @app.exception_handler(HTTPException)
    async def http_error(request: Request, error: HTTPException) -> Response:
        sentence = {404: f"there is nothing at {request.url.path[:80]}", 405: f"{request.method} is not allowed here"}
        return json_response(
            problem(sentence.get(error.status_code, str(error.detail))), error.status_code, error.headers
        )

    @app.exception_handler(ClientDisconnect)
    async def gone(_request: Request, _error: ClientDisconnect) -> Response:
        """Somebody went before all of the request was sent: nobody reads this, and it is nobody's fault."""
        return Response(status_code=400)

    @app.exception_handler(Declined)
    async def declined(_: Request, error: Declined) -> Response:
        return json_response(to_json({"detail": error.wrongs}), error.status)

    @app.exception_handler(RequestValidationError)
    async def bad_query(_: Request, error: RequestValidationError) -> Response:
        wrongs = [{"field": e["loc"][-1], "value": str(e["input"])[:80], "reason": e["msg"]} for e in error.errors()]
        return json_response(to_json({"detail": wrongs}), 422)


async def _deny(socket: WebSocket, status: int, reason: str) -> None:
    await socket.send_denial_response(json_response(problem(reason), status))
