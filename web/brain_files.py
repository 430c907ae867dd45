"""A brain as a file that a person can keep: what `--save-brain` writes and `--brain` reads."""

from __future__ import annotations

import io
import zipfile

from ratslam_core import RatSlam
from ratslam_core.brain_snapshot import BrainSnapshot, read_brain, write_snapshot

MAX_UNPACKED_BYTES = 1 << 30


def packed(snapshot: BrainSnapshot) -> bytes:
    """Takes a while; not for the event loop."""
    file = io.BytesIO()
    write_snapshot(snapshot, file)
    return file.getvalue()


def unpacked(data: bytes) -> RatSlam:
    """ValueError says what is wrong with the file. Takes a while; not for the event loop."""
    if not data:
        raise ValueError("no brain that can be taken back: the file is empty")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as file:
            size = sum(entry.file_size for entry in file.infolist())
    except (zipfile.BadZipFile, ValueError) as error:
        raise ValueError(
            f"no brain that can be taken back: {str(error).lower()}; it has to be one that was saved"
        ) from None
    if size > MAX_UNPACKED_BYTES:
        raise ValueError(f"too large: {size >> 20} MiB unpacked, at most {MAX_UNPACKED_BYTES >> 20} can be")
    return read_brain(io.BytesIO(data))
