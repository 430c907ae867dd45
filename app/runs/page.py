"""One run on its way to the disk: makes its folder, turns what the engine tells into lines, and survives a full disk. Hashes
and files of the engine's copies of a session take their time, so they have a thread of their own. A branch is a run of
its own, with the other's past up to where it left it."""

from __future__ import annotations

import contextlib
import os
import shutil
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path

from app.code_version import code_version
from app.order_book import Order
from app.runs.book import Book, Copy, Ended, Fork, Hashed, Marked, Told
from app.runs.bookmarks import write_bookmarks
from app.runs.folder import BRAIN, STATE, runs_folder
from app.runs.header import header_of, written
from app.runs.journal import Journal, LineBook
from app.runs.run_file import KeptRun, open_run
from app.session_snapshot import save_copy
from disk import encode, whole_file, write_state

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


def copy_until(run: KeptRun, tick: int, folder: Path) -> KeptRun:
    """Write the run up to the end of this tick, without the orders given then, into a new folder.

    ValueError: it is not known so far. OSError: the disk does not take it.
    """
    if not 0 <= tick <= run.last_tick:
        raise ValueError(f"the run {run.name} is known up to tick {run.last_tick}, not {tick}")
    journal = Journal(folder)
    try:
        journal.add(written(replace(run.header, made_at=time.time())))
        lines = LineBook(journal, run.header.world, 0)
        orders = [order for order in run.orders if order.tick < tick][::-1]
        for done in range(tick):
            while orders and orders[-1].tick == done:
                lines.order(orders.pop())
            lines.tick(done + 1, run.pulse(done + 1))
            if done + 1 in run.hashes:
                lines.hash(done + 1, run.hashes[done + 1], run.experiences or 0)
        lines.flush()
    finally:
        journal.close()
    if run.header.brain:
        shutil.copyfile(run.folder / BRAIN, folder / BRAIN)
    return open_run(folder)


STATES_PATIENCE_S = 0.5  # a run is whole without its newest hash and state
_numbers = count(1)


class Page:
    """Use it from one thread. No error leaves it: what cannot be kept is told of once, and the run goes on."""

    def __init__(self, book: Book, complain: Callable[[str], object]) -> None:
        self._book, self._complain = book, complain
        self._complained = self._given_up = False
        self._end = "the program ended"
        self._folder = Path()  # none yet
        self._journal: Journal | None = None
        try:
            self._begin(book)
        except (OSError, ValueError) as error:
            self._give_up(error)

    def write(self) -> None:
        """Write what was told since the last time."""
        told = self._book.told
        while told and not self._given_up:
            self._try(self._take, told.popleft())
        if self._given_up:
            told.clear()
        else:
            self._try(self._lines.flush)

    def finish(self) -> None:
        """Write the rest and close the file. A run without a tick or an order leaves nothing."""
        self.write()
        if self._journal is None:
            return
        self._states.finish(STATES_PATIENCE_S)
        self.write()
        if not self._given_up:  # what comes after an order that is missing cannot be run again
            self._try(self._lines.end, self._end)
        self._journal.close()
        if self._lines.is_empty:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _begin(self, book: Book) -> None:
        self._folder = runs_folder()
        beginning = book.beginning
        if isinstance(beginning, Fork):
            beginning = _forked(beginning)
        # Both take their time: a program that is killed before leaves nothing, not a file of nothing.
        version = code_version()
        header = None if isinstance(beginning, KeptRun) else header_of(beginning)
        if isinstance(beginning, KeptRun):
            self._folder = beginning.folder
            self._journal = Journal(self._folder, beginning.size, beginning.check)
            self._lines = LineBook(
                self._journal, beginning.world_text, beginning.last_tick, len(beginning.orders), beginning.edited_bytes
            )
        else:
            self._folder = new_folder()
            self._journal = Journal(self._folder)
            self._lines = LineBook(self._journal, beginning.world, 0)
            if book.brain is not None:
                with whole_file(self._folder / BRAIN) as file:
                    write_state(encode(book.brain), file)
        book.folder = self._folder
        if self._journal.without_locks:
            self._complain(f"{self._folder.parent} has no file locks: the run is kept there, but do not go on with it in two "
                           "programs at once; RATSLAM_RUNS names another folder")  # fmt: skip
        self._states = States(self._folder, self._hashed)
        if isinstance(beginning, KeptRun):
            self._try(self._lines.again, version)
        if header is not None:
            self._try(self._journal.add, written(header))

    def _hashed(self, tick: int, state_hash: str, experiences: int, cost_s: float) -> None:
        self._book.hash_cost_s = cost_s
        self._book.told.append(Hashed(tick, state_hash, experiences))

    def _take(self, told: Told) -> None:
        match told:
            case (tick, pulse):
                self._lines.tick(tick, pulse)
            case Order():
                self._lines.order(told)
            case Copy():
                self._states.take(told)
            case Hashed():
                self._lines.hash(told.tick, told.state_hash, told.experiences)
            case Marked():
                self._try(write_bookmarks, told.rows, self._folder)
            case Ended():
                self._end = told.why

    def _try(self, write: Callable[..., object], *values: object) -> None:
        try:
            write(*values)
        except OSError as error:  # it waits in the journal
            self._tell(f"the run cannot be kept in {self._folder}: {error.strerror or error}; it goes on, and is kept "
                       "when there is room")  # fmt: skip
        except ValueError as error:
            self._give_up(error)

    def _give_up(self, error: Exception) -> None:
        why = error.strerror if isinstance(error, OSError) else None
        self._given_up = True
        self._book.end("given up")
        where = f" in {self._folder}" if self._folder.name else ""
        self._tell(f"the run is not kept{where}: {why or error}; it goes on")

    def _tell(self, words: str) -> None:
        if not self._complained:
            self._complained = True
            self._complain(words)


def new_folder() -> Path:
    """A folder for a run that begins; it does not exist yet."""
    return runs_folder() / f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}-{next(_numbers)}"


def _forked(fork: Fork) -> KeptRun:
    """ValueError: the run that it goes on from is not on the disk."""
    if fork.of.folder is None:
        raise ValueError("the run that it goes on from could not be kept")
    before = open_run(fork.of.folder)
    return before if fork.tick is None else copy_until(before, fork.tick, new_folder())
