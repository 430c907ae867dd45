"""One line of a run: its end, the keyframes on it, and the orders in between. With these any moment can be made again."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field

from app.order_book import Order
from app.session import Session
from app.time_machine.kept_state import KeptState
from app.views.history import History
from sim2d import World
from web.messages import Snap


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """A session and its history at the end of a tick, before the orders that came after it."""

    tick: int
    time_s: float
    dt: float
    state: KeptState
    worlds: tuple[World, ...]  # as `Session.worlds`
    last_snap: Snap | None


@dataclass(slots=True, eq=False)
class Branch:
    """A line of time. It has its parent's past up to `from_tick`, and its own keyframes and orders from there on."""

    number: int
    session: Session  # at its end
    history: History
    parent: Branch | None = None
    from_tick: int = 0
    keyframes: list[Keyframe] = field(default_factory=list[Keyframe])  # by tick, the first at from_tick
    orders: list[Order] = field(default_factory=list[Order])

    @property
    def end_tick(self) -> int:
        return self.session.tick_count

    def at(self, tick: int) -> Branch:
        """This branch or the one of its forebears that a moment is on."""
        branch = self
        while branch.parent is not None and tick < branch.from_tick:
            branch = branch.parent
        return branch

    def keyframe(self, tick: int) -> Keyframe:
        """The last one of this very branch at or before a tick."""
        return self.keyframes[max(0, bisect_right(self.keyframes, tick, key=lambda frame: frame.tick) - 1)]

    def orders_after(self, tick: int) -> list[Order]:
        """Those of this very branch that were carried out after this tick and before the next."""
        first = bisect_right(self.orders, tick - 1, key=lambda order: order.tick)
        return self.orders[first : bisect_right(self.orders, tick, key=lambda order: order.tick)]
