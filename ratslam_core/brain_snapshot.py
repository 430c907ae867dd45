"""Snapshots of the brain: all of its state as arrays and JSON, and back. A restored brain goes on as if it had never stopped.

No pickle: only the engine's own classes are made, numbers are checked against a digest, parameters against their ranges.
The users of other RatSLAM implementations ask for this: a map that is saved and navigated with later.
"""

from __future__ import annotations

import dataclasses
import hashlib
import importlib
import json
import math
import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ratslam_core.slam import RatSlam

FORMAT = 1
ROOM = "ratslam_core."


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class BrainSnapshot:
    """tree: JSON-able, holds {"array": k} where arrays[k] belongs."""

    tree: dict[str, Any]
    arrays: list[NDArray]

    def digest(self) -> str:
        """SHA-256 of everything, to tell a damaged file."""
        whole = hashlib.sha256(json.dumps(self.tree, sort_keys=True, allow_nan=False).encode())
        for array in self.arrays:
            whole.update(f"{array.dtype.str}{array.shape}".encode())
            whole.update(np.ascontiguousarray(array).tobytes())
        return whole.hexdigest()


def take_snapshot(brain: RatSlam) -> BrainSnapshot:
    """The whole state, copied: the brain may go on."""
    writer = _Writer()
    return BrainSnapshot({"format": FORMAT, "brain": writer.encode(brain)}, writer.arrays)


def restore_snapshot(snapshot: BrainSnapshot) -> RatSlam:
    """A brain in this state. ValueError when the snapshot is of another format or of another version's classes."""
    if snapshot.tree.get("format") != FORMAT:
        raise ValueError(f"format must be {FORMAT}, got {snapshot.tree.get('format')!r}: made by another version")
    brain = _Reader(snapshot.arrays).decode(snapshot.tree.get("brain"))
    if not isinstance(brain, RatSlam):
        raise ValueError(f"a snapshot must hold a RatSlam, got {type(brain).__name__}")
    fresh = _layout(RatSlam(brain.params, np.random.default_rng(0)))
    for kind, names in _layout(brain).items():
        if names != fresh.get(kind, names):
            odd = ", ".join(sorted(names ^ fresh[kind]))
            raise ValueError(f"{kind} differs in {odd}: the snapshot was made by another version")
    return brain


def save_brain(brain: RatSlam, path: Path | str) -> None:
    """Write a brain to one file (.npz: arrays, and JSON as bytes). What was there is replaced only once all is written."""
    path = Path(path)
    part = path.with_name(path.name + ".part")
    try:
        with part.open("wb") as file:
            write_snapshot(take_snapshot(brain), file)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def load_brain(path: Path | str) -> RatSlam:
    """The brain that `save_brain` wrote. ValueError names the file and what is wrong with it."""
    try:
        with Path(path).open("rb") as file:
            return read_brain(file)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror or error}") from None
    except ValueError as error:
        raise ValueError(f"{path} is {error}") from None


def write_snapshot(snapshot: BrainSnapshot, file: IO[bytes]) -> None:
    """What `save_brain` writes, into an open file."""
    head = {"digest": snapshot.digest(), **snapshot.tree}
    named: dict[str, Any] = {f"a{k}": array for k, array in enumerate(snapshot.arrays)}
    np.savez_compressed(file, json=np.frombuffer(json.dumps(head).encode(), np.uint8), **named)


def read_brain(file: IO[bytes]) -> RatSlam:
    """The brain in an open file. ValueError says what is wrong with it."""
    try:
        with np.load(file, allow_pickle=False) as npz:
            tree = json.loads(npz["json"].tobytes())
            arrays = [npz[f"a{k}"] for k in range(len(npz.files) - 1)]
        found = tree.pop("digest")
        snapshot = BrainSnapshot(tree, arrays)
        if found != snapshot.digest():
            raise ValueError("its digest does not fit what it holds: it was changed or damaged")
        return restore_snapshot(snapshot)
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, EOFError, zipfile.BadZipFile) as error:
        raise ValueError(f"no brain that can be taken back: {error}") from None


class _Writer:
    def __init__(self) -> None:
        self.arrays: list[NDArray] = []
        self._seen: dict[int, tuple[Any, int]] = {}  # keeps what it has seen alive, so that no id comes twice

    def encode(self, value: Any) -> Any:
        if value is None or isinstance(value, bool | str) or type(value) is int:
            return value
        if type(value) is float:
            return value if math.isfinite(value) else {"float": repr(value)}
        if isinstance(value, tuple | list):
            return {type(value).__name__: [self.encode(item) for item in value]}
        if id(value) in self._seen:
            return {"same": self._seen[id(value)][1]}
        number = len(self._seen)
        self._seen[id(value)] = (value, number)
        if isinstance(value, np.ndarray | np.generic):
            self.arrays.append(np.array(value))
            return {"array": len(self.arrays) - 1, "number": number}
        if isinstance(value, dict):
            return {"dict": [[self.encode(k), self.encode(v)] for k, v in value.items()], "number": number}
        if isinstance(value, np.random.Generator):
            return {"generator": value.bit_generator.state, "number": number}
        kind = type(value)
        if not kind.__module__.startswith(ROOM):
            raise TypeError(f"a brain must not hold a {kind.__module__}.{kind.__name__}")
        state = {name: self.encode(item) for name, item in _attributes(value).items()}
        return {"object": f"{kind.__module__}:{kind.__name__}", "number": number, "state": state}


class _Reader:
    def __init__(self, arrays: list[NDArray]) -> None:
        self._arrays = arrays
        self._made: dict[int, Any] = {}

    def decode(self, tree: Any) -> Any:
        if not isinstance(tree, dict):
            return tree
        if "float" in tree:
            return float(tree["float"])
        if "same" in tree:
            return self._made[tree["same"]]
        for kind in (tuple, list):
            if kind.__name__ in tree:
                return kind(self.decode(item) for item in tree[kind.__name__])
        made: Any
        if "array" in tree:
            array = self._arrays[tree["array"]]
            made = array.copy() if array.ndim else array[()]
        elif "generator" in tree:
            made = np.random.default_rng()
            made.bit_generator.state = tree["generator"]
        elif "dict" in tree:
            made = self._made[tree["number"]] = {}
            made.update({self.decode(k): self.decode(v) for k, v in tree["dict"]})
        else:
            return self._object(tree)
        self._made[tree["number"]] = made
        return made

    def _object(self, tree: dict[str, Any]) -> Any:
        module, _, name = tree["object"].partition(":")
        if not module.startswith(ROOM):
            raise ValueError(f"{tree['object']} is none of the engine's classes")
        kind = getattr(importlib.import_module(module), name)
        if not isinstance(kind, type) or kind.__module__ != module:
            raise ValueError(f"{tree['object']} is none of the engine's classes")
        made = self._made[tree["number"]] = object.__new__(kind)
        for attribute, item in tree["state"].items():
            object.__setattr__(made, attribute, self.decode(item))
        if hasattr(kind, "__post_init__"):
            made.__post_init__()  # ranges of parameters
        return made


def _attributes(value: Any) -> dict[str, Any]:
    if dataclasses.is_dataclass(value):
        return {item.name: getattr(value, item.name) for item in dataclasses.fields(value)}
    return {name: None if name in getattr(value, "CACHES", ()) else item for name, item in vars(value).items()}


def _layout(value: Any, known: dict[str, set[str]] | None = None) -> dict[str, set[str]]:
    """The attributes of every class of the engine that is reached from here."""
    known = {} if known is None else known
    kind = type(value)
    if kind.__module__.startswith(ROOM) and kind.__name__ not in known:
        attributes = _attributes(value)
        known[kind.__name__] = set(attributes)
        for item in attributes.values():
            _layout(item, known)
    return known
