"""A whole brain as a state and as a file. A restored brain goes on as if it had never stopped.

Users of other RatSLAM implementations have asked for this: to save a map and to navigate with it later. A brain that
breaks one of its laws (`laws/`) is never returned.
"""

from __future__ import annotations

from pathlib import Path
from typing import IO

from disk import State, copy_state, decode, encode
from disk.archive import BROKEN
from disk.state_file import load_as, read_as, save_state
from disk.state_reading import words_of
from ratslam_core import laws
from ratslam_core.slam import RatSlam


def take_snapshot(brain: RatSlam) -> State:
    """The whole state as a copy, so that the brain may go on.

    A caller that must not wait makes the copy (`copy_state`) itself and encodes it in another thread.
    """
    return encode(copy_state(brain))


def restore_snapshot(snapshot: State) -> RatSlam:
    """A brain in this state. ValueError when the format is another, when its classes are another version's, or when it
    breaks a law."""
    try:
        return _checked(State(snapshot.tree, [array.copy() for array in snapshot.arrays]))
    except BROKEN as error:
        raise ValueError(words_of(error)) from None


def save_brain(brain: RatSlam, path: Path | str) -> None:
    """Write a brain to one file (.npz: arrays, and JSON as bytes). An existing file is replaced only after all is written.

    OSError names the file; ValueError: the brain is too large to be read again.
    """
    save_state(take_snapshot(brain), path)


def load_brain(path: Path | str) -> RatSlam:
    """The brain that `save_brain` wrote. ValueError names the file and what is wrong with it."""
    return load_as("brain", path, _checked)


def read_brain(file: IO[bytes]) -> RatSlam:
    """The brain in an open file. ValueError says what is wrong with it."""
    return read_as("brain", file, _checked)


def _checked(state: State) -> RatSlam:
    """The brain in this state, checked. It keeps the state's arrays instead of copying them."""
    brain = decode(state)
    if not isinstance(brain, RatSlam):
        raise ValueError(f"a snapshot must hold a RatSlam, got {type(brain).__name__}")
    laws.check(brain)
    return brain
