"""A person's own worlds, in a folder of theirs: listed, saved, renamed, deleted and brought back. Names are ids, not paths."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from fastapi import FastAPI, Request
from fastapi.responses import Response
from pydantic import BaseModel

from sim2d import World, own_worlds, world_names, world_to_json
from sim2d.world.world_file import holds
from web.http.asking import Submit, told, world_now
from web.http.bodies import ERRORS, Body, Name, Title, checked_body, json_response, takes
from web.http.commands import Malformed, wrong
from web.http.security import Limits
from web.http.state import to_json
from web.messages import ReadFiled, WorldDeleted, WorldRestored, WorldSaved

_T = TypeVar("_T")


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


def add_saved_worlds(app: FastAPI, submit: Submit, limits: Limits) -> None:
    @app.get("/api/worlds", tags=["worlds"], responses={200: {"model": Worlds}})
    async def worlds() -> Response:
        """The worlds that you have saved, and those that come with the program."""
        return json_response(await _list())

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


def not_taken(name: str) -> None:
    """Raises Malformed when another world has this name, or when it is not a valid name."""
    _free(name)
    if not own_worlds.is_name(name):
        raise Malformed([wrong("name", name, f"a name has {own_worlds.NAME_RULE}, got {name!r}")])
    if name in dict(own_worlds.names()):
        raise Malformed([wrong("name", name, f"there is a world {name!r} already; choose another name")])


def _free(name: str) -> None:
    if name in dict(world_names()):
        reason = f"{name} comes with the program and stays as it is; choose another name"
        raise Malformed([wrong("name", name, reason)])


async def _list() -> bytes:
    return to_json({"yours": dict(await asyncio.to_thread(own_worlds.names)), "ours": dict(world_names())})


async def _save(request: Request, submit: Submit, limits: Limits) -> bytes:
    wish = await checked_body(request, SaveWorld, limits)
    _free(wish.name)
    was, _ = await world_now(submit)
    yours = dict(own_worlds.names())
    if wish.name in yours and not wish.replace:
        await _is_ours(wish.name, was.name, submit)
    if wish.rename and (was.name == wish.name or was.name not in yours):
        reason = f"{was.name!r} is no other world that you have saved; leave rename away"
        raise Malformed([wrong("rename", True, reason)])
    title = wish.title or (was.title if wish.name == was.name else wish.name)
    named = replace(was, name=wish.name, title=title)
    text = await asyncio.to_thread(world_to_json, named)
    path = await _done(wish.name, lambda: own_worlds.save(wish.name, text))
    await told(submit, WorldSaved(was, named))
    if wish.rename:
        await _done(was.name, lambda: own_worlds.delete(was.name))
        await told(submit, WorldDeleted(was.name))
    return to_json({"name": wish.name, "file": str(path)})


async def _is_ours(name: str, now: str, submit: Submit) -> None:
    """Raises Malformed when what is saved under this name is not what this dashboard read or wrote there."""
    if name != now:
        reason = f"there is a world {name!r} already; replace it or choose another name"
        raise Malformed([wrong("replace", False, reason)])
    filed = (await told(submit, ReadFiled(name))).result
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
    await told(submit, WorldDeleted(name))
    return to_json({"name": name, "file": str(kept)})


async def _restore(request: Request, submit: Submit, limits: Limits) -> bytes:
    name = (await checked_body(request, NamedWorld, limits)).name
    title = await _done(name, lambda: own_worlds.restore(name))
    await told(submit, WorldRestored(name, title))
    return to_json({"name": name, "title": title})


async def _done(name: str, work: Callable[[], _T]) -> _T:
    """Do some work in the folder and return its result. Raises Malformed with the reason when it fails."""
    try:
        return await asyncio.to_thread(work)
    except ValueError as error:
        raise Malformed([wrong("name", name, str(error))]) from None
