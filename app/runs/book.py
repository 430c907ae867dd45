"""What the engine tells of a run while it runs: its ticks, its orders, now and then a copy of its state. It waits for
nobody."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from app.order_book import Order
from app.runs.header import Beginning, pulse_of
from app.runs.run_file import KeptRun
from app.session import Session
from disk import copy_state
from ratslam_core import RatSlam
from web.messages import Bookmark

COPY_EVERY_S = 10.0  # simulated time between two copies of the state, at least
COPY_SHARE = 0.0025  # of the time may go into copies and their hashes; both grow dearer as the map grows
LOOK_AFTER = 10  # ticks between two looks whether a copy is due


@dataclass(frozen=True, slots=True)
class Copy:
    """The state after a tick. texts: `Source.world_texts`."""

    tick: int
    time_s: float
    texts: tuple[str, str]
    session: Session


@dataclass(frozen=True, slots=True)
class Hashed:
    """The `state_hash` after a tick, from the thread that makes hashes of copies."""

    tick: int
    state_hash: str
    experiences: int


@dataclass(frozen=True, slots=True)
class Marked:
    """All bookmarks of the run, as they are now."""

    rows: tuple[Bookmark, ...]


@dataclass(frozen=True, slots=True)
class Ended:
    why: str


@dataclass(frozen=True, slots=True)
class Fork:
    """A run begins where another was after this tick, before its orders then; without a tick it goes on with the other."""

    of: Book
    tick: int | None = None


Told: TypeAlias = "tuple[int, bytes] | Order | Copy | Hashed | Marked | Ended"  # a tick and its pulse


class Book:
    """The run of one session. What is told waits in `told` for the keeper's thread."""

    def __init__(
        self, session: Session, beginning: Beginning | KeptRun | Fork, brain: RatSlam | None = None,
        tell: Callable[[], object] = lambda: None,
    ) -> None:  # fmt: skip
        """beginning: of the run, or the kept run that goes on. brain: a copy of the one it begins with. tell: is called
        when something is told that should not be lost."""
        self.beginning, self.brain = beginning, brain
        self.folder: Path | None = None  # once something of it is on the disk
        self.told: deque[Told] = deque()
        self.hash_cost_s = 0.0  # of the last copy, as the thread that made it tells
        self._tell, self._open = tell, True
        self._copied_s, self._cost_s, self._at = session.time_s, 0.0, time.monotonic()

    def tick(self, session: Session) -> None:
        """The session has run a tick. Its orders for the next one have not been given yet."""
        if not self._open:
            return
        self.told.append((session.tick_count, pulse_of(session)))
        if session.tick_count % LOOK_AFTER == 0 and self._is_due(session):
            began = time.thread_time()
            self.told.append(Copy(session.tick_count, session.time_s, session.source.world_texts, copy_state(session)))
            self._cost_s = time.thread_time() - began
            self._copied_s, self._at = session.time_s, time.monotonic()

    def order(self, order: Order) -> None:
        if self._open:
            self.told.append(order)
            self._tell()

    def mark(self, rows: tuple[Bookmark, ...]) -> None:
        if self._open:
            self.told.append(Marked(rows))
            self._tell()

    def end(self, why: str) -> None:
        if self._open:
            self._open = False
            self.told.append(Ended(why))
            self._tell()

    def _is_due(self, session: Session) -> bool:
        """[ours] Wall time decides only how often the state is kept, never what it is.

        test_kept_runs.py::test_it_comes_out_the_same.
        """
        if session.time_s - self._copied_s < COPY_EVERY_S - 1e-9:
            return False
        return self._cost_s + self.hash_cost_s <= COPY_SHARE * (time.monotonic() - self._at)
