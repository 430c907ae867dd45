"""Looking at the past of a run and going on from it: the moment that is shown, the loop, and the runs of all branches."""

from __future__ import annotations

from collections.abc import Generator

from app.engine.run import Run
from app.engine.work import Work
from app.orders import Order
from app.run_record.comparison import first_difference, side_of
from app.run_record.keyframes import Branch, Moment, PastRoom, TimeMachine
from app.views.tick_stages import TickRecorder
from web.messages import BranchView, Side, TimeView


class TimeTravel:
    """One for each run from reset to reset, with all its branches. The live session is never touched by looking back."""

    def __init__(self, run: Run, room: PastRoom | None = None) -> None:
        """room: for all keyframes."""
        self._machine = TimeMachine(run.session, run.history, room)
        self._runs = {self._machine.live.number: run}
        self._moment: Moment | None = None
        self.past: Run | None = None  # the moment of the past that is shown; None: the present
        self.loop: tuple[float, float] | None = None
        self._beside: Branch | None = None  # the branch that the live one is compared with
        self._other: Moment | None = None  # of that branch
        self._differs = ""
        run.machine = self._machine

    @property
    def last_number(self) -> int:
        """The highest number that a run has."""
        return max(run.number for run in self._runs.values())

    @property
    def _live(self) -> Run:
        return self._runs[self._machine.live.number]

    def origin(self) -> tuple[Run, list[Order]]:
        """The run that all branches began as, and every order from there to what is shown: to the present, with those
        given just now, or to a moment of the past, before those that were given then."""
        branch, moment = self._machine.live, self._moment
        end = branch.end_tick + 1 if moment is None else moment.tick_count
        orders: list[Order] = []
        following: Branch | None = branch
        while following is not None:
            orders = [order for order in following.orders if order.tick < end] + orders
            end, following = min(end, following.from_tick), following.parent
        return self._runs[self._machine.branches[0].number], orders

    # ------------------------------------------------------------ looking back

    def seek(self, tick: int) -> None:
        """Show the end of this tick. The last one is the present. ValueError names those that can be shown."""
        for _ in self.seeking(tick):
            pass

    def seeking(self, tick: int) -> Generator[float]:
        """The same in steps. Yields the share of the way that is done; until all is, what was shown before stays."""
        live = self._machine.live
        if tick == live.end_tick:
            self.back_to_now()
            return
        moment = self._machine.on_the_way(live, tick, self._moment)
        try:
            if moment is None:
                yield 0.0  # whoever asks for another moment meanwhile need not wait until this one is restored
                moment = Moment(live, tick)
            yield from moment.going(tick)
            if moment is not self._moment or self.past is None:
                run, shown = self._live, self.past or self._live
                self.past = Run(run.number, moment.session, shown.snapshots.worlds, moment.history)
                self.past.snapshots.continue_from(shown.snapshots)
                self._moment = moment
            yield from self._beside_at(tick)
        finally:  # the moment that was shown may have gone on, if only a part of the way
            if self.past is not None:
                self.past.snapshots.walk = None
                self.past.snapshots.refresh()
                self._show_events()

    def tick_at(self, time_s: float) -> int:
        """The tick of a simulated time, at most that of the present."""
        return min(self._machine.tick_at(time_s), self._machine.live.end_tick)

    def back_to_now(self) -> None:
        if self.past is not None:
            self._live.snapshots.continue_from(self.past.snapshots)
            self._live.snapshots.refresh()
        self.past = self._moment = None

    def play(self, recorder: TickRecorder | None = None) -> bool:
        """Run the next tick of the past as it once was, or go back to the loop's begin. True if that was the last one."""
        moment, past = self._moment, self.past
        assert moment is not None
        assert past is not None
        if self.loop is not None and moment.session.time_s >= self.loop[1] - 1e-9:
            self.seek(self.tick_at(self.loop[0]))
            return self.past is None
        past.snapshots.walk = None
        moment.tick(recorder)
        if moment.tick_count >= self._machine.live.end_tick:
            self.back_to_now()
            return True
        self._show_events()
        return False

    def _show_events(self) -> None:
        """The timeline shows what is still to come, too."""
        assert self.past is not None
        live = self._live.event_log
        self.past.event_log.events = live.events
        self.past.event_log.why.update(live.why)

    # ------------------------------------------------------------ branches

    def go_on_from_here(self, number: int) -> Run:
        """The run, of this number, that begins as a new branch at the moment that is shown."""
        moment, past = self._moment, self.past
        if moment is None or past is None:
            raise ValueError("this is the present: go back to an earlier moment first")
        branch = self._machine.go_on_from(moment)
        run = Run(number, branch.session, past.snapshots.worlds, branch.history)
        run.snapshots.continue_from(past.snapshots)
        run.machine = self._machine
        run.event_log.note("branch", f"{branch.number} leaves branch {moment.branch.number} here")
        self._runs[branch.number] = run
        self.stop_comparing()
        self.past = self._moment = self.loop = None
        return run

    def change_to(self, number: int) -> Run:
        """The run of this branch, which is then the live one."""
        shown = self.past or self._live
        self._machine.change_to(number)
        self.stop_comparing()
        self.past = self._moment = self.loop = None
        self._live.snapshots.continue_from(shown.snapshots)
        self._live.snapshots.refresh()
        return self._live

    def stop_comparing(self) -> None:
        self._beside, self._other, self._differs = None, None, ""

    def comparing(self, number: int) -> Generator[float]:
        """Show this branch beside the live one. Yields the share of the work that is done. ValueError names those that
        there are."""
        beside = self._machine.branch(number)
        if beside is self._machine.live:
            raise ValueError(f"branch {number} is the live one: it is compared with another")
        differs = yield from first_difference(self._machine.live, beside)
        self._beside, self._other, self._differs = beside, None, differs
        yield from self._beside_at((self.past or self._live).session.tick_count)

    def _beside_at(self, tick: int) -> Generator[float]:
        """Take the branch beside to this tick; None at its end."""
        beside = self._beside
        if beside is not None and tick < beside.end_tick:
            self._other = self._machine.on_the_way(beside, tick, self._other) or Moment(beside, tick)
            yield from self._other.going(tick)

    # ------------------------------------------------------------ for the page

    def view(self, work: Work | None = None) -> TimeView | None:
        """work: that is being done."""
        machine = self._machine
        live = machine.live
        return TimeView(
            past=self.past is not None,
            end_tick=live.end_tick,
            end_s=live.session.time_s,
            begin_s=machine.branches[0].keyframes[0].time_s,
            branch=live.number,
            branches=tuple(map(_view, machine.branches)),
            loop=self.loop,
            sides=self._sides(),
            bookmarks=self._live.bookmarks.rows,
            differs=self._differs,
            doing="" if work is None else work.words,
            done=0.0 if work is None else work.share,
        )

    def _sides(self) -> tuple[Side, ...]:
        """The live branch as it is shown, and the other one at the same tick, or at its end if that was before."""
        machine, beside = self._machine, self._beside
        if beside is None:
            return ()
        shown = self.past or self._live
        tick = shown.session.tick_count
        self._other = machine.moment(beside, tick, self._other) if tick < beside.end_tick else None
        history = beside.history if self._other is None else self._other.history
        return side_of(machine.live, self._moment, shown.history), side_of(beside, self._other, history)


def _view(branch: Branch) -> BranchView:
    parent = None if branch.parent is None else branch.parent.number
    return BranchView(branch.number, parent, branch.keyframes[0].time_s, branch.session.time_s)
