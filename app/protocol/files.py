"""Reading the file of an experiment or a lesson. A mistake is told with its line of the TOML file, which TOML's readers do not
tell."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar, cast

from pydantic import BaseModel, ValidationError

from app.config.toml_file import read_text, toml_tree

Part = TypeVar("Part", bound=BaseModel)

_TABLE = re.compile(r"^\s*(\[\[?)\s*([A-Za-z0-9_.\"'-]+)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"^\s*([A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')\s*=")


def line_of(text: str, path: Sequence[str | int]) -> int:
    """The line, from 1, of the value at this path; of the innermost part of it that has a line of its own."""
    table: list[str | int] = []
    counts: dict[str, int] = {}
    best, deepest = 1, 0
    for number, line in enumerate(text.splitlines(), start=1):
        header, key = _TABLE.match(line), _KEY.match(line)
        if header is not None:
            name = header.group(2)
            table = list(name.split("."))
            if header.group(1) == "[[":
                counts[name] = counts.get(name, -1) + 1
            for k in range(len(table), 0, -1):  # [a.b] below [[a]] is of its newest item
                prefix = ".".join(str(part) for part in table[:k] if isinstance(part, str))
                if prefix in counts:
                    table.insert(k, counts[prefix])
            here: list[str | int] = table
        elif key is not None:
            here = [*table, key.group(1).strip("\"'")]
        else:
            continue
        if len(here) > deepest and list(path[: len(here)]) == here:
            best, deepest = number, len(here)
    return best


def read_part(path: Path, kind: type[Part]) -> Part:
    """What is in the file. ValueError: file, line, name, value, and what would be right."""
    try:
        text = read_text(path)
        tree = toml_tree(text)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    _find_world(path, tree)
    try:
        return kind.model_validate(tree)
    except ValidationError as error:
        first = error.errors()[0]
        where = _without_kinds(first["loc"])
        name = ".".join(str(part + 1) if isinstance(part, int) else part for part in where) or "the file"
        what = first["msg"].removeprefix("Value error, ")
        got = "" if first["type"] == "missing" or first["msg"] != what else f", got {_shown(first['input'])}"
        raise ValueError(f"{path}, line {line_of(text, where)}: {name}: {what[0].lower()}{what[1:]}{got}") from None


def _find_world(path: Path, tree: dict[str, Any]) -> None:
    """A world may be a file beside this one."""
    for part in (tree, tree.get("scene")):
        if isinstance(part, dict):
            named = cast("dict[str, object]", part)
            name = named.get("world")
            if isinstance(name, str) and os.path.isfile(
                beside := path.parent / name
            ):  # False also for what can be no name
                named["world"] = str(beside)


def _without_kinds(path: tuple[str | int, ...]) -> list[str | int]:
    """pydantic names the kind of a step after its number: as the file has no such level, it is left out."""
    lists = (("steps",), ("protocol",))
    return [part for k, part in enumerate(path) if not (isinstance(part, str) and k and path[k - 2 : k - 1] in lists)]


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
