"""The newest state beside a run: to go on from there instead of from its beginning, or to take its brain into another run.
Hashes and files of the engine's copies of a session take their time, so they have a thread of their own.

The comment of a file's first zip entry says what the brain in it is from; it can be read without unpacking the file.
"""

from __future__ import annotations

import contextlib
import json
import threading
import time
import zipfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from app.run_record.folder import STATE, all_runs
from app.run_record.reader import KeptRun
from app.session import Session
from app.session_snapshot import load_session, state_of
from disk import whole_file, write_state

SAVE_EVERY_S = (
    60.0  # simulated time; a younger brain is soon learnt again, and would be offered instead of an older one ...
)
SAVE_PAUSE_S = 10.0  # ... and wall time between two files of states, at least
SAVE_SHARE = 0.0025  # of the time may go into such files
HEAD = "json.npy"


@dataclass(frozen=True, slots=True)
class Copy:
    """The state after a tick. texts: `Source.world_texts`. world: its name; empty: a recording plays. last: nothing comes
    after it, so it is saved whenever the one before was."""

    tick: int
    time_s: float
    texts: tuple[str, str]
    session: Session
    world: str
    last: bool = False


@dataclass(frozen=True, slots=True)
class About:
    """What a kept brain is from."""

    world: str
    seed: int
    time_s: float  # simulated
    experiences: int
    kept_at: float  # seconds since 1970


class States:
    """Takes one copy at a time; those that come meanwhile are dropped, and only the hash of a moment is missing."""

    def __init__(
        self, folder: Path, hashed: Callable[[int, str, int, float], object], complain: Callable[[str], object]
    ) -> None:
        """hashed: is given tick, hash, number of experiences, and the computing time of the hash in seconds, from the thread.
        complain: is given a sentence, from there, too. The newest state lies in the folder."""
        self._folder, self._hashed, self._complain = folder, hashed, complain
        self._complained: str | None = None
        self._saved_s, self._saved_at, self._pause_s = 0.0, time.monotonic(), SAVE_PAUSE_S
        self._thread: threading.Thread | None = None

    def take(self, copy: Copy, patience_s: float = 0.0) -> None:
        """patience_s: how long the last copy waits for the one before."""
        if self.finish(patience_s if copy.last else 0.0):
            self._thread = threading.Thread(target=self._work, args=(copy,), name="state keeper", daemon=True)
            self._thread.start()

    def finish(self, patience_s: float) -> bool:
        """Wait until the copy that was taken is saved. False: it takes longer."""
        if self._thread is not None:
            self._thread.join(patience_s)
        return self._thread is None or not self._thread.is_alive()

    def _work(self, copy: Copy) -> None:
        began, session = time.thread_time(), copy.session
        hash_, experiences = session.digest(copy.texts), len(session.brain.experience_map)
        hashed_at = time.thread_time()
        self._hashed(copy.tick, hash_, experiences, hashed_at - began)
        if not self._is_due(copy):
            return
        self._saved_s, self._saved_at = copy.time_s, time.monotonic()
        with contextlib.suppress(OSError):  # the older one stays; the run's file complains of a full disk
            self._save(copy, About(copy.world, session.seed, copy.time_s, experiences, time.time()))
        self._pause_s = max(SAVE_PAUSE_S, (time.thread_time() - hashed_at) / SAVE_SHARE)

    def _is_due(self, copy: Copy) -> bool:
        if copy.last:
            return copy.time_s >= SAVE_EVERY_S
        return copy.time_s - self._saved_s >= SAVE_EVERY_S and time.monotonic() - self._saved_at >= self._pause_s

    def _save(self, copy: Copy, about: About) -> None:
        state = state_of(copy.texts, copy.session)
        try:
            with whole_file(self._folder / STATE) as file:
                write_state(state, file, json.dumps(asdict(about)))
        except ValueError as error:
            self._complain_once("size", f"the brain cannot be kept: {error}")
        else:
            self._complain_once("growth", state.outgrowing)

    def _complain_once(self, about: str, words: str | None) -> None:
        """Once, until there is another complaint or none."""
        if words and about != self._complained:
            self._complain(words)
        self._complained = about if words else None


def newest_state(run: KeptRun) -> Session | None:
    """The session in the state that was kept last; None when there is none, or one that the run's hashes do not know: no other
    state is taken up. ValueError: its recording cannot be played."""
    begun = None if run.header.recording is None else run.begin()
    try:
        session = load_session(run.folder / STATE, begun)
    except ValueError:
        return None
    return session if run.hashes.get(session.tick_count) == session.state_hash() else None


@dataclass(frozen=True, slots=True)
class KeptBrain:
    """The brain in the state of a run. path: of that; `load_its_brain` reads it."""

    path: Path
    about: About

    @property
    def words(self) -> str:
        a = self.about
        day = "%H:%M" if time.time() - a.kept_at < 12 * 3600 else "%Y-%m-%d %H:%M"
        when = time.strftime(day, time.localtime(a.kept_at))
        return f"a brain of {a.world}, seed {a.seed}, {a.time_s / 60:.0f} min, {a.experiences} experiences, kept {when}"


def newest_brain() -> KeptBrain | None:
    """The brain that was kept last, in an office: a recorded place cannot be opened again."""
    found = [kept for run in all_runs() if (kept := _read(run / STATE)) is not None and kept.about.world]
    return max(found, key=lambda kept: kept.about.kept_at, default=None)


def _read(path: Path) -> KeptBrain | None:
    """What is kept in a file, without unpacking it; None if it cannot be read."""
    try:
        with zipfile.ZipFile(path) as archive:
            return KeptBrain(path, About(**json.loads(archive.getinfo(HEAD).comment)))
    except (OSError, ValueError, TypeError, KeyError, zipfile.BadZipFile):
        return None
