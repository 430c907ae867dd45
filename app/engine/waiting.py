"""Ticks that somebody waits for: so many, worked off one by one, so that other commands come in between; or, for
`run_until`, as fast as possible to the very tick in which something happens."""

from __future__ import annotations

from collections import deque

from app.engine.supervisor import Supervisor
from app.protocol.conditions import Until, Waiting
from app.session import Session
from app.views.history import History
from web.messages import Request, UntilState, UntilView


class Steps:
    """The requests that wait for ticks. A request is answered when its ticks are done or broken off."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[Request, int]] = deque()

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def add(self, request: Request, ticks: int) -> None:
        self._waiting.append((request, ticks))

    def ticked(self) -> list[Request]:
        """One tick is done. Returns the request that this completes, if any."""
        request, left = self._waiting.popleft()
        if left > 1:
            self._waiting.appendleft((request, left - 1))
            return []
        return [request]

    def end(self) -> list[Request]:
        """Drop all remaining ticks. Returns the requests that still waited for them."""
        ended = [request for request, _ in self._waiting]
        self._waiting.clear()
        return ended


class RunUntil(Supervisor):
    """[ours] A run is the same, whether it is waited for something or not. test_run_until.py."""

    def __init__(self, until: Until, within_s: float, session: Session, history: History) -> None:
        """ValueError: it cannot happen, as things are."""
        self._waiting, self._session, self._history = Waiting(until, session, history), session, history
        self._began_s, self._within_s, self._words = session.time_s, within_s, until.words
        self._state: UntilState = "running"

    @property
    def runs_ahead(self) -> bool:
        return self._state == "running"

    def after_tick(self) -> None:
        if not self.runs_ahead:
            return
        passed_s = self._session.time_s - self._began_s
        if self._waiting.met():
            self._end("met", f"{self._words}, after {passed_s:.1f} s")
        elif passed_s >= self._within_s - 1e-9:
            self._end("too late", f"it did not happen within {self._within_s:g} s: {self._words}")

    def stop_running_ahead(self) -> None:
        if self.runs_ahead:
            self._state = "broken off"

    def view(self) -> UntilView:
        share = (self._session.time_s - self._began_s) / self._within_s
        return UntilView(self._waiting.until.what, self._words, self._state, min(1.0, share))

    def _end(self, state: UntilState, words: str) -> None:
        self._state, self.pause_requested = state, True
        self._history.log.note("lesson" if state == "met" else "warning", words)
