"""Any state as arrays and JSON, and its digest. The way back is in state_reading.py.

No pickle and no module paths: plain values, lists, tables, arrays, numpy's generators, and objects of classes that were
named with `kind`. An object that is held in two places is one object again after the way back. A set may come back in
another order, so an object whose future depends on an order must hold a list.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections import deque
from itertools import chain
from typing import IO, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from disk.archive import MOST_BYTES, pack, room_of
from disk.kinds import attributes, name_of

Items: TypeAlias = "tuple[Any, ...] | list[Any] | set[Any] | deque[Any]"
FORMAT = 3
LONG = (
    32  # lists and tables of this many numbers become arrays; JSON that grew with the map would take ten times as long
)


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class State:
    """tree: JSON-able, holds {"array": k} where arrays[k] belongs."""

    tree: dict[str, Any]
    arrays: list[NDArray[Any]]

    @property
    def outgrowing(self) -> str | None:
        """A warning that a file will soon not hold the state. It comes early, since the largest arrays grow by doubling."""
        if room_of(self.arrays) <= MOST_BYTES // 2:
            return None
        return f"the brain fills more than half of the {MOST_BYTES >> 20} MiB that a file may hold: save it before it grows"

    def digest(self) -> str:
        """SHA-256 of everything: equal for equal states. It also reveals a damaged file."""
        whole = hashlib.sha256(json.dumps(self.tree, sort_keys=True, allow_nan=False).encode())
        for array in self.arrays:
            whole.update(f"{array.dtype.str}{array.shape}".encode())
            whole.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
        return whole.hexdigest()


def encode(value: Any) -> State:
    """The state of a value, whose arrays it shares, so the value must not change meanwhile.

    TypeError names what no state may hold.
    """
    writer = _Writer()
    return State({"format": FORMAT, "state": writer.encode(value)}, writer.arrays)


def write_state(state: State, file: IO[bytes], note: str = "") -> None:
    """Write one file (.npz: arrays, and JSON as bytes). note: a text about it that can be read without unpacking.

    ValueError, before a byte is written, when it would be too large to be read again.
    """
    pack(file, {"digest": state.digest(), **state.tree}, state.arrays, note)


class _Writer:
    def __init__(self) -> None:
        self.arrays: list[NDArray[Any]] = []
        self._seen: dict[int, tuple[Any, int]] = {}  # keeps every object it has seen alive, so that no id is used twice

    def encode(self, value: Any) -> Any:
        if value is None or isinstance(value, bool | str) or type(value) is int:
            return value
        if type(value) is float:
            return value if math.isfinite(value) else {"float": repr(value)}
        if isinstance(value, tuple | list | set | deque):
            return self._items(value)
        if id(value) in self._seen:
            return {"same": self._seen[id(value)][1]}
        number = len(self._seen)
        self._seen[id(value)] = (value, number)
        return {**self._once(value), "number": number}

    def _items(self, value: Any) -> dict[str, Any]:
        items: Items = value
        numbers = _numbers(items) if isinstance(items, list) else None
        if numbers is not None:
            return {"numbers": self._keep(numbers)}
        in_order = sorted(items) if isinstance(items, set) else items
        room = {"room": items.maxlen} if isinstance(items, deque) else {}
        return {type(items).__name__: [self.encode(item) for item in in_order], **room}

    def _once(self, value: object) -> dict[str, Any]:
        if isinstance(value, np.ndarray | np.generic):
            return {"array": self._keep(value)}
        if isinstance(value, dict):
            return self._table(value)
        if isinstance(value, np.random.Generator):
            return {"generator": value.bit_generator.state}
        name = name_of(type(value))
        return {"kind": name, "state": {name: self.encode(item) for name, item in attributes(value).items()}}

    def _table(self, value: Any) -> dict[str, Any]:
        table: dict[Any, Any] = value
        keys, values = _numbers(list(table)), _numbers(list(table.values()))
        if keys is not None and values is not None:
            return {"keys": self._keep(keys), "values": self._keep(values)}
        return {"dict": [[self.encode(k), self.encode(v)] for k, v in table.items()]}

    def _keep(self, value: Any) -> int:
        array: NDArray[Any] = np.asarray(value)
        if array.dtype.kind not in "biuf":
            raise TypeError(f"a state must not hold an array of {array.dtype}: numbers, true or false, nothing else")
        self.arrays.append(array)
        return len(self.arrays) - 1


def _numbers(items: list[Any]) -> NDArray[Any] | None:
    """A long list of whole numbers, of floats or of pairs of either as an array; None for any other list."""
    kinds: set[type] = set(map(type, items)) if len(items) >= LONG else set()
    if kinds == {tuple} and set(map(len, items)) == {2}:
        kinds = set(map(type, chain.from_iterable(items)))
    if kinds not in ({int}, {float}):
        return None
    array = np.array(items)
    return array if array.dtype.type in (np.int64, np.float64) else None  # numbers beyond 64 bits stay a list
