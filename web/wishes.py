"""Wishes about worlds: a JSON body that is checked, and an answer that says what is wrong."""

from __future__ import annotations

from collections.abc import Awaitable
from typing import Annotated, Any, TypeVar

import orjson
from fastapi import Request
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim2d import World
from web.commands import Malformed, Problem, problem, problem_of, read_object, wrong
from web.messages import Accepted, Errand, OfficeEdition, ReadWorld, Refused
from web.security import MAX_BODY_BYTES, Limits
from web.state import to_json
from web.stream import NoAnswer, Submit, ask

Name = Annotated[str, Field(min_length=1, max_length=200)]
Title = Annotated[str, Field(min_length=1, max_length=80)]
ERRORS: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (413, 422, 429, 503)}


class Wish(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


_W = TypeVar("_W", bound=Wish)


class _TooMuch(Exception):  # noqa: N818
    def __init__(self, status: int, reason: str) -> None:
        super().__init__(reason)
        self.status = status


async def answered(work: Awaitable[bytes]) -> Response:
    """What the work gives as JSON, or why it cannot be."""
    try:
        return json_response(await work)
    except Malformed as error:
        return json_response(to_json({"detail": error.wrongs}), 422)
    except (_TooMuch, NoAnswer) as error:
        return json_response(problem(str(error)), error.status)


async def wish_of(request: Request, model: type[_W], limits: Limits, most: int = MAX_BODY_BYTES) -> _W:
    """The request's body as a wish. Raises what `answered` answers."""
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


async def told(submit: Submit, errand: Errand, timeout_s: float | None = None) -> Accepted:
    """The engine's answer to an errand; raises Malformed when it refuses."""
    answer = await ask(submit, errand, timeout_s)
    if isinstance(answer, Refused):
        raise Malformed(problem_of(answer))
    return answer


async def world_now(submit: Submit) -> tuple[World, OfficeEdition]:
    result = (await told(submit, ReadWorld())).result
    assert isinstance(result, tuple)
    return result


def takes(model: type[BaseModel]) -> dict[str, Any]:
    """What a route says of its body in the OpenAPI document."""
    schema = model.model_json_schema()
    definitions = schema.pop("$defs", {})
    for part in definitions.values():  # inline: they are used once
        schema = orjson.loads(
            orjson.dumps(schema).replace(b'{"$ref":"#/$defs/%b"}' % part["title"].encode(), orjson.dumps(part))
        )
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema}}}}


def json_response(body: bytes, status: int = 200) -> Response:
    return Response(body, status, {"Cache-Control": "no-store"}, "application/json")
