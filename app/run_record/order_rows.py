"""Orders as the rows of a file or of a link, in which an edited world is what differs from the one before, so that an hour
of editing stays small."""

from __future__ import annotations

import zlib
from typing import Any

from app.orders import Order, overtakes
from disk.limits import EDITED_BYTES, ORDERS


class OrderRows:
    """The rows that were read so far. world: the text of the world, as last edited."""

    def __init__(self, world: str) -> None:
        self.orders: list[Order] = []
        self.world, self.edited_bytes = world, 0  # bytes of all texts of edited worlds

    def add(self, order: Order, edit: dict[str, Any] | None) -> None:
        """Earlier programs also wrote what the next order undid, or repeated. ValueError: it cannot be one of a run."""
        if edit is not None:
            self.world = order.values["world"] = edited(self.world, edit)
            self.edited_bytes += len(self.world)
        if self.orders and overtakes(order, self.orders[-1]):
            self.orders.pop()
        self.orders.append(order)
        require_room(len(self.orders), self.edited_bytes)


def row_of(order: Order, world: str) -> tuple[dict[str, Any], dict[str, Any] | None, str]:
    """The values of an order without a world, the edit that makes the world of the one before, and the world after it."""
    values = dict(order.values)
    if "world" not in values:
        return values, None, world
    after = values.pop("world")
    return values, edit_of(world, after), after


def edit_of(before: str, after: str) -> dict[str, Any]:
    """The lines `from` to `to` of `before` become the lines `put`; `check` is the checksum of `after`."""
    old, new = before.splitlines(keepends=True), after.splitlines(keepends=True)
    most = min(len(old), len(new))
    first = next((k for k in range(most) if old[k] != new[k]), most)
    last = next((k for k in range(most - first) if old[-1 - k] != new[-1 - k]), most - first)
    put, check = "".join(new[first : len(new) - last]), zlib.crc32(after.encode())
    return {"from": first, "to": len(old) - last, "put": put, "check": check}


def edited(before: str, edit: dict[str, Any]) -> str:
    """The text after an edit. ValueError: the edit does not belong to this text."""
    lines = before.splitlines(keepends=True)
    try:
        first, last, put = edit["from"], edit["to"], edit["put"]
        if not 0 <= first <= last <= len(lines):
            raise ValueError(f"it changes lines {first} to {last} of {len(lines)}")
        after = "".join([*lines[:first], put, *lines[last:]])
        if edit["check"] != zlib.crc32(after.encode()):
            raise ValueError("the text after it is another than the one that was written")
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"an edit of the world cannot be made again: {error}") from None
    return after


def require_room(orders: int, edited_bytes: int) -> None:
    """ValueError: no run has so many orders, or so many edits of so large a world. Who writes one and who reads it ask here."""
    if orders > ORDERS:
        raise ValueError(f"a run has at most {ORDERS:,} orders")
    if edited_bytes > EDITED_BYTES:
        raise ValueError(f"the worlds of a run, one for each edit, have at most {EDITED_BYTES >> 20} MiB together")
