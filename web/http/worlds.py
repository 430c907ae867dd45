"""The world as a file: read it, download it, open a file dropped on the page, begin an empty one; and a person's own worlds, in
a folder of theirs: listed, saved, renamed, deleted and brought back. Names are ids, not paths.

Imports run in a thread of their own, one at a time. The engine is given only worlds that have been checked.
"""

from __future__ import annotations

import asyncio
import base64
import binascii
import os
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, TypeVar

from fastapi import FastAPI, Request
from fastapi.responses import Response
from pydantic import BaseModel, Field

from sim2d import World, WorldError, WorldText, own_worlds, world_names, world_to_json
from sim2d.importers import import_world
from sim2d.importers.plan import empty_room
from sim2d.world.world_file import holds
from web.http.asking import ERRORS, Body, Name, Submit, Title, ask_engine, checked_body, json_response, takes, world_now
from web.http.commands import Declined, Malformed, Problem, wrong
from web.http.security import MAX_PLAN_BYTES, PLAN_PATH, Limits
from web.http.state import office_fields, to_json
from web.latest import Latest
from web.messages import OpenWorld, ReadFiled, Snapshot, WorldDeleted, WorldRestored, WorldSaved

_T = TypeVar("_T")
OPEN_TIMEOUT_S = 30.0  # painting a world of 10,000 walls takes seconds


class UploadedFile(Body):
    name: Name
    data: str  # base64


class OpenFiles(Body):
    """Files that belong together: a world or a vector map (.json), a picture, or a map_server .yaml with its picture."""

    files: Annotated[list[UploadedFile], Field(min_length=1, max_length=4)]
    scale_m: float | None = None  # metres per pixel, for a plain picture
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0  # for the looks that bare walls get


class NewWorld(Body):
    """An empty room, from (0, 0) to (width, depth) metres."""

    name: Name
    title: Title | None = None
    width_m: float
    depth_m: float


class Opened(BaseModel):
    """The world in which the session begins anew."""

    name: str
    title: str
    walls: int
    starts: int
    size_m: list[float]
    said: list[str]  # sentences: what of a plan is not used, or taken in another way than it is written


class SaveWorld(Body):
    name: Name
    title: Title | None = None
    replace: bool = False  # overwrite another world that has been saved under this name
    rename: bool = False  # delete what was saved under the name so far


class NamedWorld(Body):
    """One of the worlds that you have saved."""

    name: Name


class Worlds(BaseModel):
    """Titles by name."""

    yours: dict[str, str]
    ours: dict[str, str]


class Saved(BaseModel):
    name: str
    file: str


class Restored(BaseModel):
    name: str
    title: str


def add_worlds(app: FastAPI, latest: Latest[Snapshot], submit: Submit) -> None:
    limits, importing, text = Limits(), asyncio.Lock(), WorldText()
    _add_saved_worlds(app, submit, limits)

    @app.get("/api/world", tags=["worlds"], responses={503: {"model": Problem}})
    async def world() -> Response:
        """The office as it is now, as a world file, and which edition of it that is."""
        return json_response(await _read(submit, text))

    @app.get("/api/world/file", tags=["worlds"], responses={503: {"model": Problem}})
    async def world_file() -> Response:
        """The same as a file to keep."""
        now, _ = await world_now(submit)
        written = await asyncio.to_thread(text.of, now)
        safe = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "-" for c in now.name)
        headers = {"Content-Disposition": f'attachment; filename="{safe}.json"', "Cache-Control": "no-store"}
        return Response(written, headers=headers, media_type="application/json")

    @app.post(PLAN_PATH, tags=["worlds"], openapi_extra=takes(OpenFiles),
              responses={200: {"model": Opened}, **ERRORS})  # fmt: skip
    async def open_files(request: Request) -> Response:
        """Begin anew in a world or plan. When that is not possible, the session stays as it was."""
        body = await checked_body(request, OpenFiles, limits, MAX_PLAN_BYTES)  # one that stalls holds up no other
        if importing.locked():
            raise Declined.of(429, "another plan is being imported; wait until it is there")
        async with importing:
            return json_response(await _open(body, latest, submit))

    @app.post("/api/worlds/new", tags=["worlds"], openapi_extra=takes(NewWorld),
              responses={200: {"model": Opened}, **ERRORS})  # fmt: skip
    async def new(request: Request) -> Response:
        """Begin anew in an empty room, which is in no file until it is saved."""
        return json_response(await _new(request, submit, limits))


async def _read(submit: Submit, text: WorldText) -> bytes:
    now, edition = await world_now(submit)
    written = await asyncio.to_thread(text.of, now)
    head = to_json({**office_fields(edition), "yours": dict(own_worlds.names()), "ours": dict(world_names())})
    return head[:-1] + b',"world":' + written.encode() + b"}"


async def _open(body: OpenFiles, latest: Latest[Snapshot], submit: Submit) -> bytes:
    files = {_plain(file.name): _bytes(file) for file in body.files}
    _, snapshot = latest.get()
    office = None if snapshot is None or snapshot.recording is not None else snapshot.world
    radius = None if office is None else office.robot_radius_m
    said: list[str] = []
    try:
        world = await asyncio.to_thread(import_world, _main(files), files, body.scale_m, body.seed, radius, said.append)
    except WorldError as error:
        raise Malformed([wrong("files", list(files), str(error))]) from None
    return await _begin(submit, world, True, said)


def _plain(name: str) -> str:
    """The bare file name in what a browser calls a file, without folders."""
    return os.path.basename(name.replace("\\", "/")) or name


def _bytes(file: UploadedFile) -> bytes:
    try:
        return base64.b64decode(file.data, validate=True)
    except (binascii.Error, ValueError) as error:
        raise Malformed([wrong("files", file.name, f"{file.name}: data must be base64: {error}")]) from None


def _main(files: dict[str, bytes]) -> str:
    """The file that refers to the others: the map_server file if there is one, else the only file."""
    yaml = [name for name in files if name.lower().endswith((".yaml", ".yml"))]
    if len(yaml) == 1:
        return yaml[0]
    if len(files) == 1:
        return next(iter(files))
    said = f"got {len(files)} files, {', '.join(files)}"
    reason = f"{said}; drop one plan at a time: a .yaml with its picture, or one file"
    raise Malformed([wrong("files", list(files), reason)])


async def _new(request: Request, submit: Submit, limits: Limits) -> bytes:
    body = await checked_body(request, NewWorld, limits)
    _not_taken(body.name)
    try:
        world = empty_room(body.name, body.title or body.name, body.width_m, body.depth_m)
    except ValueError as error:
        raise Malformed([wrong("width_m, depth_m", [body.width_m, body.depth_m], str(error))]) from None
    return await _begin(submit, world, False, [])


def _not_taken(name: str) -> None:
    """Raises Malformed when another world has this name, or when it is not a valid name."""
    _free(name)
    if not own_worlds.is_name(name):
        raise Malformed([wrong("name", name, f"a name has {own_worlds.NAME_RULE}, got {name!r}")])
    if name in dict(own_worlds.names()):
        raise Malformed([wrong("name", name, f"there is a world {name!r} already; choose another name")])


async def _begin(submit: Submit, world: World, filed: bool, said: list[str]) -> bytes:
    name = (await ask_engine(submit, OpenWorld(world, filed), OPEN_TIMEOUT_S)).result
    x0, y0, x1, y1 = world.bounds
    size = [round(x1 - x0, 3), round(y1 - y0, 3)]
    about = {"name": name, "title": world.title, "walls": len(world.walls), "starts": len(world.starts)}
    return to_json({**about, "size_m": size, "said": said})


def _add_saved_worlds(app: FastAPI, submit: Submit, limits: Limits) -> None:
    @app.get("/api/worlds", tags=["worlds"], responses={200: {"model": Worlds}})
    async def worlds() -> Response:
        """The worlds that you have saved, and those that come with the program."""
        yours = dict(await asyncio.to_thread(own_worlds.names))
        return json_response(to_json({"yours": yours, "ours": dict(world_names())}))

    @app.post("/api/worlds/save", tags=["worlds"], openapi_extra=takes(SaveWorld),
              responses={200: {"model": Saved}, **ERRORS})  # fmt: skip
    async def save(request: Request) -> Response:
        """Write the office as it is now into the folder of your own worlds. From then on it has this name."""
        return json_response(await _save(request, submit, limits))

    @app.post("/api/worlds/delete", tags=["worlds"], openapi_extra=takes(NamedWorld),
              responses={200: {"model": Saved}, **ERRORS})  # fmt: skip
    async def delete(request: Request) -> Response:
        """Delete one of your own worlds; `file` is where it is kept. If it is open it goes on, but is then not saved."""
        return json_response(await _delete(request, submit, limits))

    @app.post("/api/worlds/restore", tags=["worlds"], openapi_extra=takes(NamedWorld),
              responses={200: {"model": Restored}, **ERRORS})  # fmt: skip
    async def restore(request: Request) -> Response:
        """Bring back the world of this name that was deleted last."""
        return json_response(await _restore(request, submit, limits))


async def _save(request: Request, submit: Submit, limits: Limits) -> bytes:
    body = await checked_body(request, SaveWorld, limits)
    _free(body.name)
    was, _ = await world_now(submit)
    yours = dict(own_worlds.names())
    if body.name in yours and not body.replace:
        await _is_ours(body.name, was.name, submit)
    if body.rename and (was.name == body.name or was.name not in yours):
        raise Malformed(
            [wrong("rename", True, f"{was.name!r} is no other world that you have saved; leave rename away")]
        )
    title = body.title or (was.title if body.name == was.name else body.name)
    named = replace(was, name=body.name, title=title)
    text = await asyncio.to_thread(world_to_json, named)
    path = await _done(body.name, lambda: own_worlds.save(body.name, text))
    await ask_engine(submit, WorldSaved(was, named))
    if body.rename:
        await _done(was.name, lambda: own_worlds.delete(was.name))
        await ask_engine(submit, WorldDeleted(was.name))
    return to_json({"name": body.name, "file": str(path)})


def _free(name: str) -> None:
    if name in dict(world_names()):
        raise Malformed([wrong("name", name, f"{name} comes with the program and stays as it is; choose another name")])


async def _is_ours(name: str, now: str, submit: Submit) -> None:
    """Raises Malformed when what is saved under this name is not what this dashboard read or wrote there."""
    if name != now:
        reason = f"there is a world {name!r} already; replace it or choose another name"
        raise Malformed([wrong("replace", False, reason)])
    filed = (await ask_engine(submit, ReadFiled(name))).result
    if not isinstance(filed, World) or not await asyncio.to_thread(holds, own_worlds.folder() / f"{name}.json", filed):
        reason = (
            f"somebody else has saved {name!r} since it was read here; replace what is there or choose another name"
        )
        raise Malformed([wrong("replace", False, reason)])


async def _delete(request: Request, submit: Submit, limits: Limits) -> bytes:
    name = (await checked_body(request, NamedWorld, limits)).name
    if name in dict(world_names()):
        raise Malformed([wrong("name", name, f"{name} comes with the program and stays")])
    kept = await _done(name, lambda: own_worlds.delete(name))
    await ask_engine(submit, WorldDeleted(name))
    return to_json({"name": name, "file": str(kept)})


async def _restore(request: Request, submit: Submit, limits: Limits) -> bytes:
    name = (await checked_body(request, NamedWorld, limits)).name
    title = await _done(name, lambda: own_worlds.restore(name))
    await ask_engine(submit, WorldRestored(name, title))
    return to_json({"name": name, "title": title})


async def _done(name: str, work: Callable[[], _T]) -> _T:
    """Do some work in the folder and return its result. Raises Malformed with the reason when it fails."""
    try:
        return await asyncio.to_thread(work)
    except ValueError as error:
        raise Malformed([wrong("name", name, str(error))]) from None
