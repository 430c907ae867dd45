"""One run on its way to the disk: makes its folder, turns what the engine tells into lines, and survives a full disk."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

from app.order_book import Order
from app.runs.book import Book, Copy, Ended, Fork, Hashed, Marked, Told
from app.runs.bookmarks import write_bookmarks
from app.runs.folder import BRAIN, runs_folder
from app.runs.fork import copy_until
from app.runs.header import header_of, written
from app.runs.journal import Journal
from app.runs.line_book import LineBook
from app.runs.run_file import KeptRun, open_run
from app.runs.states import States
from app.trials.code_version import code_version
from disk import encode, whole_file, write_state

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
