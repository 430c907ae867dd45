"""A file that is there whole or not at all: written beside its place, forced to the disk, then put there in one step."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
import time
from collections.abc import Generator
from pathlib import Path
from typing import BinaryIO

_OURS = ".saving-ratslam-"
OLD_S = 60.0  # nobody writes to a file for a minute without a change to it: who began it has died


@contextlib.contextmanager
def whole_file(path: Path | str) -> Generator[BinaryIO, None, None]:
    """Open for writing; it takes the place of `path` when the block ends well, else all is as before. OSError names `path`.

    A device or a pipe is written to as it is, and of a link what it leads to is replaced.
    """
    target = Path(os.path.realpath(path))
    with _naming(path):
        if target.exists() and not target.is_file():
            with target.open("wb") as file:
                yield file
            return
        sweep(target.parent, _OURS)
        temporary = target.with_name(_OURS + secrets.token_hex(8))
        try:
            with temporary.open("xb") as file:
                yield file
                file.flush()
                _keep_mode(target, file.fileno())
                os.fsync(file.fileno())
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)
        _sync_folder(target.parent)


def write_whole(path: Path | str, text: str) -> None:
    """`text` as a file, whole or not at all. OSError names it."""
    with whole_file(path) as file:
        file.write(text.encode("utf-8"))


def sweep(folder: Path, beginning: str = ".saving-") -> None:
    """Remove what somebody began to write here and did not finish before dying."""
    with contextlib.suppress(OSError):
        for left in folder.glob(f"{beginning}*"):
            if time.time() - left.stat().st_mtime > OLD_S:
                left.unlink()


@contextlib.contextmanager
def _naming(path: Path | str) -> Generator[None, None, None]:
    """A full disk does not say whose it is, and nobody knows the name of the temporary file."""
    try:
        yield
    except OSError as error:
        error.filename, error.filename2 = str(path), None
        raise


def _keep_mode(target: Path, handle: int) -> None:
    """Who may read the file stays as it was; a new one is as the person's umask has it."""
    with contextlib.suppress(FileNotFoundError):
        os.fchmod(handle, stat.S_IMODE(target.stat().st_mode))


def _sync_folder(folder: Path) -> None:
    """So that the new name outlasts a power cut. Not all file systems can; the file is in its place all the same."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def require_writable(option: str, file: Path | None) -> None:
    """Before the work, not after it: whether an option's file can be written. ValueError says why not."""
    if file is None:
        return
    folder = file.absolute().parent
    if not folder.is_dir():
        raise ValueError(f"{option} {file}: there is no folder {folder}")
    if file.is_dir():
        raise ValueError(f"{option} {file}: this is a folder; name a file in it")
    if not os.access(file if file.exists() and not file.is_file() else folder, os.W_OK):
        raise ValueError(f"{option} {file}: you may not write to {folder}; choose another place")
