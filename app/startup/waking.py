"""From the server's first answer to the robot's first tick."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING

from app.startup.compiling import PARTS, WORDS, Compiling, say_how_far
from disk import kernel_cache

if TYPE_CHECKING:
    from app.engine_thread import EngineThread  # loaded while others compile


class Waking:
    """Starts the engine when its kernels are compiled, from a thread of its own. The page shows the progress."""

    def __init__(self, engine: EngineThread, compiling: Compiling) -> None:
        self._engine, self._compiling = engine, compiling
        self._stopped = False
        self._thread = threading.Thread(target=self._wake, name="waking", daemon=True)

    def start(self) -> None:
        if self._compiling:
            print(f"RatSLAM wakes up: {WORDS}, which takes some twenty seconds ...", flush=True)
        self._thread.start()

    def stop(self, patience_s: float | None = None) -> None:
        """End the engine, or what precedes its start. patience_s: how long to wait for the current tick."""
        self._stopped = True
        self._compiling.stop()
        self._thread.join()
        self._engine.stop(patience_s)

    def _wake(self) -> None:
        self._compiling.wait(self._tell)
        self._engine.latest.waking = "loading the office and the brain"
        if not kernel_cache.in_memory:
            _load_kernels()
        if not self._stopped:
            self._engine.start()

    def _tell(self, words: str) -> None:
        self._engine.latest.waking = words
        say_how_far(words)


def _load_kernels() -> None:
    """While there are descriptors: whoever connects may take the last. What cannot be loaded, the engine meets and tells of."""
    for use, _ in PARTS.values():
        with contextlib.suppress(Exception):
            use()
