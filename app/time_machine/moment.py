"""A moment of a run, made again: a session and its history, which go on exactly as they once did."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from app.order_book import carry_out
from app.session import Session
from app.time_machine.branch import Branch, Keyframe
from app.views.history import History
from app.views.tick_stages import TickRecorder
from disk import decode


class Moment:
    """What is shown of the past. The branch is left as it is."""

    def __init__(self, branch: Branch, tick: int) -> None:
        """That of the last keyframe at or before this tick; `go_to` or `going` leads on to the tick."""
        self.branch = branch
        owner = branch.at(tick)
        self.session, self.history = _restored(owner.keyframe(tick), branch)

    @property
    def tick_count(self) -> int:
        return self.session.tick_count

    def go_to(self, tick: int) -> None:
        """Go on to a later tick: its end, before the orders that came after it."""
        for _ in self.going(tick):
            pass

    def going(self, tick: int) -> Iterator[float]:
        """The same in steps. Yields the share of the way that is done."""
        first = self.tick_count
        while self.tick_count < tick:
            self.tick()
            yield (self.tick_count - first) / (tick - first)

    def tick(self, recorder: TickRecorder | None = None) -> None:
        """Run the next tick, with the orders that were given before it."""
        for order in self.branch.at(self.tick_count + 1).orders_after(self.tick_count):
            carry_out(self.session, order)
        self.session.tick(recorder)
        self.history.watch()


def _restored(keyframe: Keyframe, branch: Branch) -> tuple[Session, History]:
    session, history = cast("tuple[Session, History]", decode(keyframe.state.state()))
    session.settle(keyframe.worlds, branch.session)
    history.settle(session, branch.history.log.until(session.time_s, session), keyframe.last_snap)
    return session, history
