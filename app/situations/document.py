"""The JSON of a situation, as in its file; a link has the same, shorter and packed.

A link leaves out what every program has: the text of a world of the program (`check` says which text that was), and
parameters at their defaults (`defaults` says which those were).
"""

from __future__ import annotations

import json
import zlib
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from app.config import Config, Value
from disk.words import one_line
from web.messages.situation import Look

FORMAT = "ratslam situation/1"
MOST_TICKS = 10_000_000  # eleven days
MOST_ORDERS = 2_000_000
_Short = Annotated[str, Field(max_length=200), AfterValidator(one_line)]
_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Document(BaseModel):
    """orders: tick, name and values of each; of an edited world the values hold what differs from the one before."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
    format: _Short
    version: _Short
    python: _Short
    numpy: _Short
    platform: _Short
    made_at: float
    world_name: _Short
    world: str | None  # the text of its file; None: the program's own world of this name
    check: int  # of that text
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)]
    values: dict[str, Value]
    defaults: int | None  # checksum of the defaults that are left out; None: nothing is left out
    orders: Annotated[list[tuple[int, str, dict[str, Any]]], Field(max_length=MOST_ORDERS)]
    tick: Annotated[int, Field(ge=0, le=MOST_TICKS)]
    state_hash: _Hash
    second_hash: _Hash | None = None  # of the second brain; left out where there is none, as in all earlier situations
    look: Look
    trial: _Short
    brain: str | None  # base64


def check_of(text: str) -> int:
    return zlib.crc32(text.encode())


def defaults() -> dict[str, Value]:
    """Of all parameters, by dotted name."""
    return {name: value for name, _, value in Config().items()}


def check_of_defaults() -> int:
    return check_of(json.dumps(defaults(), sort_keys=True))


def document_in(text: str | bytes) -> Document:
    """ValueError says, in a sentence, what is wrong."""
    try:
        return Document.model_validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        wrong = first["msg"][0].lower() + first["msg"][1:]
        raise ValueError(f"it is no situation of this program: {f'{where}: ' if where else ''}{wrong}") from None
