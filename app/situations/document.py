"""The JSON of a situation, as in its file; a link has the same, shorter and packed.

A link leaves out what every program has: the text of a world of the program (`check` says which text that was), and
parameters at their defaults (`defaults` says which those were).
"""

from __future__ import annotations

import json
import zlib
from typing import Annotated, Any

import msgspec
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from app.config import Config, Value
from app.runs.lines import parts_of
from disk.limits import LINE_PARTS, ORDERS, PARTS_OF_AN_ORDER, SITUATION_BYTES, TICKS
from disk.words import one_line
from web.messages.situation import Look

FORMAT = "ratslam situation/1"
MOST_PARTS = PARTS_OF_AN_ORDER * ORDERS
_Row = tuple[int, str, dict[str, Any]]
_ORDER: msgspec.json.Decoder[_Row] = msgspec.json.Decoder(_Row)
_Short = Annotated[str, Field(max_length=200), AfterValidator(one_line)]
_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Document(BaseModel):
    """Of its file all but the orders, which are read and written one by one."""

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
    tick: Annotated[int, Field(ge=0, le=TICKS)]
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


def document_in(text: str | bytes) -> tuple[Document, list[msgspec.Raw]]:
    """The document and its orders, each still as text: of a long run, all of them as values would fill the memory. ValueError
    says, in a sentence, what is wrong."""
    raw = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    if len(raw) > SITUATION_BYTES or parts_of(raw, MOST_PARTS) > MOST_PARTS:
        raise ValueError(f"it is longer than any run: it may have {SITUATION_BYTES >> 20} MiB and {ORDERS:,} orders")
    try:
        tree = msgspec.json.decode(raw, type=dict[str, msgspec.Raw])
        orders = msgspec.json.decode(tree.pop("orders", b"[]"), type=list[msgspec.Raw])
        rest = b",".join(json.dumps(key).encode() + b":" + bytes(value) for key, value in tree.items())
    except (msgspec.MsgspecError, RecursionError) as error:
        raise ValueError(f"it is no situation of this program: it is damaged: {error}") from None
    if parts_of(rest, LINE_PARTS) > LINE_PARTS:
        raise ValueError(
            f"it is no situation of this program: it holds more than {LINE_PARTS:,} values beside its orders"
        )
    return _checked(b"{" + rest + b"}"), orders


def order_in(raw: msgspec.Raw) -> _Row:
    """Tick, name and values; of an edited world the values hold what differs from the one before. ValueError: it is none."""
    if parts_of(bytes(raw), LINE_PARTS) > LINE_PARTS:
        raise ValueError(f"it holds more than {LINE_PARTS:,} values")
    try:
        return _ORDER.decode(raw)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise ValueError(f"it is damaged: {error}") from None


def _checked(raw: bytes) -> Document:
    try:
        return Document.model_validate_json(raw)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        wrong = first["msg"][0].lower() + first["msg"][1:]
        raise ValueError(f"it is no situation of this program: {f'{where}: ' if where else ''}{wrong}") from None
