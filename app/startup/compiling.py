"""The first start. numba compiles each kernel at its first call and caches it on disk. All kernels together take half a
minute of one core, so separate processes compile them side by side and report their progress."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from numba.core import config

from app.startup.compile_part import PARTS, kept
from disk import kernel_cache
from ratslam_live import command_of

WORDS = "compiling the engine for this machine, once"


class Compiling:
    """Begins at once to compile the parts whose kernels are not on disk. A part that fails is compiled when used."""

    def __init__(self) -> None:
        if kernel_cache.words:
            print(f"ratslam: {kernel_cache.words}", file=sys.stderr)
        keeps = not (kernel_cache.in_memory or config.DISABLE_JIT)  # pyright: ignore[reportAttributeAccessIssue,reportUnknownMemberType]
        missing = [part for part, (_, modules) in PARTS.items() if keeps and not all(map(is_compiled, modules))]
        self._process = _process(missing) if missing else None

    def __bool__(self) -> bool:
        """Whether there was anything to do."""
        return self._process is not None

    def wait(self, tell: Callable[[str], None]) -> None:
        """Wait until everything is compiled or `stop` is called. tell: is given the progress in words."""
        if self._process is None:
            return
        assert self._process.stdout is not None
        for done, _ in enumerate(self._process.stdout, start=1):
            tell(f"{WORDS}: {done} {'function' if done == 1 else 'functions'} done")
        if sys.stderr.isatty():
            print(file=sys.stderr)

    def stop(self) -> None:
        """End it at once. What has been compiled is kept, and `wait` returns."""
        if self._process is not None and self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


def say_how_far(words: str) -> None:
    """Show progress on one line of a terminal. Nothing is written to a log file, where it would take many lines."""
    if sys.stderr.isatty():
        print(f"\r{words} ", end="", file=sys.stderr, flush=True)


def is_compiled(module: ModuleType) -> bool:
    """Whether numba has cached a kernel of this module that is not older than the source."""
    source = Path(str(module.__file__))
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in kept(module))


def _process(parts: list[str]) -> subprocess.Popen[str]:
    """The compiling process. It leads a process group of its own, so that its children can be ended with it."""
    return subprocess.Popen(
        command_of("app.startup.compile_part", *parts),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, process_group=0,
    )  # fmt: skip
