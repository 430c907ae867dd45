"""The world as a file: read it, download it, save it in a folder of one's own, and open what somebody drops on the page.

Importing runs in a thread of its own, one at a time; the engine only hears of worlds that are sound.
"""

from __future__ import annotations

import asyncio
import base64
import binascii
import os
from dataclasses import replace
from typing import Annotated, Any

import orjson
from fastapi import FastAPI, Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim2d import World, WorldError, own_worlds, world_names, world_to_json
from sim2d.importers import import_world
from web.commands import Malformed, Problem, problem, problem_of, read_object, wrong
from web.latest import Latest
from web.messages import OfficeEdition, OpenWorld, ReadWorld, Refused, Snapshot, WorldSaved
from web.security import MAX_BODY_BYTES, MAX_PLAN_BYTES, PLAN_PATH, Limits
from web.state import office_fields, to_json
from web.stream import NoAnswer, Submit, ask

OPEN_TIMEOUT_S = 30.0  # a world of 10,000 walls is painted in seconds
_Name = Annotated[str, Field(min_length=1, max_length=200)]
_ERRORS: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (413, 422, 429, 503)}


class _Body(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class UploadedFile(_Body):
    name: _Name
    data: str  # base64


class OpenFiles(_Body):
    """Files that belong together: a world or a vector map (.json), a picture, or a map_server .yaml with its picture."""

    files: Annotated[list[UploadedFile], Field(min_length=1, max_length=4)]
    scale_m: float | None = None  # metres a pixel, for a plain picture
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0  # of the looks that bare walls get


class SaveWorld(_Body):
    name: _Name
    title: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    replace: bool = False  # another world of this name that has been saved before


class Opened(BaseModel):
    """The session begins anew in it."""

    name: str
    title: str
    walls: int
    starts: int
    size_m: list[float]


class Saved(BaseModel):
    name: str
    file: str


def add_worlds(app: FastAPI, latest: Latest[Snapshot], submit: Submit) -> None:
    limits, importing = Limits(), asyncio.Lock()

    @app.get("/api/world", tags=["worlds"], responses={503: {"model": Problem}})
    async def world() -> Response:
        """The office as it is now, as a world file, and which edition of it that is."""
        return await _answered(_read(submit))

    @app.get("/api/world/file", tags=["worlds"], responses={503: {"model": Problem}})
    async def world_file() -> Response:
        """The same as a file to keep."""
        try:
            now, _ = await _world(submit)
        except NoAnswer as error:
            return _json(problem(str(error)), error.status)
        text = await asyncio.to_thread(world_to_json, now)
        safe = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "-" for c in now.name)
        headers = {"Content-Disposition": f'attachment; filename="{safe}.json"', "Cache-Control": "no-store"}
        return Response(text, headers=headers, media_type="application/json")

    @app.post(PLAN_PATH, tags=["worlds"], openapi_extra=_takes(OpenFiles),
              responses={200: {"model": Opened}, **_ERRORS})  # fmt: skip
    async def open_files(request: Request) -> Response:
        """Begin anew in a world or plan. When it cannot be, the session stays as it was."""
        if importing.locked():
            return _json(problem("another plan is being imported; wait until it is there"), 429)
        async with importing:
            return await _answered(_open(request, latest, submit, limits))

    @app.post("/api/worlds/save", tags=["worlds"], openapi_extra=_takes(SaveWorld),
              responses={200: {"model": Saved}, **_ERRORS})  # fmt: skip
    async def save(request: Request) -> Response:
        """Write the office as it is now into the folder of one's own worlds; it bears this name from then on."""
        return await _answered(_save(request, submit, limits))


async def _answered(work: Any) -> Response:
    try:
        return _json(await work)
    except Malformed as error:
        return _json(to_json({"detail": error.wrongs}), 422)
    except _TooMuch as error:
        return _json(problem(str(error)), error.status)
    except NoAnswer as error:
        return _json(problem(str(error)), error.status)


class _TooMuch(Exception):  # noqa: N818
    def __init__(self, status: int, reason: str) -> None:
        super().__init__(reason)
        self.status = status


async def _read(submit: Submit) -> bytes:
    now, edition = await _world(submit)
    text = await asyncio.to_thread(world_to_json, now)
    head = to_json({**office_fields(edition), "yours": dict(own_worlds.names()), "ours": dict(world_names())})
    return head[:-1] + b',"world":' + text.encode() + b"}"


async def _open(request: Request, latest: Latest[Snapshot], submit: Submit, limits: Limits) -> bytes:
    wish = await _wish(request, OpenFiles, limits, MAX_PLAN_BYTES)
    files = {_plain(file.name): _bytes(file) for file in wish.files}
    _, snapshot = latest.get()
    radius = None if snapshot is None else snapshot.world.robot_radius_m
    try:
        world = await asyncio.to_thread(import_world, _main(files), files, wish.scale_m, wish.seed, radius)
    except WorldError as error:
        raise Malformed([wrong("files", list(files), str(error))]) from None
    answer = await ask(submit, OpenWorld(world), OPEN_TIMEOUT_S)
    if isinstance(answer, Refused):
        raise Malformed(problem_of(answer))
    x0, y0, x1, y1 = world.bounds
    size = [round(x1 - x0, 3), round(y1 - y0, 3)]
    told = {"name": answer.result, "title": world.title, "walls": len(world.walls), "starts": len(world.starts)}
    return to_json({**told, "size_m": size})


async def _save(request: Request, submit: Submit, limits: Limits) -> bytes:
    wish = await _wish(request, SaveWorld, limits, MAX_BODY_BYTES)
    if wish.name in dict(world_names()):
        reason = f"{wish.name} comes with the program and stays as it is; choose another name"
        raise Malformed([wrong("name", wish.name, reason)])
    was, _ = await _world(submit)
    if wish.name != was.name and not wish.replace and wish.name in dict(own_worlds.names()):
        reason = f"there is a world {wish.name!r} already; replace it or choose another name"
        raise Malformed([wrong("replace", False, reason)])
    title = wish.title or (was.title if wish.name == was.name else wish.name)
    named = replace(was, name=wish.name, title=title)
    try:
        text = await asyncio.to_thread(world_to_json, named)
        path = await asyncio.to_thread(own_worlds.save, wish.name, text)
    except ValueError as error:
        raise Malformed([wrong("name", wish.name, str(error))]) from None
    answer = await ask(submit, WorldSaved(was, named))
    if isinstance(answer, Refused):
        raise Malformed(problem_of(answer))
    return to_json({"name": wish.name, "file": str(path)})


async def _world(submit: Submit) -> tuple[World, OfficeEdition]:
    answer = await ask(submit, ReadWorld())
    assert not isinstance(answer, Refused)
    assert isinstance(answer.result, tuple)
    return answer.result


async def _wish(request: Request, model: Any, limits: Limits, most: int) -> Any:
    raw = bytearray()
    async for part in request.stream():
        raw += part
        if len(raw) > most:
            raise _TooMuch(413, f"a body may have at most {most} bytes")
    refusal = limits.refusal("world")
    if refusal is not None:
        raise _TooMuch(429, refusal)
    try:
        return model.model_validate(read_object(bytes(raw)))
    except ValidationError as error:
        item = error.errors(include_url=False)[0]
        path = ".".join(map(str, item["loc"]))
        reason = f"{path}: {item['msg'][0].lower()}{item['msg'][1:]}; it takes {', '.join(model.model_fields)}"
        raise Malformed([wrong(path, None if item["type"] == "missing" else item["input"], reason)]) from None


def _plain(name: str) -> str:
    """The name alone of what a browser calls a file."""
    return os.path.basename(name.replace("\\", "/")) or name


def _bytes(file: UploadedFile) -> bytes:
    try:
        return base64.b64decode(file.data, validate=True)
    except (binascii.Error, ValueError) as error:
        raise Malformed([wrong("files", file.name, f"{file.name}: data must be base64: {error}")]) from None


def _main(files: dict[str, bytes]) -> str:
    """The file that refers to the others: the map_server one where there is one, else the only one."""
    yaml = [name for name in files if name.lower().endswith((".yaml", ".yml"))]
    if len(yaml) == 1:
        return yaml[0]
    if len(files) == 1:
        return next(iter(files))
    reason = (
        f"got {len(files)} files, {', '.join(files)}; drop one plan at a time: a .yaml with its picture, or one file"
    )
    raise Malformed([wrong("files", list(files), reason)])


def _takes(model: type[BaseModel]) -> dict[str, Any]:
    schema = model.model_json_schema()
    definitions = schema.pop("$defs", {})
    for part in definitions.values():  # inline: they are used once
        schema = orjson.loads(
            orjson.dumps(schema).replace(b'{"$ref":"#/$defs/%b"}' % part["title"].encode(), orjson.dumps(part))
        )
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema}}}}


def _json(body: bytes, status: int = 200) -> Response:
    return Response(body, status, {"Cache-Control": "no-store"}, "application/json")
