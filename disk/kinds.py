"""Which classes a state may hold, and the short versioned name under which each is written: "pose_cells/1", no module path.

A file thus outlives the module that wrote it, and moving a class breaks no file. When the attributes of a class change,
it gets the next number.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from typing import Any, TypeVar

Class = TypeVar("Class", bound=type)
_NAME = re.compile(r"[a-z][a-z0-9_ .-]{0,60}/[1-9][0-9]{0,3}", re.ASCII)
_class_of: dict[str, type] = {}
_name_of: dict[type, str] = {}


def kind(name: str) -> Callable[[Class], Class]:
    """Name a class, `@kind("pose_cells/1")`, so that a state may hold its objects.

    The state of an object is the fields of a dataclass, else all attributes. Those that the class lists in CACHES are
    left out; those in SHARED may be one array in two places.
    """
    if not _NAME.fullmatch(name):
        raise ValueError(f"a kind must be a name and a version, such as 'pose_cells/1', got {name!r}")

    def named(cls: Class) -> Class:
        known = _class_of.get(name)
        if known is not None and (known.__module__, known.__qualname__) != (cls.__module__, cls.__qualname__):
            raise ValueError(
                f"the kind {name!r} is {known.__module__}.{known.__qualname__}; give {cls.__name__} another"
            )
        _class_of[name], _name_of[cls] = cls, name
        return cls

    return named


def is_known(cls: type) -> bool:
    return cls in _name_of


def name_of(cls: type) -> str:
    """The kind of a class. TypeError says how it gets one."""
    if cls not in _name_of:
        raise TypeError(f'a state must not hold a {cls.__module__}.{cls.__name__}: name its class with @kind("name/1")')
    return _name_of[cls]


def class_of(name: object) -> type[Any]:
    """The class of a kind. ValueError when there is none, or one of another version."""
    if isinstance(name, str) and name in _class_of:
        return _class_of[name]
    words = str(name)
    others = [known for known in _class_of if known.split("/")[0] == words.split("/")[0]]
    if others:
        raise ValueError(f"{words} was made by another version of the program, which has {', '.join(sorted(others))}")
    raise ValueError(f"no class is of the kind {words!r}: if it is one of yours, import its file first")


def attributes(value: object) -> dict[str, Any]:
    """The attributes that make up the state of an object. Its caches do not count and are None."""
    if dataclasses.is_dataclass(value):
        return {item.name: getattr(value, item.name) for item in dataclasses.fields(value)}
    return {name: None if name in getattr(value, "CACHES", ()) else item for name, item in vars(value).items()}
