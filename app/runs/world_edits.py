"""The text of an edited world as what differs from the text before, so that an hour of editing stays small."""

from __future__ import annotations

import zlib
from typing import Any

from disk.limits import EDITED_BYTES, ORDERS


def edit_of(before: str, after: str) -> dict[str, Any]:
    """The lines `from` to `to` of `before` become the lines `put`; `check` is the checksum of `after`."""
    old, new = before.splitlines(keepends=True), after.splitlines(keepends=True)
    most = min(len(old), len(new))
    first = next((k for k in range(most) if old[k] != new[k]), most)
    last = next((k for k in range(most - first) if old[-1 - k] != new[-1 - k]), most - first)
    return {"from": first, "to": len(old) - last, "put": "".join(new[first : len(new) - last]), "check": _check(after)}


def edited(before: str, edit: dict[str, Any]) -> str:
    """The text after an edit. ValueError: the edit does not belong to this text."""
    lines = before.splitlines(keepends=True)
    try:
        first, last, put = edit["from"], edit["to"], edit["put"]
        if not 0 <= first <= last <= len(lines):
            raise ValueError(f"it changes lines {first} to {last} of {len(lines)}")
        after = "".join([*lines[:first], put, *lines[last:]])
        if edit["check"] != _check(after):
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


def _check(text: str) -> int:
    return zlib.crc32(text.encode())
