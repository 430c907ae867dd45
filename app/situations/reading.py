"""A situation from the text of a file or from a link. Both come from others, so everything in them is checked."""

from __future__ import annotations

import base64
import binascii
import zlib

import msgspec

from app.order_book import SMALLEST_M, Order, overtakes
from app.runs.header import FORMAT as RUN
from app.runs.header import Header
from app.runs.order_check import check_order
from app.runs.world_edits import edited, require_room
from app.situations.document import FORMAT, Document, check_of, check_of_defaults, defaults, document_in, order_in
from app.situations.situation import Situation
from app.situations.writing import KEY, text_of_ours
from disk.limits import LINK_BYTES
from sim2d import world_from_json


def read_situation(text: str) -> Situation:
    """text: of a file, or a link: a whole address, or its end from `run=` on. ValueError says what is wrong with it."""
    text = text.strip()
    document, orders = document_in(text if text.startswith("{") else _unpacked(text))
    if document.format != FORMAT:
        raise ValueError(f"its format is {document.format!r}; this program reads {FORMAT!r}")
    notes: list[str] = []
    if document.defaults not in (None, check_of_defaults()):
        notes.append("Some of the defaults, which its link leaves out, were others then.")
    world = _world_of(document)
    header = Header(
        RUN, document.version, document.python, document.numpy, document.platform, document.made_at,
        document.world_name, world, document.seed, defaults() | document.values, document.brain is not None,
        document.trial,
    )  # fmt: skip
    _ = header.config  # ValueError: there is no such parameter, or not such a value
    return Situation(
        header, _orders_of(document, orders, world), document.tick, document.state_hash, document.look, _brain_of(document),
        tuple(notes), document.second_hash,
    )  # fmt: skip


def _unpacked(text: str) -> bytes:
    _, found, packed = text.rpartition(f"{KEY}=")
    packed = packed.partition("&")[0]
    if not found:
        raise ValueError(f"it is neither the file of a situation nor a link with #{KEY}=")
    try:
        raw = base64.b64decode(packed + "=" * (-len(packed) % 4), altchars=b"-_", validate=True)
        opening = zlib.decompressobj()
        document = opening.decompress(raw, LINK_BYTES)
    except (binascii.Error, ValueError, zlib.error):
        raise ValueError("the link is damaged: what follows run= cannot be unpacked; copy it whole") from None
    if not opening.eof:
        too_long = "is longer than any run" if len(document) >= LINK_BYTES else "is cut off; copy it whole"
        raise ValueError(f"the link {too_long}")
    return document


def _world_of(document: Document) -> str:
    """The text of the world."""
    text = document.world if document.world is not None else text_of_ours(document.world_name)
    if text is None:
        raise ValueError(f"this program has no world {document.world_name!r}; ask for the file, which has it")
    if check_of(text) != document.check:
        whose = "the world in it" if document.world is not None else f"this program's world {document.world_name!r}"
        raise ValueError(f"{whose} is another than the one that the run began in; ask for the file")
    world_from_json(text, f"the world {document.world_name}", SMALLEST_M)
    return text


def _orders_of(document: Document, rows: list[msgspec.Raw], world: str) -> tuple[Order, ...]:
    orders: list[Order] = []
    last = edited_bytes = 0
    for number, raw in enumerate(rows, start=1):
        try:
            tick, name, values = order_in(raw)
        except ValueError as error:
            raise ValueError(f"order {number}: {error}") from None
        if not last <= tick <= document.tick:
            raise ValueError(f"order {number} is of tick {tick}; it must be from {last} to {document.tick}")
        try:
            if "edit" in values:
                world = values["world"] = edited(world, values.pop("edit"))
                edited_bytes += len(world)
            order = Order(tick, name, values)
            check_order(order)
            if orders and overtakes(order, orders[-1]):
                orders.pop()
            orders.append(order)
            require_room(len(orders), edited_bytes)
        except ValueError as error:
            raise ValueError(f"order {number}, of tick {tick}: {error}") from None
        last = tick
    return tuple(orders)


def _brain_of(document: Document) -> bytes | None:
    try:
        return None if document.brain is None else base64.b64decode(document.brain, validate=True)
    except (binascii.Error, ValueError):
        raise ValueError("the brain in it is damaged: it is no base64") from None
