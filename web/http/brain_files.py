"""A brain as a file that a person can keep: what `--save-brain` writes and `--brain` reads."""

from __future__ import annotations

import io

from disk import State, write_state
from ratslam_core import RatSlam
from ratslam_core.brain_file import read_brain


def packed(snapshot: State) -> bytes:
    """Takes a while; not for the event loop."""
    file = io.BytesIO()
    write_state(snapshot, file)
    return file.getvalue()


def unpacked(data: bytes) -> RatSlam:
    """ValueError says what is wrong with the file. Takes a while; not for the event loop."""
    return read_brain(io.BytesIO(data))
