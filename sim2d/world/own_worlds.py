"""Worlds that the user has saved: files in a folder of their own, known by name."""

from __future__ import annotations

import contextlib
import json
import re
from functools import lru_cache
from pathlib import Path

from disk import sweep, user_folder, whole_file, write_whole
from disk.words import plain

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,39}")
NAME_RULE = "1 to 40 letters, digits, - and _, beginning with a letter or digit"


def folder() -> Path:
    """It need not exist. ValueError if there is no home."""
    return user_folder("worlds")


def is_name(name: str) -> bool:
    """Whether a world can be saved under this name. A path is not a name."""
    return _NAME.fullmatch(name) is not None


def path_of(name: str) -> Path | None:
    """The file of a world of this name, whether it exists or not; None if this is not a valid name."""
    return folder() / f"{name}.json" if is_name(name) else None


def tidy() -> None:
    """Remove temporary files left by a program that died while saving."""
    with contextlib.suppress(ValueError):
        sweep(folder())


def names() -> tuple[tuple[str, str], ...]:
    """(name, title) of all saved worlds, sorted by name."""
    try:
        where = folder()
    except ValueError:  # no home directory, so no saved worlds
        return ()
    found = (path for path in where.glob("*.json") if is_name(path.stem))
    return tuple(sorted((path.stem, _title(path)) for path in found))


def save(name: str, text: str) -> Path:
    """Write a world file. The old one is kept as `NAME.json.before`. ValueError says why it cannot be written.

    A crash at any moment leaves either the old file or the new one, and a copy of the old one that is complete or
    missing.
    """
    path = path_of(name)
    if path is None:
        raise ValueError(f"a name has {NAME_RULE}, got {name!r}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        tidy()
        if path.exists():
            with whole_file(path.with_name(f"{path.name}.before")) as before:
                before.write(path.read_bytes())
        write_whole(path, text)
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror or error}") from None
    return path


def delete(name: str) -> Path:
    """Delete a saved world. Its file is kept as `NAME.json.deleted`. ValueError says why it cannot be deleted."""
    path = _existing(name)
    try:
        path.replace(_deleted(path))
    except OSError as error:
        raise ValueError(f"{path}: cannot be deleted: {error.strerror or error}") from None
    return _deleted(path)


def restore(name: str) -> str:
    """Restore the world of this name that was deleted last; its title. ValueError says why it cannot be."""
    path = path_of(name)
    if path is None or not _deleted(path).is_file():
        raise ValueError(f"no world {name!r} has been deleted")
    if path.exists():
        raise ValueError(f"there is another world {name!r} by now; delete it or save it under another name first")
    try:
        _deleted(path).replace(path)
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror or error}") from None
    return _title(path)


def _existing(name: str) -> Path:
    path = path_of(name)
    if path is None or not path.is_file():
        known = ", ".join(known for known, _ in names()) or "none, since nothing has been saved"
        raise ValueError(f"no saved world {name!r}; expected one of: {known}")
    return path


def _deleted(path: Path) -> Path:
    return path.with_name(f"{path.name}.deleted")


def _title(path: Path) -> str:
    try:
        about = path.stat()
        return _title_in(path, about.st_mtime_ns, about.st_size, about.st_ino)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return f"{path.stem} (cannot be read)"


@lru_cache(maxsize=256)
def _title_in(path: Path, *_changed: int) -> str:
    """The title in a file, read again only after a change: the editor asks for all titles often."""
    return plain(json.loads(path.read_text("utf-8"))["title"], 80)
