"""The newest state beside a run: to go on from there, instead of from its beginning. Hashes and files of the engine's copies
of a session take their time, so they have a thread of their own."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from app.run_record.folder import STATE
from app.run_record.reader import KeptRun
from app.session import Session
from app.session_snapshot import load_session, save_copy


@dataclass(frozen=True, slots=True)
class Copy:
    """The state after a tick. texts: `Source.world_texts`."""

    tick: int
    time_s: float
    texts: tuple[str, str]
    session: Session


SAVE_EVERY_S = 60.0  # simulated time ...
SAVE_PAUSE_S = 10.0  # ... and wall time between two files of states, at least
SAVE_SHARE = 0.0025  # of the time may go into such files


class States:
    """Takes one copy at a time; those that come meanwhile are dropped, and only the hash of a moment is missing."""

    def __init__(self, folder: Path, hashed: Callable[[int, str, int, float], object]) -> None:
        """hashed: is given tick, hash, number of experiences, and the computing time of the hash in seconds, from the thread.
        The newest state lies in the folder."""
        self._folder, self._hashed = folder, hashed
        self._saved_s, self._saved_at, self._pause_s = 0.0, time.monotonic(), SAVE_PAUSE_S
        self._thread: threading.Thread | None = None

    def take(self, copy: Copy) -> None:
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._work, args=(copy,), name="state keeper", daemon=True)
            self._thread.start()

    def finish(self, patience_s: float) -> None:
        if self._thread is not None:
            self._thread.join(patience_s)

    def _work(self, copy: Copy) -> None:
        began, session = time.thread_time(), copy.session
        tick, time_s = copy.tick, copy.time_s
        hash_ = session.digest(copy.texts)
        hashed_at = time.thread_time()
        self._hashed(tick, hash_, len(session.brain.experience_map), hashed_at - began)
        if time_s - self._saved_s < SAVE_EVERY_S or time.monotonic() - self._saved_at < self._pause_s:
            return
        self._saved_s, self._saved_at = time_s, time.monotonic()
        with contextlib.suppress(OSError, ValueError):
            save_copy(copy.texts, session, self._folder / STATE)
        # When that failed, the older state stays, and the orders are enough: the run's file complains of a full disk.
        self._pause_s = max(SAVE_PAUSE_S, (time.thread_time() - hashed_at) / SAVE_SHARE)


def newest_state(run: KeptRun) -> Session | None:
    """The session in the state that was kept last; None when there is none, or one that the run's hashes do not know: no other
    state is taken up. ValueError: its recording cannot be played."""
    begun = None if run.header.recording is None else run.begin()
    try:
        session = load_session(run.folder / STATE, begun)
    except ValueError:
        return None
    return session if run.hashes.get(session.tick_count) == session.state_hash() else None
