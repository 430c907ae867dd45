"""Copies a state while nothing changes it: arrays by memcpy, tables at C speed, so that the engine waits for milliseconds.

What is then done with the copy, such as writing a file, may take its time in another thread. test_state_copy.py.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from itertools import chain
from typing import Any, TypeVar

import numpy as np

from disk.kinds import attributes, name_of

PLAIN = {int, float, bool, str, type(None)}  # these cannot change, so they are shared
T = TypeVar("T")


def copy_state(value: T) -> T:
    """Another object in the same state, without caches. An object held in two places is one object in the copy, too."""
    return _copy(value, {})


def _copy(value: object, made: dict[int, tuple[Any, Any]]) -> Any:
    """made: the original and its copy, by the original's id. Keeping the original alive prevents an id from being used twice."""
    kind = type(value)
    if kind in PLAIN or issubclass(kind, np.generic):
        return value
    if kind in (tuple, list, set, deque):
        return _copy_items(value, kind, made)
    if id(value) not in made:
        _copy_once(value, kind, made)
    return made[id(value)][1]


def _copy_items(value: Any, kind: type[Any], made: dict[int, tuple[Any, Any]]) -> Any:
    if kind is tuple:
        return value if _plain(value) else tuple(_copy(item, made) for item in value)
    return value.copy() if _plain(value) else _refilled(value, [_copy(item, made) for item in value])


def _copy_once(value: Any, kind: type[Any], made: dict[int, tuple[Any, Any]]) -> None:
    copy: Any
    if issubclass(kind, np.ndarray):
        copy = np.array(value)
    elif kind is dict:
        copy = value.copy() if _plain_table(value) else {}
        made[id(value)] = value, copy
        if not copy:
            copy.update({_copy(key, made): _copy(item, made) for key, item in value.items()})
    elif issubclass(kind, np.random.Generator):
        copy = np.random.default_rng()
        copy.bit_generator.state = value.bit_generator.state
    else:
        name_of(kind)  # raises TypeError for a class that a state must not hold
        copy = object.__new__(kind)
        made[id(value)] = value, copy
        for name, item in attributes(value).items():
            object.__setattr__(copy, name, _copy(item, made))
    made[id(value)] = value, copy


def _refilled(like: Any, items: list[Any]) -> Any:
    return deque(items, like.maxlen) if isinstance(like, deque) else type(like)(items)


def _plain(items: Iterable[Any]) -> bool:
    """Whether none of the items can change, found without a loop in Python."""
    return set(map(type, items)) <= PLAIN


def _plain_table(table: dict[Any, Any]) -> bool:
    """The same for keys and values; keys may be pairs."""
    keys = set(map(type, table))
    if keys == {tuple}:
        return _plain(chain.from_iterable(table)) and _plain(table.values())
    return keys <= PLAIN and _plain(table.values())
