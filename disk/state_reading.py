"""The way back from a state, or from a file, to the object that it was made from.

No pickle: only objects of classes that were named with `kind` are made, and the content is checked against a digest.
Whoever can make a file can also make its digest, so the object must be checked against the laws of its parts before
compiled code sees it.
"""

from __future__ import annotations

import dataclasses
from collections import deque
from typing import IO, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from disk.archive import unpack
from disk.kinds import class_of
from disk.state_codec import FORMAT, State

Tree: TypeAlias = "dict[str, Any] | list[Any] | str | float | None"  # whatever JSON holds
_ROWS: tuple[type[tuple[Any, ...] | list[Any] | set[Any]], ...] = (tuple, list, set)
MOST_WORDS = 400  # characters: what a broken file holds may be long


def decode(state: State) -> Any:
    """The object that `encode` was given. It keeps the state's arrays. Raises one of `archive.BROKEN` when that fails."""
    found = state.tree.get("format")
    if found in (1, 2):
        raise ValueError(f"of format {found}, which an unreleased version wrote; this one reads {FORMAT}: save it anew")
    if found != FORMAT:
        raise ValueError(f"format must be {FORMAT}, got {found!r}: made by another version")
    return _Reader(state.arrays).decode(state.tree.get("state"))


def read_state(file: IO[bytes]) -> State:
    """The state that `write_state` wrote. Raises one of `archive.BROKEN` when something is wrong with the file."""
    tree, arrays = unpack(file)
    found = tree.pop("digest", None)
    state = State(tree, arrays)
    if found != state.digest():
        raise ValueError("its digest does not fit what it holds: it was changed or damaged")
    return state


def words_of(error: BaseException) -> str:
    """An error's text for people, even if the error was not made for them."""
    words = str(error) or type(error).__name__
    if isinstance(error, KeyError):
        words = f"it lacks {error}"
    elif isinstance(error, RecursionError):
        words = "it is nested too deeply"
    elif isinstance(error, MemoryError):
        words = "it needs more memory than there is"
    elif isinstance(error, TypeError | AttributeError):
        words = f"its parts do not fit together: {words}"
    return words if len(words) <= MOST_WORDS else f"{words[:MOST_WORDS]}..."


class _Reader:
    """Makes objects from a tree. Each array is given out once; only attributes listed in SHARED may hold one again."""

    def __init__(self, arrays: list[NDArray[Any]]) -> None:
        self._arrays: dict[int, NDArray[Any]] = dict(enumerate(arrays))
        self._made: dict[int, Any] = {}

    def decode(self, tree: Tree, shared: bool = False) -> Any:
        if not isinstance(tree, dict):
            return tree
        if "float" in tree:
            return float(tree["float"])
        if "same" in tree:
            if isinstance(self._made[tree["same"]], np.ndarray) and not shared:
                raise ValueError("an array is in two places at once")
            return self._made[tree["same"]]
        if "numbers" in tree:
            return self._items(tree["numbers"])
        if "deque" in tree:
            return deque((self.decode(item) for item in tree["deque"]), tree["room"])
        for kind in _ROWS:
            if kind.__name__ in tree:
                return kind(self.decode(item) for item in tree[kind.__name__])
        return self._new(tree)

    def _new(self, tree: dict[str, Any]) -> Any:
        made: Any
        if "array" in tree:
            array = self._arrays.pop(tree["array"])
            made = array if array.ndim else array[()]
        elif "generator" in tree:
            made = np.random.default_rng()
            made.bit_generator.state = tree["generator"]
        elif "keys" in tree:
            keys, values = self._items(tree["keys"]), self._items(tree["values"])
            made = dict(zip(keys, values, strict=True))
        elif "dict" in tree:
            made = self._made[tree["number"]] = {}
            made.update({self.decode(k): self.decode(v) for k, v in tree["dict"]})
        else:
            return self._object(tree)
        self._made[tree["number"]] = made
        return made

    def _items(self, number: int) -> list[Any]:
        """Numbers, or pairs of them."""
        array = self._arrays.pop(number)
        if array.ndim not in (1, 2):
            raise ValueError(f"a list must be in an array of 1 or 2 dimensions, got {array.ndim}")
        return [*map(tuple, array.tolist())] if array.ndim == 2 else array.tolist()

    def _object(self, tree: dict[str, Any]) -> Any:
        kind = class_of(tree["kind"])
        if dataclasses.is_dataclass(kind):
            odd = {item.name for item in dataclasses.fields(kind)} ^ tree["state"].keys()
            if odd:
                raise ValueError(f"{kind.__name__} differs in {', '.join(sorted(odd))}: made by another version")
        made: Any = object.__new__(kind)
        self._made[tree["number"]] = made
        for attribute, item in tree["state"].items():
            value = self.decode(item, attribute in getattr(kind, "SHARED", ()))
            if attribute in getattr(kind, "CACHES", ()) and value is not None:
                raise ValueError(f"{kind.__name__}.{attribute} must be left out")
            object.__setattr__(made, attribute, value)
        if hasattr(kind, "__post_init__"):
            made.__post_init__()  # ranges of parameters
        return made
