"""Running a kept run again: does it come out the same, and where was it when it was left? That of a recording begins with
the recording, which lies where it lay, rather than with a world."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import cast

from app.recordings.apart import ReadApart
from app.recordings.opening import fingerprint
from app.recordings.playing import Player
from app.runs.folder import STATE
from app.runs.header import Header, pulse_of
from app.runs.run_file import KeptRun
from app.session import Session, played_session
from app.session_snapshot import load_session
from disk import decode
from disk.state_file import load_as

TELL_AFTER = 10  # ticks between two calls of `tell`
Tell = Callable[[float], object]  # simulated seconds since the last call


class ReplayError(ValueError):
    """A run came out differently from how it was kept. tick: the first one after which that was seen."""

    def __init__(self, run: KeptRun, tick: int, what: str) -> None:
        self.tick = tick
        header = run.header
        by = "this version" if header.same_program else f"another version ({header.version})"
        super().__init__(
            f"the run {run.name} comes out differently from tick {tick} on ({what}); it was made by {by} of the "
            f"program, with Python {header.python} and numpy {header.numpy} on {header.platform}"
        )


def replay(run: KeptRun, tell: Tell = lambda _s: None) -> Session:
    """Run it again from its beginning and compare each pulse and each hash. Returns the session at its end, with all orders.

    ReplayError: it comes out differently. ValueError: it cannot be run again.
    """
    return _to_the_end(run, run.play(), tell)


def resumed(run: KeptRun, tell: Tell = lambda _s: None) -> Session:
    """The session where the run was when it was left: from the newest state beside it, else from its beginning.

    ReplayError: it comes out differently. ValueError: it cannot be run again.
    """
    return _to_the_end(run, run.play(session=newest_state(run)), tell)


def newest_state(run: KeptRun) -> Session | None:
    """The session in the state that was kept last; None when there is none, or one that the run's hashes do not know."""
    if run.header.recording is not None:
        return state_of(run.folder / STATE, recorded(run.name, run.header), run.hashes)
    try:
        session = load_session(run.folder / STATE)
    except ValueError:
        return None
    return session if run.hashes.get(session.tick_count) == session.state_hash() else None


def _to_the_end(run: KeptRun, sessions: Iterator[Session], tell: Tell) -> Session:
    first = session = next(sessions)
    began = first.tick_count
    if began:
        tell(first.time_s)  # what need not be run again is done
    for session in sessions:
        tick = session.tick_count
        if pulse_of(session) != run.pulse(tick):
            raise ReplayError(run, tick, "the robot or what it sees is elsewhere")
        if tick in run.hashes and session.state_hash() != run.hashes[tick]:
            raise ReplayError(run, tick, "its state has another hash")
        if (tick - began) % TELL_AFTER == 0:
            tell(TELL_AFTER * session.frame.dt)
    return session


def recorded(name: str, header: Header) -> Session:
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
    return played_session(Player(ReadApart(path), header.seed, header.config, path), header.seed)


def state_of(file: Path, begun: Session, hashes: dict[int, str]) -> Session | None:
    """The session in the state that was kept in a file; None when there is none, or one that the run's hashes do not know:
    no other state is taken up. begun: plays the same recording."""
    try:
        parts: object = load_as("session", file, decode)
    except ValueError:
        return None
    session = cast("tuple[object, ...]", parts)[-1] if isinstance(parts, tuple) else None
    if not isinstance(session, Session) or session.digest(("", "")) not in hashes.values():
        return None
    session.settle((), begun)
    return session
