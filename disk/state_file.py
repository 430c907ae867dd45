"""Files of whole states. Errors are sentences that name the file and say what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import IO, TypeVar

from disk.archive import BROKEN
from disk.state_codec import State, write_state
from disk.state_reading import read_state, words_of
from disk.whole_file import whole_file

T = TypeVar("T")


def save_state(state: State, path: Path | str) -> None:
    """Write one file, wholly or not at all. OSError names the file; ValueError: it would be too large to be read again."""
    with whole_file(path) as file:
        write_state(state, file)


def load_as(noun: str, path: Path | str, made: Callable[[State], T]) -> T:
    """The object that `made` makes from the state in a file. ValueError names the file and says what is wrong with it."""
    try:
        with Path(path).open("rb") as file:
            return read_as(noun, file, made)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror or error}") from None
    except ValueError as error:
        raise ValueError(f"{path} is {error}") from None


def read_as(noun: str, file: IO[bytes], made: Callable[[State], T]) -> T:
    """The same from an open file. ValueError says what is wrong with it."""
    try:
        return made(read_state(file))
    except BROKEN as error:
        raise ValueError(f"no {noun} that can be taken back: {words_of(error)}") from None
