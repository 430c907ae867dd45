"""How things are spoilt: bytes, and trees such as JSON."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from copy import deepcopy
from random import Random
from typing import Any

NESTED = re.compile(r'"nested (\d+)"')  # stands for this many brackets, which json.dumps would not write
ODD: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 7, 255, 2**31, 2**32, 2**53 + 1, 2**63, 2**64, -(2**63) - 1, 10**30, 10**400, -0.0, 1e-320,
    0.5, 1e9, -1e9, 1e308, float("nan"), float("inf"), float("-inf"), "", "x", "\x00", "\ud800", "é😀", "a" * 5000, "../../x",
    "NaN", "[", [], {}, [[]], [{}], {"": 0}, [0] * 3000, {"type": "pause"},
    *(f"nested {depth}" for depth in (5, 40, 200, 254, 300, 1000, 1023, 5000, 60_000)),
)  # fmt: skip


def bytes_spoilt(data: bytes, rng: Random, other: bytes = b"") -> bytes:
    """A few bytes changed, lost, doubled, or taken from another file."""
    out = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4, 16))):
        at, end = sorted(rng.randrange(len(out) + 1) for _ in range(2))
        end = min(end, at + rng.choice((1, 4, 64, 4096, len(out))))
        match rng.randrange(7):
            case 0 | 1 if at < len(out):
                out[at] = rng.randrange(256)
            case 2 if at < len(out):
                out[at] ^= 1 << rng.randrange(8)
            case 3:
                del out[at:end]
            case 4:
                out[at:at] = out[at:end] * rng.choice((1, 2, 30))
            case 5:
                out[at:end] = other[at:end] or rng.randbytes(min(end - at, 1000))
            case 6:
                del out[at:]
    return bytes(out[: 4 * len(data) + 4096])


def tree_spoilt(tree: Any, rng: Random) -> Any:
    """Some values changed, dropped, added, doubled or exchanged. The tree itself stays as it is."""
    tree = json.loads(json.dumps(tree))
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        places = list(_places(tree))
        if not places:
            return _odd(rng)
        holder, key = rng.choice(places)
        _spoil(holder, key, rng, places)
    return tree


def text_of(tree: Any) -> str:
    """JSON, including what no writer would write."""
    return NESTED.sub(lambda found: "[" * int(found[1]) + "]" * int(found[1]), json.dumps(tree))


def _spoil(holder: Any, key: Any, rng: Random, places: list[tuple[Any, Any]]) -> None:
    match rng.randrange(8):
        case 0:
            del holder[key]
        case 1 if isinstance(holder, dict):
            holder[rng.choice(("", "x", "type", "id", "\ud800", str(key) + "s", "number"))] = _odd(rng)
        case 1:
            holder.insert(key, _odd(rng))
        case 2 if isinstance(holder, list):
            holder.extend(json.loads(json.dumps(holder)) * rng.choice((1, 3, 40)) if len(holder) < 500 else [])
        case 3:
            other, name = rng.choice(places)
            if name in other if isinstance(other, dict) else name < len(other):
                holder[key] = json.loads(json.dumps(other[name]))
        case 4 if isinstance(holder[key], int | float):
            holder[key] = _number(holder[key], rng)
        case 5:
            holder[key] = [holder[key]]
        case _:
            holder[key] = _odd(rng)


def _odd(rng: Random) -> Any:
    return deepcopy(rng.choice(ODD))


def _number(value: float, rng: Random) -> Any:
    changes: tuple[Callable[[float], Any], ...] = (
        lambda v: -v, lambda v: v + 1, lambda v: v - 1, lambda v: v * 1000, lambda v: v / 3, str, float, lambda v: v * 2,
    )  # fmt: skip
    change = rng.choice(changes)
    try:
        return change(value)
    except OverflowError:
        return 0


def _places(tree: Any) -> Any:
    """Every (holder, key) in a tree."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, item in items:
        yield tree, key
        yield from _places(item)
