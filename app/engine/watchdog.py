"""A thread that notices when a tick hangs. It measures time as a count of its own short naps, so that a process which
was suspended as a whole does not appear to hang.

Compiling does not count; numba reports when it begins and ends. Code that holds Python's global lock also stops the
watchdog; such a tick is found afterwards by the processor time it took.

Faults: an exception in words, and the check that all numbers of a session are still finite.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable

import numpy as np
from numba.core.event import Event, Listener, register, unregister  # pyright: ignore[reportUnknownVariableType]

from app.session import Session


def words_of(error: BaseException) -> str:
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def require_finite(session: Session) -> None:
    """FloatingPointError names what is not finite after this tick. Summing all poses costs microseconds."""
    truth, robot, packet = session.truth, session.estimate.pose_map_robot, session.estimate.packet
    numbers = {
        "the robot's true pose": () if truth is None else (truth.x, truth.y, truth.heading_rad),
        "the robot's pose in the map": (robot.x, robot.y, robot.heading_rad),
        "the winning packet": (packet.x, packet.y, packet.heading_rad, packet.mass),
        "the activity of the pose cells": (float(session.brain.pose_cells.active[1].sum(dtype=np.float64)),),
        "the map's poses": (float(session.brain.experience_map.poses.sum()),),
    }
    for name, values in numbers.items():
        if not all(math.isfinite(value) for value in values):
            raise FloatingPointError(f"not finite after tick {session.tick_count}: {name}")


NAPS = 20  # that make up the limit


class Watchdog:
    """The engine's thread calls `begin` and `end`. If a tick hangs, another thread calls `on_stall`, once."""

    def __init__(self, limit_s: float, on_stall: Callable[[], None]) -> None:
        self.limit_s = limit_s
        self._on_stall = on_stall
        self._nap_s = limit_s / NAPS
        self._lock = threading.Lock()
        self._woken = threading.Event()
        self._age_s: float | None = None  # of the tick; None between two ticks
        self._stalled = False
        self._busy_since_s = 0.0
        self._compiler = _Compiler()
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)

    def start(self) -> None:
        """Call it from the thread that is to be watched."""
        self._compiler.of_thread = threading.get_ident()
        register("numba:compile", self._compiler)
        self._thread.start()

    def stop(self) -> None:
        if self._thread.is_alive():
            unregister("numba:compile", self._compiler)
            self._woken.set()
            self._thread.join()

    def begin(self) -> None:
        with self._lock:
            self._age_s, self._stalled = 0.0, False
        self._compiler.took_s = 0.0
        self._busy_since_s = time.thread_time()

    def end(self) -> bool:
        """The tick is over. True if it took too long."""
        busy_s = time.thread_time() - self._busy_since_s - self._compiler.took_s
        with self._lock:
            self._age_s = None
            return self._stalled or busy_s > self.limit_s

    def _watch(self) -> None:
        before = time.monotonic()
        while not self._woken.wait(self._nap_s):
            now = time.monotonic()
            self._note(min(now - before, 2 * self._nap_s))
            before = now

    def _note(self, passed_s: float) -> None:
        """`passed_s` more have passed. The lock is held, so `on_stall` is never called for a tick that is over."""
        with self._lock:
            if self._age_s is None or self._stalled or self._compiler.busy:
                return
            self._age_s += passed_s
            if self._age_s > self.limit_s:
                self._stalled = True
                self._on_stall()


class _Compiler(Listener):
    """Whether a kernel is being compiled in the watched thread, and how much processor time compiling took (s)."""

    def __init__(self) -> None:
        self.of_thread = 0
        self.took_s = 0.0
        self._depth = 0  # nested: compiling a kernel compiles the kernels that it calls
        self._began_s = 0.0

    @property
    def busy(self) -> bool:
        return self._depth > 0

    def on_start(self, event: Event) -> None:  # noqa: ARG002
        if threading.get_ident() == self.of_thread:
            if self._depth == 0:
                self._began_s = time.thread_time()
            self._depth += 1

    def on_end(self, event: Event) -> None:  # noqa: ARG002
        if threading.get_ident() == self.of_thread and self._depth > 0:
            self._depth -= 1
            if self._depth == 0:
                self.took_s += time.thread_time() - self._began_s
