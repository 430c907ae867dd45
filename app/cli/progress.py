"""What is shown while a long run takes its time."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TypeVar

Result = TypeVar("Result")


def with_progress(seconds: float, work: Callable[[Callable[[float, str], None]], Result]) -> Result:
    """Do `work` beside a progress bar of `seconds` simulated seconds.

    work: is given a function to report progress by: simulated seconds since the last call, and what is being done.
    """
    from tqdm import tqdm

    with tqdm(total=round(seconds), unit="s", unit_scale=True, disable=not sys.stderr.isatty()) as bar:

        def progress(simulated_s: float, what: str) -> None:
            bar.set_description(what, refresh=False)
            if bar.n + simulated_s > (bar.total or 0):
                bar.total = round(bar.n + simulated_s)
            bar.update(simulated_s)

        return work(progress)


def share_said(seconds: float, work: Callable[[Callable[[float, str], None]], Result]) -> Result:
    """The same for another program: a line on stdout, as `done 0.42`, for each hundredth."""
    done_s, said = 0.0, -1

    def progress(simulated_s: float, _what: str) -> None:
        nonlocal done_s, said
        done_s += simulated_s
        hundredth = min(100, int(100 * done_s / max(seconds, 1e-9)))
        if hundredth > said:
            said = hundredth
            print(f"done {hundredth / 100:.2f}", flush=True)

    return work(progress)


def compile_first() -> None:
    """Compile what is not compiled yet, and say how far that is, before the run's own progress begins."""
    from app.startup.compiling import Compiling, say_how_far

    compiling = Compiling()
    try:
        compiling.wait(say_how_far)
    finally:
        compiling.stop()
