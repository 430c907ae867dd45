"""A digest of a recording on the disk, to tell whether it is still the one that a run was made from. [ours]

A small file counts as a whole; of a large one its length and pieces from all over it, since bags may have many gigabytes.
test_kept_recordings.py.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from app.recordings.formats.airsim import FILE as AIRSIM
from app.recordings.formats.donkey import MANIFEST

WHOLE_BYTES = 64 << 20  # of files up to this size everything counts
PIECE_BYTES, PIECES = 1 << 20, 32


def fingerprint(path: Path) -> str:
    """SHA-256 over the names, lengths and contents of all files that belong to it. OSError: one cannot be read."""
    whole = hashlib.sha256()
    home = path if path.is_dir() else path.parent
    for file in files_of(path):
        size = file.stat().st_size
        whole.update(f"{file.relative_to(home).as_posix()}\0{size}\0".encode())
        with file.open("rb") as data:
            if size <= WHOLE_BYTES:
                whole.update(data.read())
                continue
            for k in range(PIECES):
                data.seek(k * (size - PIECE_BYTES) // (PIECES - 1))
                whole.update(data.read(PIECE_BYTES))
    return whole.hexdigest()


def files_of(path: Path) -> list[Path]:
    """The files of a recording, in the order of their names: those of a folder; or a file and the table beside it."""
    if not path.is_dir():
        if path.name in (AIRSIM, MANIFEST):
            return files_of(path.parent)
        table = path.with_suffix(".csv")
        return [path, *([table] if table != path and table.is_file() else [])]
    return sorted(file for file in path.rglob("*") if file.is_file())
