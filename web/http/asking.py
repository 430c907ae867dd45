"""What routes share: bodies of requests, read up to their limit, checked against a model and described in the OpenAPI document;
the one place in `web` that asks the engine; and answers as JSON. A refusal becomes a `Declined`, which is turned into an
answer further out: by `answer_declined` for HTTP, by the stream for its pages.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Annotated, Any, TypeVar, cast

import orjson
from fastapi import Request
from fastapi.responses import Response
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from disk.words import one_line
from sim2d import World
from web.http.commands import Declined, Malformed, Problem, read_object, wrong
from web.http.security import MAX_BODY_BYTES, Limits
from web.messages import Accepted, Command, CompareBranch, EngineRequest, OfficeEdition, ReadWorld, Refused, Seek, Step

Name = Annotated[str, Field(min_length=1, max_length=200), AfterValidator(one_line)]
Title = Annotated[str, Field(min_length=1, max_length=80), AfterValidator(one_line)]
ERRORS: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (413, 422, 429, 503)}
Submit = Callable[[Command | EngineRequest], "Future[Accepted | Refused]"]

ANSWER_TIMEOUT_S = 3.0
PAST_TIMEOUT_S = 300.0  # the page shows how far it is, and a newer request ends it
TICK_TIMEOUT_S = 0.1  # a step is answered when its ticks are done


class NoAnswer(Declined):
    """The engine did not answer in time, or failed at the command; `status` is the HTTP status."""


async def ask_engine(submit: Submit, command: Command | EngineRequest, timeout_s: float | None = None) -> Accepted:
    """The engine's answer to a command that it has taken. Raises Malformed when it refuses, and NoAnswer."""
    answer = asyncio.wrap_future(submit(command))
    if timeout_s is None:
        timeout_s = ANSWER_TIMEOUT_S + (TICK_TIMEOUT_S * command.ticks if isinstance(command, Step) else 0.0)
        timeout_s = PAST_TIMEOUT_S if isinstance(command, Seek | CompareBranch) else timeout_s
    done, _ = await asyncio.wait({answer}, timeout=timeout_s)
    if not done:
        late = f"the engine did not answer within {timeout_s:g} s; the command may still take effect, see /api/state"
        raise NoAnswer.of(503, late)
    error = answer.exception()
    if error is not None:
        raise NoAnswer.of(500, f"the engine failed at this command: {type(error).__name__}: {error}")
    said = answer.result()
    if isinstance(said, Refused):
        raise Malformed([wrong(said.field, said.value, said.reason)])
    return said


async def world_now(submit: Submit) -> tuple[World, OfficeEdition]:
    result = (await ask_engine(submit, ReadWorld())).result
    assert isinstance(result, tuple)
    return cast("tuple[World, OfficeEdition]", result)


class Body(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


_W = TypeVar("_W", bound=Body)


async def body_of(request: Request, most: int = MAX_BODY_BYTES) -> bytes:
    """The request's body. Raises Declined when it is too long; never more than the limit is kept."""
    raw = bytearray()
    async for part in request.stream():
        raw += part
        if len(raw) > most:
            raise Declined.of(413, f"a body may have at most {most} bytes")
    return bytes(raw)


async def checked_body(request: Request, model: type[_W], limits: Limits, most: int = MAX_BODY_BYTES) -> _W:
    """The request's body, checked. Raises Declined."""
    raw = await body_of(request, most)
    limits.pass_on("world")
    try:
        return model.model_validate(read_object(raw))
    except ValidationError as error:
        item = error.errors(include_url=False)[0]
        path = ".".join(map(str, item["loc"]))
        reason = f"{path}: {item['msg'][0].lower()}{item['msg'][1:]}; it takes {', '.join(model.model_fields)}"
        raise Malformed([wrong(path, None if item["type"] == "missing" else item["input"], reason)]) from None


def takes(model: type[BaseModel]) -> dict[str, Any]:
    """The description of a route's body in the OpenAPI document."""
    schema = model.model_json_schema()
    definitions = schema.pop("$defs", {})
    for part in definitions.values():  # inline: they are used once
        schema = orjson.loads(
            orjson.dumps(schema).replace(b'{"$ref":"#/$defs/%b"}' % part["title"].encode(), orjson.dumps(part))
        )
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema}}}}


def json_response(body: bytes, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    return Response(body, status, {"Cache-Control": "no-store", **(headers or {})}, "application/json")
