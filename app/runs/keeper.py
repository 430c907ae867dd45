"""Keeps every run of the engine in a folder of its own, from a thread of its own. The engine never waits for the disk."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from pathlib import Path

from app.runs.book import Book, Fork
from app.runs.folder import BUDGET_MB, tidy
from app.runs.header import Beginning
from app.runs.page import Page
from app.runs.run_file import KeptRun
from app.session import Session
from ratslam_core import RatSlam

LOOK_EVERY_S = 0.5  # wall time; a crash loses no more ticks than that
LEAVING_S = 5.0  # how long leaving waits for the disk


class RunKeeper:
    """`book`, `begin` and `stop` are called by the engine's thread or whoever starts and ends it."""

    def __init__(self, complain: Callable[[str], object], budget_mb: float = BUDGET_MB) -> None:
        """complain: is given a sentence when something cannot be kept, from the keeper's thread."""
        self._complain, self._budget_mb = complain, budget_mb
        self._begun: queue.SimpleQueue[Book] = queue.SimpleQueue()
        self._book: Book | None = None  # of the run that goes on, in the engine's thread
        self._told, self._leaving = threading.Event(), False
        self._thread = threading.Thread(target=self._work, name="run keeper", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """End the run that goes on, after the engine has ended. A disk that hangs is not waited for longer than LEAVING_S."""
        if self._book is not None:
            self._book.end("the program ended")
        self._leaving = True
        self._told.set()
        if self._thread.ident is not None:
            self._thread.join(LEAVING_S)

    @property
    def folder(self) -> Path | None:
        """Where the run that goes on is kept; None: not yet, or it cannot be."""
        return None if self._book is None else self._book.folder

    def book(self, session: Session, beginning: Beginning | KeptRun | Fork, brain: RatSlam | None = None) -> Book:
        """A book for a session that has just begun. brain: a copy of the brain it began with. Nothing is kept before
        `begin`."""
        return Book(session, beginning, brain, self._told.set)

    def begin(self, book: Book) -> None:
        """Another run takes the place of the one that went on."""
        if self._book is not None:
            self._book.end("another run began")
        self._book = book
        self._begun.put(book)
        self._told.set()

    # ------------------------------------------------------------ the thread

    def _work(self) -> None:
        page: Page | None = None
        leaving = False
        while not leaving:
            self._told.wait(LOOK_EVERY_S)
            self._told.clear()
            leaving = self._leaving  # what was told before that is still written
            while not self._begun.empty():
                if page is not None:
                    page.finish()
                page = Page(self._begun.get(), self._complain)
                tidy(self._budget_mb)
            if page is not None:
                page.write()
        if page is not None:
            page.finish()
