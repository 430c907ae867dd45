"""A run on its way to the disk while it goes on, through three threads, none of which the engine waits for: the engine gives
ticks, orders and now and then a copy of the session to a `RunFeed`; the keeper's thread turns them into the lines of a
`LogWriter`; copies are hashed and saved in a third (states.py). A branch is a run of its own, with the other's past up to
where it left it."""

from __future__ import annotations

import os
import queue
import shutil
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

from app.code_version import code_version
from app.orders import Order
from app.run_record.bookmarks import write_bookmarks
from app.run_record.folder import BRAIN, BUDGET_MB, runs_folder, tidy
from app.run_record.header import Beginning, header_of, written
from app.run_record.reader import KeptRun, open_run
from app.run_record.record import tick_checksum
from app.run_record.run_log import LogFile, RunLog
from app.run_record.states import Copy, States
from app.session import Session
from disk import copy_state, encode, whole_file, write_state
from web.messages import Bookmark

COPY_EVERY_S = 10.0  # simulated time between two copies of the state, at least
COPY_SHARE = 0.0025  # of the time may go into copies and their hashes; both grow dearer as the map grows
LOOK_AFTER = 10  # ticks between two looks whether a copy is due


@dataclass(frozen=True, slots=True)
class Fork:
    """A run begins where another was after this tick, before its orders then; without a tick it goes on with the other."""

    of: RunFeed
    tick: int | None = None


class RunFeed:
    """The log entries of the run of one session. It waits in `entries` for the keeper's thread."""

    def __init__(
        self, session: Session, beginning: Beginning | KeptRun | Fork, on_entry: Callable[[], object] = lambda: None
    ) -> None:
        """beginning: of the run, or the kept run that goes on. on_entry: is called at an entry that should not be
        lost."""
        self.beginning = beginning
        self.folder: Path | None = None  # once something of it is on the disk
        self.entries: deque[Callable[[LogWriter], object]] = deque()
        self.hash_cost_s = 0.0  # of the last copy, measured by the thread that made it
        self._on_entry, self._open = on_entry, True
        self._ordered_at = session.tick_count  # the tick of the last order
        self._copied_s, self._cost_s, self._at = session.time_s, 0.0, time.monotonic()

    def tick(self, session: Session) -> None:
        """The session has run a tick. Its orders for the next one have not been given yet."""
        if not self._open:
            return
        self.enter_tick(session.tick_count, tick_checksum(session))
        if session.tick_count % LOOK_AFTER == 0 and self._is_due(session):
            began = time.thread_time()
            self._copy(session, copy_state(session))
            self._cost_s = time.thread_time() - began
            self._copied_s, self._at = session.time_s, time.monotonic()

    def enter_tick(self, tick: int, checksum: bytes) -> None:
        self.entries.append(lambda writer: writer.tick(tick, checksum))

    def order(self, order: Order) -> None:
        if self._open:
            self._ordered_at = order.tick
            self.entries.append(lambda writer: writer.order(order))
            self._on_entry()

    def leave(self, session: Session) -> None:
        """Nobody runs the session any more. After an order that no tick has followed its state is none of the log."""
        if self._open and self._ordered_at != session.tick_count:
            self._copy(session, session, last=True)

    def mark(self, rows: tuple[Bookmark, ...]) -> None:
        if self._open:
            self.entries.append(lambda writer: writer.mark(rows))
            self._on_entry()

    def end(self, why: str) -> None:
        if self._open:
            self._open = False
            self.entries.append(lambda writer: writer.end(why))
            self._on_entry()

    def _copy(self, session: Session, copy: Session, *, last: bool = False) -> None:
        source = session.source
        world = source.worlds[-1].name if source.worlds else ""
        kept = Copy(session.tick_count, session.time_s, source.world_texts, copy, world, last)
        self.entries.append(lambda writer: writer.copy(kept))

    def _is_due(self, session: Session) -> bool:
        """[ours] Wall time decides only how often the state is kept, never what it is.

        test_kept_runs.py::test_it_comes_out_the_same.
        """
        if session.time_s - self._copied_s < COPY_EVERY_S - 1e-9:
            return False
        return self._cost_s + self.hash_cost_s <= COPY_SHARE * (time.monotonic() - self._at)


STATES_PATIENCE_S = 4.0  # a run is whole without its newest hash and state
_numbers = count(1)


class LogWriter:
    """Writes one run. Use it from one thread. No error leaves it: what cannot be kept is reported once, and the run goes on."""

    def __init__(self, feed: RunFeed, complain: Callable[[str], object]) -> None:
        self._feed, self._complain = feed, complain
        self._complained = self._given_up = False
        self._end = "the program ended"
        self._folder = Path()  # none yet
        self._file: LogFile | None = None
        try:
            self._begin(feed)
        except (OSError, ValueError) as error:
            self._give_up(error)

    def write(self) -> None:
        """Write the entries made since the last call."""
        entries = self._feed.entries
        while entries and not self._given_up:
            self._try(entries.popleft(), self)
        if self._given_up:
            entries.clear()
        else:
            self._try(self._log.flush)

    def finish(self) -> None:
        """Write the rest and close the file. A run without a tick or an order leaves nothing."""
        self.write()
        if self._file is None:
            return
        if not self._states.finish(STATES_PATIENCE_S):
            self._complain("the brain cannot be written in time; the one kept last stays")
        self.write()
        if not self._given_up:  # what comes after an order that is missing cannot be run again
            self._try(self._log.end, self._end)
        self._file.close()
        if self._log.is_empty:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _begin(self, feed: RunFeed) -> None:
        self._folder = runs_folder()
        beginning = _forked(feed.beginning) if isinstance(feed.beginning, Fork) else feed.beginning
        if isinstance(beginning, KeptRun):
            self._go_on(beginning)
        else:
            self._begin_anew(beginning)
        assert self._file is not None
        feed.folder = self._folder
        if self._file.without_locks:
            self._complain(f"{self._folder.parent} has no file locks: the run is kept there, but do not go on with it in two "
                           "programs at once; RATSLAM_RUNS names another folder")  # fmt: skip
        self._states = States(self._folder, self._hashed, self._complain)

    def _go_on(self, kept: KeptRun) -> None:
        version = code_version()
        self._folder, rows = kept.folder, kept.rows
        self._file = LogFile(self._folder, kept.size, kept.check)
        self._log = RunLog(self._file, rows.world, kept.tick, len(rows.orders), rows.edited_bytes)
        self._try(self._log.again, version)

    def _begin_anew(self, beginning: Beginning) -> None:
        """The file comes last, and its first line with it: whoever finds it finds a run."""
        header = header_of(beginning)  # takes its time: who is killed before leaves nothing, not a file of nothing
        self._folder = new_folder()
        try:
            self._folder.mkdir(parents=True)
            if beginning.brain is not None:
                with whole_file(self._folder / BRAIN) as file:
                    write_state(encode(beginning.brain), file)
            self._file = LogFile(self._folder)
        except (OSError, ValueError):
            shutil.rmtree(self._folder, ignore_errors=True)  # without its file nobody would find it, to delete it
            raise
        self._log = RunLog(self._file, beginning.world)
        self._try(self._file.add, written(header))

    # ------------------------------------------------------------ the entries

    def tick(self, tick: int, checksum: bytes) -> None:
        self._log.tick(tick, checksum)

    def order(self, order: Order) -> None:
        self._log.order(order)

    def copy(self, copy: Copy) -> None:
        self._states.take(copy, STATES_PATIENCE_S)

    def mark(self, rows: tuple[Bookmark, ...]) -> None:
        """All bookmarks of the run, as they are now."""
        write_bookmarks(rows, self._folder)

    def end(self, why: str) -> None:
        self._end = why

    def _hashed(self, tick: int, state_hash: str, experiences: int, cost_s: float) -> None:
        """Called in the thread that makes hashes of copies."""
        self._feed.hash_cost_s = cost_s
        self._feed.entries.append(lambda writer: writer._log.hash(tick, state_hash, experiences))

    # ------------------------------------------------------------

    def _try(self, write: Callable[..., object], *values: object) -> None:
        try:
            write(*values)
        except OSError as error:  # it waits in the log
            self._complain_once(f"the run cannot be kept in {self._folder}: {error.strerror or error}; it goes on, and is kept "
                       "when there is room")  # fmt: skip
        except ValueError as error:
            self._give_up(error)

    def _give_up(self, error: Exception) -> None:
        why = error.strerror if isinstance(error, OSError) else None
        self._given_up = True
        self._feed.end("given up")
        where = f" in {self._folder}" if self._folder.name else ""
        self._complain_once(f"the run is not kept{where}: {why or error}; it goes on")

    def _complain_once(self, words: str) -> None:
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


def copy_until(run: KeptRun, tick: int, folder: Path) -> KeptRun:
    """Write the run up to the end of this tick, without the orders given then, into a new folder.

    ValueError: it is not known so far. OSError: the disk does not take it.
    """
    if not 0 <= tick <= run.tick:
        raise ValueError(f"the run {run.name} is known up to tick {run.tick}, not {tick}")
    folder.mkdir(parents=True)
    if run.header.brain:
        shutil.copyfile(run.folder / BRAIN, folder / BRAIN)
    file = LogFile(folder)
    try:
        file.add(written(replace(run.header, made_at=time.time())))
        log = RunLog(file, run.header.world)
        for done in range(tick):
            for order in run.orders_after(done):
                log.order(order)
            log.tick(done + 1, run.checksum(done + 1))
            if done + 1 in run.hashes:
                log.hash(done + 1, run.hashes[done + 1], run.experiences or 0)
        log.flush()
    finally:
        file.close()
    return open_run(folder)


LOOK_EVERY_S = 0.5  # wall time; a crash loses no more ticks than that
LEAVING_S = 5.0  # how long leaving waits for the disk


class RunKeeper:
    """Keeps every run of the engine in a folder of its own. `feed`, `begin` and `stop` are called by the engine's thread, or by
    whoever starts and ends it."""

    def __init__(self, complain: Callable[[str], object], budget_mb: float = BUDGET_MB) -> None:
        """complain: is given a sentence when something cannot be kept, from the keeper's thread."""
        self._complain, self._budget_mb = complain, budget_mb
        self._begun: queue.SimpleQueue[RunFeed] = queue.SimpleQueue()
        self._feed: RunFeed | None = None  # of the run that goes on, in the engine's thread
        self._entered, self._leaving = threading.Event(), False
        self._thread = threading.Thread(target=self._work, name="run keeper", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """End the run that goes on, after the engine has ended. A disk that hangs is not waited for longer than LEAVING_S."""
        if self._feed is not None:
            self._feed.end("the program ended")
        self._leaving = True
        self._entered.set()
        if self._thread.ident is not None:
            self._thread.join(LEAVING_S)

    @property
    def folder(self) -> Path | None:
        """Where the run that goes on is kept; None: not yet, or it cannot be."""
        return None if self._feed is None else self._feed.folder

    def feed(self, session: Session, beginning: Beginning | KeptRun | Fork) -> RunFeed:
        """The feed of a session that has just begun. Nothing is kept before `begin`."""
        return RunFeed(session, beginning, self._entered.set)

    def begin(self, feed: RunFeed) -> None:
        """Another run takes the place of the one that went on."""
        if self._feed is not None:
            self._feed.end("another run began")
        self._feed = feed
        self._begun.put(feed)
        self._entered.set()

    # ------------------------------------------------------------ the thread

    def _work(self) -> None:
        writer: LogWriter | None = None
        leaving = False
        while not leaving:
            self._entered.wait(LOOK_EVERY_S)
            self._entered.clear()
            leaving = self._leaving  # entries made before that are still written
            while not self._begun.empty():
                if writer is not None:
                    writer.finish()
                writer = LogWriter(self._begun.get(), self._complain)
                tidy(self._budget_mb)
            if writer is not None:
                writer.write()
        if writer is not None:
            writer.finish()
