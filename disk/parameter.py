"""What a parameter is: a field of a dataclass that knows its meaning, range, unit, symbol and source, in every room."""

from __future__ import annotations

import math
from dataclasses import Field, field, fields
from typing import Any


def param(
    default: Any,
    meaning: str,
    low: float | None = None,
    high: float | None = None,
    unit: str = "",
    *,
    symbol: str = "",
    source: str = "ours",
    choices: tuple[str, ...] = (),
    live: bool = True,
    lecture: bool = False,
) -> Any:
    """symbol: the papers', where they have one. live: it may change while the engine runs. choices: of a text. lecture: one of
    the dozen that *Tune* opens with, since a lecture turns them."""
    about = {
        "symbol": symbol,
        "unit": unit,
        "low": low,
        "high": high,
        "meaning": meaning,
        "source": source,
        "choices": choices,
        "live": live,
        "lecture": lecture,
    }
    return field(default=default, metadata=about)


def check_ranges(params: Any) -> None:
    """ValueError for the first field that is out of its range or of the wrong type; it says what would be right."""
    for item in fields(params):
        if "meaning" in item.metadata:
            wrong = _wrong_with(item, getattr(params, item.name))
            if wrong:
                raise ValueError(f"{item.name} must be {wrong}")


def _wrong_with(item: Field[Any], value: object) -> str:
    """What the value must be and is not; "" if nothing is wrong."""
    about, default = item.metadata, item.default
    low, high = about["low"], about["high"]
    if isinstance(default, bool):
        needed = "" if isinstance(value, bool) else "true or false"
    elif isinstance(default, str):
        needed = "" if value in about["choices"] else f"one of {', '.join(map(repr, about['choices']))}"
    elif isinstance(value, bool) or not isinstance(value, int | float):
        needed = "a number"
    elif isinstance(default, int) and not isinstance(value, int):
        needed = "a whole number"
    elif not math.isfinite(value) or (low is not None and value < low) or (high is not None and value > high):
        needed = f"between {low:g} and {high:g} {about['unit']}".rstrip()
    else:
        needed = ""
    return needed and f"{needed}, got {' '.join(repr(value).split())}"  # an array has lines
