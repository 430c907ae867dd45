"""On which line of a JSON text an item stands, for error messages; and how deeply a document is nested."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any, cast

_SPACE = " \t\r\n"
_value = json.JSONDecoder().raw_decode


def line_of(text: str, path: Sequence[str | int]) -> int:
    """The line, from 1, on which the value at `path` (keys and indices) begins, or its deepest part that exists."""
    at = _skip(text, 0)
    for part in path:
        inner = _member(text, at, part) if isinstance(part, str) else _element(text, at, part)
        if inner is None:
            break
        at = inner
    return text.count("\n", 0, at) + 1


def deeper_than(levels: int, document: Any) -> bool:
    """Whether lists and objects are nested in more than `levels` levels: code that writes them recurses."""
    level = [document]
    for _ in range(levels):
        level = [inner for item in level for inner in _parts(item)]
    return any(isinstance(item, dict | list) for item in level)


def _parts(item: Any) -> Iterable[Any]:
    if isinstance(item, dict):
        return cast("dict[str, Any]", item).values()
    return cast("list[Any]", item) if isinstance(item, list) else ()


def _member(text: str, at: int, key: str) -> int | None:
    if text[at] != "{":
        return None
    at = _skip(text, at + 1)
    found = None
    while text[at] != "}":
        name, at = _value(text, at)
        at = _skip(text, _skip(text, at) + 1)
        if name == key:
            found = at  # of equal keys the last one counts
        at = _next(text, at)
    return found


def _element(text: str, at: int, index: int) -> int | None:
    if text[at] != "[":
        return None
    at = _skip(text, at + 1)
    while text[at] != "]":
        if index == 0:
            return at
        index -= 1
        at = _next(text, at)
    return None


def _next(text: str, at: int) -> int:
    """The position after the value at `at` and the comma that follows it."""
    at = _skip(text, _value(text, at)[1])
    return _skip(text, at + 1) if text[at] == "," else at


def _skip(text: str, at: int) -> int:
    while text[at] in _SPACE:
        at += 1
    return at
