"""What a parameter is: a dataclass field with symbol, unit, range, meaning and source."""

from __future__ import annotations

import math
from dataclasses import field, fields
from typing import Any


def param(
    default: Any,
    *,
    symbol: str = "",
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    meaning: str,
    source: str,
    choices: tuple[str, ...] = (),
    live: bool = True,
) -> Any:
    """A dataclass field that knows what it means. `live` parameters may change while the engine runs; text has `choices`."""
    about = {
        "symbol": symbol,
        "unit": unit,
        "low": low,
        "high": high,
        "meaning": meaning,
        "source": source,
        "choices": choices,
        "live": live,
    }
    return field(default=default, metadata=about)


def check_ranges(params: Any) -> None:
    """ValueError with name, value and range for the first field that is out of its range or of the wrong type."""
    for item in fields(params):
        value, about = getattr(params, item.name), item.metadata
        if "meaning" not in about:
            continue
        default: object = item.default
        kind: type[Any] = type(default)
        fits = isinstance(value, kind) or (kind is float and type(value) is int)
        if not fits or (kind is int and isinstance(value, bool)):
            got = " ".join(repr(value).split())  # an array has lines
            raise ValueError(f"{item.name} must be {kind.__name__}, got {got}")
        if kind is bool:
            continue
        if kind is str:
            if value not in about["choices"]:
                raise ValueError(f"{item.name} must be one of {', '.join(map(repr, about['choices']))}, got {value!r}")
            continue
        low, high = about["low"], about["high"]
        if not math.isfinite(value) or (low is not None and value < low) or (high is not None and value > high):
            unit = f" {about['unit']}" if about["unit"] else ""
            raise ValueError(f"{item.name} must be between {low} and {high}{unit}, got {value!r}")
