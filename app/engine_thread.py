"""The one engine thread: it takes commands between ticks, runs ticks and publishes snapshots. It never waits for a
browser.

It does not die silently: every exception becomes a fault that is shown, and every request gets an answer.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from functools import partial

from app.commands import Later, Working, carry_out
from app.config import Config
from app.engine.engine import Engine
from app.engine.pace import LONGEST_WAIT_S, SLICE_S, Pace
from app.engine.watchdog import Watchdog, words_of
from app.run_record.keyframes import PastRoom
from app.run_record.writer import RunKeeper
from app.session import Session
from ratslam_core import RatSlam
from sim2d import World
from web import messages as m
from web.latest import Latest

STALL_S = 2.0
FIRST_SLICE_S = 0.03  # many moments are gone to within it


class EngineThread:
    """Owns the engine. `submit` may be called from any thread; everything else happens in its own."""

    def __init__(
        self, world: World, seed: int, config: Config, *, speed: float = 1.0, running: bool = True,
        brain: RatSlam | None = None, first: Callable[[Engine], object] | None = None, stall_s: float = STALL_S,
        keeper: RunKeeper | None = None, past_room: PastRoom | None = None,
    ) -> None:  # fmt: skip
        """brain: one that already knows places. first: begins the first run, instead of one in this world with this seed.

        stall_s: a tick that takes longer than this is shown as a fault. keeper: keeps each run on disk.
        past_room: for what looking back takes.
        """
        self.latest: Latest[m.Snapshot] = Latest()
        self.startup_error: str | None = None  # why the engine could not begin; then the thread has ended ...
        self.on_startup_error: Callable[[], object] = lambda: None  # ... and calls this
        self.pace = Pace(speed)
        self._first: Callable[[Engine], object] = first or partial(
            Engine.begin, world=world, seed=seed, config=config, brain=brain
        )
        self._inbox = Inbox()
        self._watchdog = Watchdog(stall_s, self._tell_stall)
        self._engine = Engine(
            world, self.pace, self._watchdog, running=running, answer=self._inbox.answer, keeper=keeper,
            past_room=past_room,
        )  # fmt: skip
        self._stopping = False
        self._thread = threading.Thread(target=self._loop, name="engine", daemon=True)

    @property
    def session(self) -> Session:
        return self._engine.run.session

    def start(self) -> None:
        self._thread.start()

    def stop(self, patience_s: float | None = None) -> None:
        """End the thread after its current tick. patience_s: how long to wait for that tick; None = until it ends."""
        self._stopping = True
        self._inbox.wake()
        if self._thread.ident is not None:  # it was started
            self._thread.join(patience_s)

    def submit(self, command: m.Command | m.EngineRequest) -> Future[m.Accepted | m.Refused]:
        """Hand a command to the engine. The future is answered when the command has taken effect or was refused."""
        return self._inbox.submit(command)

    # ------------------------------------------------------------ the thread

    def _loop(self) -> None:
        if not self._begin():
            return
        while not self._stopping:
            try:
                self._turn()
            except BaseException as error:  # SystemExit, too
                self._engine.fail(error)
                self._publish()
            finally:
                self._inbox.give()
        self._watchdog.stop()
        self._engine.leave()
        self._inbox.close("the engine has ended; start the program again")

    def _begin(self) -> bool:
        """Begin the first run. False if that fails."""
        try:
            self._watchdog.start()
            self._first(self._engine)
            self._publish()
            if self.latest.get()[1] is None:
                raise RuntimeError(self._engine.fault)
        except BaseException as error:
            traceback.print_exc()
            self.startup_error = words_of(error)
            self._watchdog.stop()
            self._inbox.close(f"the engine could not begin: {self.startup_error}")
            self.on_startup_error()
        return self.startup_error is None

    def _turn(self) -> None:
        self._take_requests()
        work = self._engine.slices.work
        given_up = (m.Seek,) if work is not None and work.moves else ()  # for the moment that is gone to now
        if self._inbox.has_news(*given_up):
            self._publish()  # before answering: whoever has the answer and reads the state must see its effect
        self._inbox.give()
        engine, pace, session = self._engine, self.pace, self._engine.shown.session
        if pace.let_go() and self.session.pilot.mode == "manual":
            self.session.drive(0.0, 0.0)
        if engine.slices.work is not None:
            self._work()
        if engine.steps:
            self._step()
        elif engine.runs_ahead:
            if engine.run_ahead(SLICE_S) or pace.progress_due:
                self._publish()
        elif engine.running and pace.due(session.frame.dt) and engine.tick():
            self._publish()
        pace.measure(session.time_s)
        if (engine.running or engine.steps) and not engine.runs_ahead and pace.publishing_due:
            self._publish()

    def _work(self) -> None:
        self._engine.work_on()
        if self._engine.slices.work is None or self.pace.progress_due:
            self._publish()
            self._inbox.give()

    def _step(self) -> None:
        if self._engine.step() or self._inbox.has_answers:
            self._publish()
            self._inbox.give()

    # ------------------------------------------------------------ the queue

    def _take_requests(self) -> None:
        """Carry out all commands that wait. If there are none, sleep until the next tick is due or a command comes."""
        wait = self.pace.wait_s() if self._engine.running else LONGEST_WAIT_S
        while True:
            engine = self._engine
            idle = not (self._inbox.has_answers or engine.steps or engine.runs_ahead or engine.slices.work)
            request = self._inbox.take(min(wait, LONGEST_WAIT_S) if idle else 0.0)
            if request is None:
                return
            engine.slices.first_s = FIRST_SLICE_S if self._inbox.is_empty else 0.0
            self._take(request)

    def _take(self, request: m.Request) -> None:
        """Carry out one request. A command that raises is answered with its error, and the session goes on."""
        try:
            answer = carry_out(self._engine, request.command)
        except BaseException as error:
            self._inbox.answer(request, error)
            if not isinstance(error, Exception):
                raise
            traceback.print_exc()
            return
        if isinstance(answer, Later):
            self._engine.steps.add(request, answer.ticks)
        elif isinstance(answer, Working):
            work = self._engine.slices.work
            assert work is not None
            work.request = request
            self.pace.published()  # how far it has come is shown when it takes long
        else:
            self._inbox.answer(request, answer)

    # ------------------------------------------------------------ publishing

    def _publish(self) -> None:
        """Publish the session as it is now. If that cannot be built, publish the last good snapshot with the fault."""
        try:
            snapshot: m.Snapshot | None = self._engine.snapshot()
        except BaseException as error:
            self._engine.fail(error)
            _, snapshot = self.latest.get()
            if snapshot is not None:
                snapshot = replace(snapshot, running=False, fault=self._engine.fault)
        if snapshot is not None:
            self.latest.put(snapshot)
        self.pace.published()

    def _tell_stall(self) -> None:
        """Publish that the tick hangs. This runs in the watchdog's thread, since the engine's is busy."""
        _, last = self.latest.get()
        if last is not None:
            words = f"the tick is taking more than {self._watchdog.limit_s:g} s; the session goes on when it has ended"
            self.latest.put(replace(last, fault=words))


Answer = m.Accepted | m.Refused | BaseException


class Inbox:
    """`submit` and `wake` may be called from any thread, the rest only from the engine's."""

    def __init__(self) -> None:
        self._requests: queue.SimpleQueue[m.Request | None] = queue.SimpleQueue()
        self._answers: list[tuple[m.Request, Answer]] = []
        self._gate, self._over = threading.Lock(), ""  # why nothing is taken any more

    def submit(self, command: m.Command | m.EngineRequest) -> Future[m.Accepted | m.Refused]:
        answer: Future[m.Accepted | m.Refused] = Future()
        request = m.Request(command, answer)
        with self._gate:
            if not self._over:
                self._requests.put(request)
                return answer
        answer.set_result(_refused(request, self._over))
        return answer

    def wake(self) -> None:
        """End a `take` that is waiting."""
        self._requests.put(None)

    def take(self, patience_s: float) -> m.Request | None:
        """The next request, or None if none comes within `patience_s`."""
        with contextlib.suppress(queue.Empty):
            return self._requests.get(block=patience_s > 0, timeout=max(patience_s, 0.0))
        return None

    @property
    def has_answers(self) -> bool:
        return bool(self._answers)

    @property
    def is_empty(self) -> bool:
        """Whether no request waits."""
        return self._requests.empty()

    def has_news(self, *others: type) -> bool:
        """Whether one of the answers is to what may have changed something that is shown. others: what has not, this
        time."""
        return any(not isinstance(request.command, (*m.READS, *others)) for request, _ in self._answers)

    def answer(self, request: m.Request, answer: Answer) -> None:
        """Keep an answer until the next `give`."""
        self._answers.append((request, answer))

    def give(self) -> None:
        answers, self._answers = self._answers, []
        for request, answer in answers:
            if not request.answer.set_running_or_notify_cancel():
                continue  # whoever asked has cancelled
            if isinstance(answer, BaseException):
                request.answer.set_exception(answer)
            else:
                request.answer.set_result(answer)

    def close(self, why: str) -> None:
        """Take no more requests. Those that wait and those that still come are refused with the sentence `why`."""
        with self._gate:
            self._over = why
        while not self._requests.empty():
            request = self._requests.get()
            if request is not None:
                self.answer(request, _refused(request, why))
        self.give()


def _refused(request: m.Request, why: str) -> m.Refused:
    return m.Refused("type", getattr(request.command, "type", type(request.command).__name__), why)
