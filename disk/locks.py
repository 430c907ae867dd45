"""Locks of files between programs, and what a file system without them says."""

from __future__ import annotations

import errno
import tempfile
from pathlib import Path
from typing import IO

try:
    import fcntl
except ImportError:  # a system without such locks: two programs are not told apart there
    fcntl = None

# Any other error says that there are no locks, as an NFS without its lock daemon does.
_HELD = (errno.EAGAIN, errno.EACCES)


def lock(file: IO[bytes], *, shared: bool = False) -> bool | None:
    """Keep other programs from writing to this file until it is closed. shared: only look whether one is writing.

    False: another one is writing to it. None: the file system has no locks, so that nobody can tell.
    """
    if fcntl is None:
        return None
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError as error:
        return False if error.errno in _HELD else None
    return True


def require_record_locks(folder: Path, what: str) -> None:
    """ValueError: the folder is on a file system without the locks that SQLite takes. what: needs them, and the way out."""
    if fcntl is None:
        return
    with tempfile.TemporaryFile(dir=folder) as file:  # not the file itself: to close it gives up all locks on it
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in _HELD:
                raise ValueError(f"{folder} has no file locks ({error.strerror}), which {what}") from None
