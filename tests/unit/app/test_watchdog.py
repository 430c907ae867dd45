"""A tick that hangs is reported while it hangs. Compiling, suspending and a busy machine do not count as hanging."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numba

from app.engine.watchdog import NAPS, Watchdog
from app.engine_thread import EngineThread
from tests.patience import until
from web import messages as m

from .engine_threads import PATIENCE_S, accept, step, wait_for

LONG = 3600.0


def watching(limit_s: float = LONG) -> tuple[Watchdog, list[str]]:
    told = list[str]()
    return Watchdog(limit_s, lambda: told.append("it hangs")), told


def test_a_tick_that_hangs_is_told_of_once_and_between_two_ticks_nothing_hangs() -> None:
    dog, told = watching()
    for _ in range(3):
        dog._note(LONG)
    dog.begin()
    for _ in range(NAPS):
        dog._note(LONG / NAPS)
    assert told == []
    for _ in range(3):
        dog._note(LONG / NAPS)
    assert told == ["it hangs"]
    assert dog.end()
    dog._note(2 * LONG)
    dog.begin()
    assert not dog.end()
    assert told == ["it hangs"]


def test_who_was_suspended_with_the_tick_counts_only_a_nap() -> None:
    """However late the watchdog wakes, it counts one nap, since the whole program may have stood still."""
    naps = []
    dog, _ = watching(0.02)
    dog._note = naps.append  # type: ignore[method-assign]
    dog.start()
    until(lambda: len(naps) >= 20)
    dog.stop()
    assert max(naps) <= 2 * 0.02 / NAPS


def test_compiling_is_no_hanging() -> None:
    dog, told = watching()
    dog.start()
    ages: list[float] = []

    @numba.njit
    def fresh(x: float) -> float:
        return x + 1.5

    plain = dog._compiler.on_start

    def on_start(event: Any) -> None:
        plain(event)
        dog._note(2 * LONG)
        ages.append(dog._age_s or 0.0)

    dog._compiler.on_start = on_start  # type: ignore[method-assign]
    try:
        dog.begin()
        assert fresh(1.0) == 2.5
        assert ages == [0.0] * len(ages) != []
        assert dog._compiler.took_s > 0
        assert not dog._compiler.busy
        assert not dog.end()
        assert told == []
        dog.begin()
        fresh(2.0)
        dog._note(2 * LONG)  # compiled by now
        assert told == ["it hangs"]
    finally:
        dog.stop()


def test_what_holds_the_interpreter_is_noticed_by_its_processor_time() -> None:
    dog, told = watching(0.05)  # not started, so it cannot run
    dog.begin()
    began = time.thread_time()
    while time.thread_time() - began < 0.1:
        pass
    assert told == []
    assert dog.end()


def test_a_session_whose_tick_hangs_is_shown_as_such_and_goes_on(start: Callable[..., EngineThread]) -> None:
    """On a busy machine a tick can take long. The session must go on afterwards."""
    engine = start(stall_s=0.3)
    accept(engine, step())
    plain, go_on = engine.session.tick, threading.Event()

    def hang(recorder: Any = None) -> None:
        assert go_on.wait(PATIENCE_S)
        plain(recorder)

    engine.session.tick = hang  # type: ignore[method-assign]
    stepped = engine.submit(step(3))
    hanging = wait_for(engine, lambda now: now.fault is not None)
    assert hanging.fault == "the tick is taking more than 0.3 s; the session goes on when it has ended"
    assert (hanging.tick, stepped.done()) == (1, False)
    go_on.set()
    assert stepped.result(PATIENCE_S) == m.Accepted(4)
    now = wait_for(engine, lambda now: now.tick == 4)
    assert (now.running, now.fault) == (False, None)
    assert [(event.kind, event.text) for event in now.events] == [("fault", "a tick took more than 0.3 s")]
