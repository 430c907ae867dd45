"""Every attribute is of the type that it has in a brain that was just made."""

# Of a value of any type, isinstance tells the checker no more than "an array or a number of unknown type".
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from disk.kinds import is_known
from ratslam_core.laws.measures import MOST, true

_PLAIN: tuple[tuple[type, tuple[type, ...]], ...] = (
    (bool, (bool, np.bool_)),
    (int, (int, np.integer)),
    (float, (float, int, np.floating)),
)


def same_kind(name: str, value: Any, fresh: Any, seen: set[tuple[int, int]] | None = None) -> None:
    """ValueError when a value is not of the type, dtype or length of `fresh`. What is None in a new brain is left to the laws."""
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
    declared = (
        {item.name: str(item.type) for item in dataclasses.fields(kind)} if dataclasses.is_dataclass(kind) else {}
    )
    return declared.get(attribute, "").endswith("| None")


def attributes(value: Any) -> dict[str, Any]:
    """The attributes of an object by name; missing fields of a dataclass are left out."""
    if dataclasses.is_dataclass(value):
        names = [item.name for item in dataclasses.fields(value)]
        return {name: getattr(value, name) for name in names if hasattr(value, name)}
    return dict(vars(value))
