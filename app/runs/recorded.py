"""The run of a recording: it begins with the recording, which lies where it lay, rather than with a world."""

from __future__ import annotations

from pathlib import Path
from typing import cast

from app.played_session import PlayedSession
from app.recordings.apart import ReadApart
from app.recordings.fingerprint import fingerprint
from app.recordings.playing import Player
from app.runs.header import Header
from disk import decode
from disk.state_file import load_as


def recorded(name: str, header: Header) -> PlayedSession:
    """The session of the run of this name before its first tick. ValueError: its recording has moved, has changed, or cannot
    be played."""
    kept = header.recording
    assert kept is not None
    path = Path(kept.path)
    whose = f"the run {name} plays the recording {path}"
    try:
        if not path.exists():
            raise ValueError(f"{whose}, which is not there any more: put it back to go on with the run")
        same = fingerprint(path) == kept.digest
    except OSError as error:
        raise ValueError(f"{whose}, which cannot be read: {error.strerror or error}") from None
    if not same:
        raise ValueError(f"{whose}, which has changed since: the run cannot be played again")
    return PlayedSession(Player(ReadApart(path), header.seed, header.config, path), header.seed)


def state_of(file: Path, begun: PlayedSession, hashes: dict[int, str]) -> PlayedSession | None:
    """The session in the state that was kept in a file; None when there is none, or one that the run's hashes do not know:
    no other state is taken up. begun: plays the same recording."""
    try:
        parts: object = load_as("session", file, decode)
    except ValueError:
        return None
    session = cast("tuple[object, ...]", parts)[-1] if isinstance(parts, tuple) else None
    if not isinstance(session, PlayedSession) or hashes.get(session.tick_count) != session.digest(("", "")):
        return None
    session.settle((), begun)
    return session
