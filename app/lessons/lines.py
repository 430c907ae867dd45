"""In which line of a TOML file a value stands: TOML's readers do not tell."""

from __future__ import annotations

import re
from collections.abc import Sequence

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
