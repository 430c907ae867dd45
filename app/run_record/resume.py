"""Running a kept run again: does it come out the same, and where was it when it was left?"""

from __future__ import annotations

from collections.abc import Callable

from app.run_record.reader import KeptRun
from app.run_record.record import tick_checksum
from app.run_record.states import newest_state
from app.session import Session

REPORT_AFTER = 10  # ticks between two calls of `progress`
Progress = Callable[[float], object]  # simulated seconds since the last call


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


def resumed(run: KeptRun, progress: Progress = lambda _s: None) -> Session:
    """The session where the run was when it was left: from the newest state beside it, else from its beginning.

    ReplayError: it comes out differently. ValueError: it cannot be run again.
    """
    return replayed(run, progress, newest_state(run))


def replayed(run: KeptRun, progress: Progress = lambda _s: None, session: Session | None = None) -> Session:
    """Run it again, from its beginning or from this session on, and compare each checksum and each hash. Returns the session at
    its end, with all orders.

    ReplayError: it comes out differently. ValueError: it cannot be run again.
    """
    sessions = run.replay(session=session)
    session = next(sessions)
    began = session.tick_count
    if began:
        progress(session.time_s)  # what need not be run again is done
    for session in sessions:
        tick = session.tick_count
        if tick_checksum(session) != run.checksum(tick):
            raise ReplayError(run, tick, "the robot or what it sees is elsewhere")
        if tick in run.hashes and session.state_hash() != run.hashes[tick]:
            raise ReplayError(run, tick, "its state has another hash")
        if (tick - began) % REPORT_AFTER == 0:
            progress(REPORT_AFTER * session.frame.dt)
    return session
