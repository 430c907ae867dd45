"""The checks that laws are made of. When one fails, a ValueError names the value and says what would be right."""

# Of a value of any type, isinstance tells the checker no more than "an array or a number of unknown type".
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from disk.kinds import is_known
from ratslam_core.types import Pose2

MOST = 2**53  # a double counts whole numbers exactly up to here
FAR_M = 1e6  # no robot drives so far
TURN = math.pi + 1e-6  # a wrapped angle, give or take its rounding
_PLAIN: tuple[tuple[type, tuple[type, ...]], ...] = (
    (bool, (bool, np.bool_)),
    (int, (int, np.integer)),
    (float, (float, int, np.floating)),
)


def true(holds: object, words: str) -> None:
    if not holds:
        raise ValueError(words)


def whole(name: str, value: object, low: int = 0, high: int = MOST) -> int:
    """The value, a whole number from low to high."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer) or not low <= value <= high:
        raise ValueError(f"{name} must be a whole number from {low} to {high}, got {_short(value)}")
    return int(value)


def number(name: str, value: object, low: float = 0.0, high: float = math.inf) -> float:
    """The value, a number from low to high; it may be infinite only when `high` is."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.floating) or not low <= value <= high:
        raise ValueError(f"{name} must be a number from {low:g} to {high:g}, got {_short(value)}")
    return float(value)


def pose(name: str, value: object) -> None:
    if not isinstance(value, Pose2):
        raise ValueError(f"{name} must be a pose, got {_short(value)}")
    number(f"{name}.x", value.x, -FAR_M, FAR_M)
    number(f"{name}.y", value.y, -FAR_M, FAR_M)
    number(f"{name}.heading_rad", value.heading_rad, -TURN, TURN)


def _short(value: object) -> str:
    if isinstance(value, list | tuple | dict | np.ndarray):
        return f"a {type(value).__name__}"
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def array(name: str, value: object, kind: Any, shape: tuple[int | None, ...]) -> NDArray[Any]:
    """The value, an array of this type and shape (None: any size but 0) that lies in memory row after row."""
    if not isinstance(value, np.ndarray) or value.dtype != kind or not value.dtype.isnative:
        raise ValueError(f"{name} must be an array of {np.dtype(kind)}, got {getattr(value, 'dtype', _short(value))}")
    fits = len(value.shape) == len(shape)
    if not fits or not all(n > 0 if m is None else n == m for n, m in zip(value.shape, shape, strict=True)):
        wanted = ", ".join("any" if n is None else str(n) for n in shape)
        raise ValueError(f"{name} must have shape ({wanted}), got {value.shape}")
    if not value.flags.c_contiguous:
        raise ValueError(f"{name} must lie in memory row after row")
    if kind == np.bool_ and value.size and value.view(np.uint8).max() > 1:
        raise ValueError(f"{name} must be true or false everywhere")
    return value


def within(name: str, values: NDArray[Any], low: float, high: float) -> None:
    """All values are from low to high, so none is nan."""
    if values.size and not (values.min() >= low and values.max() <= high):
        at = int(np.argmin((values >= low) & (values <= high)))
        raise ValueError(f"{name} must be from {low:g} to {high:g}, got {values.flat[at]:g} in place {at}")


def apart(name: str, start: NDArray[Any], room: NDArray[Any], end: int, size: int) -> None:
    """Blocks of an arena lie before its end and do not overlap; the end is no farther than the size."""
    true(0 <= end <= size, f"{name} must end within {size}, got {end}")
    start, room = start.astype(np.int64), room.astype(np.int64)
    within(f"{name}: start", start, 0, end)
    within(f"{name}: room", room, 0, end)
    within(f"{name}: end of a block", start + room, 0, end)
    real = room > 0
    order = np.argsort(start[real], kind="stable")
    start, room = start[real][order], room[real][order]
    true((start[1:] >= (start + room)[:-1]).all(), f"{name} must not overlap")


def same_kind(name: str, value: Any, fresh: Any, seen: set[tuple[int, int]] | None = None) -> None:
    """ValueError when a value is not of the type, dtype or length that `fresh` has, as each attribute in a brain that was
    just made. What is None in a new brain is left to the laws."""
    seen = set() if seen is None else seen
    if fresh is None or (id(value), id(fresh)) in seen:
        return
    for plain, kinds in _PLAIN:
        if type(fresh) is plain:
            fits = isinstance(value, kinds) and (plain is bool or not isinstance(value, bool | np.bool_))
            true(fits, f"{name} must be {plain.__name__}, got {type(value).__name__}")
            true(plain is bool or abs(value) <= MOST or value == math.inf, f"{name} must be a number, got {value}")
            return
    true(type(value) is type(fresh), f"{name} must be a {type(fresh).__name__}, got a {type(value).__name__}")
    if isinstance(fresh, np.ndarray):
        fits = value.dtype == fresh.dtype and value.ndim == fresh.ndim
        true(fits, f"{name} must have {fresh.ndim} dimensions of {fresh.dtype}, got {value.ndim} of {value.dtype}")
    elif isinstance(fresh, tuple):
        true(len(value) == len(fresh), f"{name} must have {len(fresh)} parts, got {len(value)}")
        for k, part in enumerate(fresh):
            same_kind(f"{name}[{k}]", value[k], part, seen)
    elif is_known(type(fresh)):
        seen.add((id(value), id(fresh)))
        _same_attributes(name, value, fresh, seen)


def _same_attributes(name: str, value: Any, fresh: Any, seen: set[tuple[int, int]]) -> None:
    wanted, found = attributes(fresh), attributes(value)
    if wanted.keys() != found.keys():
        odd = ", ".join(sorted(wanted.keys() ^ found.keys()))
        raise ValueError(f"{type(fresh).__name__} differs in {odd}: the snapshot was made by another version")
    for attribute, item in wanted.items():
        optional = found[attribute] is None and _may_be_none(type(fresh), attribute)
        if not optional and attribute not in getattr(fresh, "CACHES", ()):
            same_kind(f"{name}.{attribute}", found[attribute], item, seen)


def _may_be_none(kind: type, attribute: str) -> bool:
    fields = dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ()
    return any(item.name == attribute and str(item.type).endswith("| None") for item in fields)


def attributes(value: Any) -> dict[str, Any]:
    """The attributes of an object by name; missing fields of a dataclass are left out."""
    if dataclasses.is_dataclass(value):
        names = [item.name for item in dataclasses.fields(value)]
        return {name: getattr(value, name) for name in names if hasattr(value, name)}
    return dict(vars(value))
