"""Tune: every parameter with its symbol, unit, range and meaning."""

from __future__ import annotations

import math
from typing import Any

from web.messages import Parameter
from web.panel.part import Content


def tune(parameters: tuple[Parameter, ...]) -> Content:
    return Content({"knobs": [knob(parameter) for parameter in parameters]})


def knob(parameter: Parameter) -> dict[str, Any]:
    """One parameter, as the page needs it to make a control."""
    return {
        "name": parameter.name,
        "value": parameter.value,
        "default": parameter.default,
        "symbol": parameter.symbol,
        "unit": parameter.unit,
        "low": parameter.low,
        "high": parameter.high,
        "step": step(parameter),
        "choices": parameter.choices,
        "live": parameter.live,
        "lecture": parameter.lecture,
        "meaning": meaning(parameter),
        "hint": hint(parameter),
    }


def meaning(parameter: Parameter) -> str:
    """As a sentence."""
    return parameter.meaning[:1].upper() + parameter.meaning[1:] + "."


def hint(parameter: Parameter) -> str:
    """Meaning, range, default and source, and whether a change waits for the next reset."""
    parts = [meaning(parameter)]
    limits = _range(parameter)
    if limits:
        parts.append(f"Range: {limits}.")
    if parameter.choices:
        parts.append(f"One of: {', '.join(parameter.choices)}.")
    parts.append(f"Default: {parameter.default}. Source: {parameter.source}.")
    if not parameter.live:
        parts.append("Takes effect at reset.")
    return " ".join(parts)


def _range(parameter: Parameter) -> str:
    low, high = parameter.low, parameter.high
    if low is None and high is None:
        return ""
    ends = f"at least {low:g}" if high is None else f"at most {high:g}" if low is None else f"{low:g} to {high:g}"
    return f"{ends} {parameter.unit}".strip()


def step(parameter: Parameter) -> float | int | None:
    """A hundredth of the range, rounded down to 1, 2 or 5 times a power of ten; 1 for whole numbers; None: no number."""
    if isinstance(parameter.value, bool | str):
        return None
    if isinstance(parameter.value, int):
        return 1
    size = abs(float(parameter.default))
    span = size / 2 or 1.0
    if parameter.low is not None and parameter.high is not None:
        span = min(parameter.high - parameter.low, 10 * (size or parameter.high - parameter.low))
    most = max(span, 1e-12) / 100 * (1 + 1e-9)
    decade = 10.0 ** math.floor(math.log10(most))
    return max(digit * decade for digit in (1, 2, 5) if digit * decade <= most)
