"""Files that are written whole or not at all: beside their place, forced to the disk, then moved there in one step."""

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
OLD_S = 60.0  # a file that has not changed for a minute is no longer being written: its writer has died


@contextlib.contextmanager
def whole_file(path: Path | str) -> Generator[BinaryIO, None, None]:
    """A file open for writing. It replaces `path` when the block ends well; otherwise nothing changes. OSError names `path`.

    A device or a pipe is written to directly. If `path` is a link, the file it leads to is replaced.
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
    """Write `text` to a file, wholly or not at all. OSError names the file."""
    with whole_file(path) as file:
        file.write(text.encode("utf-8"))


def sweep(folder: Path, beginning: str = ".saving-") -> None:
    """Remove files in this folder whose writers died before finishing them."""
    with contextlib.suppress(OSError):
        for left in folder.glob(f"{beginning}*"):
            if time.time() - left.stat().st_mtime > OLD_S:
                left.unlink()


@contextlib.contextmanager
def _naming(path: Path | str) -> Generator[None, None, None]:
    """Make errors name `path`: a full disk names no file, and nobody knows the name of the temporary one."""
    try:
        yield
    except OSError as error:
        error.filename, error.filename2 = str(path), None
        raise


def _keep_mode(target: Path, handle: int) -> None:
    """Keep the permissions of the file that is replaced; a new one gets those of the person's umask."""
    with contextlib.suppress(FileNotFoundError):
        os.fchmod(handle, stat.S_IMODE(target.stat().st_mode))


def _sync_folder(folder: Path) -> None:
    """Make the new name outlast a power cut. Not all file systems can do that; the file is in its place all the same."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def require_writable(option: str, file: Path | None) -> None:
    """Check, before the work and not after it, that an option's file can be written. ValueError says why not."""
    if file is None:
        return
    folder = file.absolute().parent
    if not folder.is_dir():
        raise ValueError(f"{option} {file}: there is no folder {folder}")
    if file.is_dir():
        raise ValueError(f"{option} {file}: this is a folder; name a file in it")
    if not os.access(file if file.exists() and not file.is_file() else folder, os.W_OK):
        raise ValueError(f"{option} {file}: you may not write to {folder}; choose another place")
