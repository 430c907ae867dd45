"""Hashes and files of the copies that the engine makes of a session, from a thread of their own: both take their time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path

from app.runs.book import Copy
from app.runs.folder import STATE
from app.session import digest_of
from app.session_snapshot import save_copy

SAVE_EVERY_S = 60.0  # simulated time ...
SAVE_PAUSE_S = 10.0  # ... and wall time between two files of states


class States:
    """Takes one copy at a time; those that come meanwhile are dropped, and only the hash of a moment is missing."""

    def __init__(self, folder: Path, hashed: Callable[[int, str, int], object]) -> None:
        """hashed: is given tick, hash and number of experiences, from the thread. The newest state lies in the folder."""
        self._folder, self._hashed = folder, hashed
        self._saved_s, self._saved_at = 0.0, -SAVE_PAUSE_S
        self._thread: threading.Thread | None = None

    def take(self, copy: Copy) -> None:
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._work, args=(copy,), name="state keeper", daemon=True)
            self._thread.start()

    def finish(self, patience_s: float) -> None:
        if self._thread is not None:
            self._thread.join(patience_s)

    def _work(self, copy: Copy) -> None:
        session = copy.session
        time_s = session.simulator.observe().time_s
        tick, experiences = session.simulator.observe().tick, len(session.brain.experience_map)
        self._hashed(tick, digest_of(copy.texts, session), experiences)
        if time_s - self._saved_s < SAVE_EVERY_S or time.monotonic() - self._saved_at < SAVE_PAUSE_S:
            return
        self._saved_s, self._saved_at = time_s, time.monotonic()
        try:
            save_copy(copy.texts, session, self._folder / STATE)
        except (OSError, ValueError):
            return  # the older state stays, and the orders are enough: the run's file complains of a full disk
