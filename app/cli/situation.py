"""A situation that is named on the command line: by the path of its file, or by its link."""

from __future__ import annotations

from pathlib import Path

from app.situations import Situation, read_situation
from app.situations.writing import KEY
from disk.limits import SITUATION_BYTES


def situation_in(name: str) -> Situation:
    """ValueError says why it cannot be opened."""
    if f"{KEY}=" in name:
        return read_situation(name)
    try:
        with Path(name).open("rb") as file:
            text = file.read(SITUATION_BYTES + 1).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise ValueError(
            f"--situation {name[:80]}: {reason}; give the file of a situation, or a link with #{KEY}= in quotes"
        ) from None
    try:
        return read_situation(text)
    except ValueError as error:
        raise ValueError(f"--situation {name[:80]}: {error}") from None
