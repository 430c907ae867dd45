"""The past of a run, kept while it runs: any moment can be looked at again, and gone on from as another branch. [ours]

No paper has this: a run is the same bit for bit, so keyframes now and then on each branch and the orders in between are
enough to make a moment again, and to go on from it exactly as it once did. test_time_machine.py.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from app.orders import Order, overtakes
from app.run_record.chunks import Chunks, KeptState
from app.run_record.record import orders_at, replay
from app.run_record.spill_file import SpillFile
from app.session import Session
from app.views.history import History
from app.views.tick_stages import TickRecorder
from disk import decode, encode
from sim2d import World
from web.messages import Snap


class Moment:
    """What is shown of the past. The branch is left as it is."""

    def __init__(self, branch: Branch, tick: int) -> None:
        """That of the last keyframe at or before this tick; `go_to` or `going` leads on to the tick."""
        self.branch = branch
        self.session, self.history = _restored(branch.at(tick).keyframe(tick), branch)
        self._replay = replay(self.session, branch.orders_after)
        next(self._replay)

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
        self._replay.send(recorder)
        self.history.watch()


def _restored(keyframe: Keyframe, branch: Branch) -> tuple[Session, History]:
    session, history = cast("tuple[Session, History]", decode(keyframe.state.state()))
    session.settle(keyframe.worlds, branch.session)
    history.settle(session, branch.history.log.until(session.time_s, session), keyframe.last_snap)
    return session, history


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """A session and its history at the end of a tick, before the orders that came after it."""

    tick: int
    time_s: float
    dt: float
    state: KeptState
    worlds: tuple[World, ...]  # as `Source.worlds`
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

    def orders_after(self, tick: int) -> Sequence[Order]:
        """Those that were carried out after this tick and before the next, wherever that is on."""
        return orders_at(self.at(tick + 1).orders, tick)


EVERY_TICKS = 100  # between two keyframes, until there are too many
AGAIN_MS, LOOK_AFTER = 200.0, 10  # the moments of some recordings take long: so much is run again at most
BUDGET_BYTES, DISK_BYTES = 200_000_000, 2_000_000_000
IN_MEMORY = 0.8  # of the budget: from here on the oldest goes to the disk, and has time to get there
MOST_BRANCHES = 12


@dataclass(frozen=True, slots=True)
class PastRoom:
    """What keyframes may take. folder: for those that memory has no room for; None: they are thinned instead."""

    memory_bytes: int = BUDGET_BYTES
    disk_bytes: int = DISK_BYTES
    folder: Path | None = None

    def spill_file(self) -> SpillFile | None:
        return None if self.folder is None else SpillFile(self.folder, self.disk_bytes)


class TimeMachine:
    """Call `ticked` after each tick of the live session, and `note_order` for each order that it carried out."""

    def __init__(self, session: Session, history: History, room: PastRoom | None = None) -> None:
        """The session must be at the beginning of what can be gone back to."""
        room = room or PastRoom()
        self._chunks, self._budget_bytes = Chunks(room.spill_file()), room.memory_bytes
        self.live = Branch(1, session, history, from_tick=session.tick_count)
        self.branches = [self.live]
        self._keep()

    @property
    def nbytes(self) -> int:
        """Of all keyframes, in memory."""
        return self._chunks.nbytes + self._chunks.copy_nbytes

    @property
    def disk_nbytes(self) -> int:
        """Of what memory had no room for."""
        return self._chunks.spilled_nbytes

    def note_order(self, order: Order) -> None:
        orders = self.live.orders
        if orders and overtakes(order, orders[-1]):
            orders[-1] = order
        else:
            orders.append(order)

    def ticked(self) -> None:
        if self._is_due():
            self._keep()

    def tick_at(self, time_s: float) -> int:
        """The tick of the live branch that ends at this simulated time, or the nearest."""
        known = self.live.session.source.tick_at(time_s)
        if known is not None:
            return max(self.branches[0].from_tick, known)
        owner = self.live
        while owner.parent is not None and time_s < owner.keyframes[0].time_s:
            owner = owner.parent
        first = max(0, bisect_right(owner.keyframes, time_s + 1e-9, key=lambda frame: frame.time_s) - 1)
        frame = owner.keyframes[first]
        return frame.tick + max(0, round((time_s - frame.time_s) / frame.dt))

    def moment(self, branch: Branch, tick: int, near: Moment | None = None) -> Moment:
        """A moment of a branch. near: another one; if it is on the way to this, it goes on to it. ValueError names what
        can be gone to."""
        moment = self.on_the_way(branch, tick, near) or Moment(branch, tick)
        moment.go_to(tick)
        return moment

    def on_the_way(self, branch: Branch, tick: int, near: Moment | None) -> Moment | None:
        """`near`, if it can go on to this moment and no keyframe is nearer. ValueError names what can be gone to."""
        root = self.branches[0].from_tick
        if not root <= tick <= branch.end_tick:
            raise ValueError(f"tick must be from {root} to {branch.end_tick}, got {tick}")
        if (
            near is not None
            and near.branch is branch
            and branch.at(tick).keyframe(tick).tick <= near.tick_count <= tick
        ):
            return near
        return None

    def go_on_from(self, moment: Moment) -> Branch:
        """Make the moment the end of a new branch, which is then the live one. The moment must not be used again."""
        if len(self.branches) >= MOST_BRANCHES:
            raise ValueError(f"there are {MOST_BRANCHES} branches already; reset the run to begin without any")
        tick = moment.tick_count
        parent = moment.branch.at(tick)
        moment.history.settle(
            moment.session,
            moment.branch.history.log.until(moment.session.time_s, moment.session),
            moment.history.events.last_snap,
        )
        self.live = Branch(self.branches[-1].number + 1, moment.session, moment.history, parent, tick)
        self.branches.append(self.live)
        self._keep()
        return self.live

    def change_to(self, number: int) -> Branch:
        """Make this branch the live one. ValueError names those that there are."""
        self.live = self.branch(number)
        return self.live

    def branch(self, number: int) -> Branch:
        """The branch of this number. ValueError names those that there are."""
        for branch in self.branches:
            if branch.number == number:
                return branch
        raise ValueError(f"there is no branch {number}; there are 1 to {len(self.branches)}")

    def _is_due(self) -> bool:
        """[ours] Wall time decides only how often a recording's state is kept, never what it is. test_going_back.py."""
        session, since = self.live.session, self.live.end_tick - self.live.keyframes[-1].tick
        if since >= EVERY_TICKS or not session.source.slow:
            return since >= EVERY_TICKS
        mean_ms = sum(mean for mean, _ in session.stopwatch.mean_and_worst_ms.values())
        return since > 0 and since % LOOK_AFTER == 0 and since * mean_ms >= AGAIN_MS

    def _keep(self) -> None:
        live = self.live
        kept = self._chunks.keep(encode((live.session, live.history)))
        session, frame, snap = live.session, live.session.frame, live.history.events.last_snap
        live.keyframes.append(Keyframe(frame.tick, frame.time_s, frame.dt, kept, session.source.worlds, snap))
        self._chunks.make_room(int(IN_MEMORY * self._budget_bytes) - self._chunks.copy_nbytes)
        while self.nbytes > self._budget_bytes and self._thin():
            pass

    def _thin(self) -> bool:
        """Drop the keyframe that is missed least: where they lie closest together, and of these the oldest."""
        gaps = [
            (branch.keyframes[i + 1].tick - branch.keyframes[i - 1].tick, branch.keyframes[i].tick, branch.number, i)
            for branch in self.branches
            for i in range(1, len(branch.keyframes) - 1)
        ]
        if not gaps:
            return False
        _, _, number, i = min(gaps)
        branch = next(branch for branch in self.branches if branch.number == number)
        self._chunks.drop(branch.keyframes.pop(i).state)
        return True
