"""The content of a part of the panel, and its numbers and tables as the panel writes them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Content:
    """Words and numbers for JSON, and arrays that are sent as they are."""

    data: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict[str, NDArray[Any]])


Rows = list[tuple[str, str]]


def table(title: str, rows: Rows, empty: str = "") -> dict[str, Any]:
    """Two columns of plain words; `empty` says why there are none."""
    return {"title": title, "rows": rows, "empty": empty}


def clock(seconds: float) -> str:
    minutes, second = divmod(int(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02d}:{second:02d}" if hours else f"{minute}:{second:02d}"


def number(value: float | None, unit: str, digits: int = 1) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.{digits}f} {unit}"


def thousands(count: int) -> str:
    return f"{count:,}".replace(",", "\u00a0")  # a space that does not break


def degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.0f}°".replace("-0°", "0°")


def percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.095 else f"{100 * share:.1f} %"


def counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def often(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
