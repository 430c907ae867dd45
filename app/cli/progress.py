"""What is shown while a long run takes its time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Result = TypeVar("Result")


def with_progress(seconds: float, work: Callable[[Callable[[float, str], None]], Result]) -> Result:
    """Do `work` beside a progress bar of `seconds` simulated seconds.

    work: is given a function to report progress by: simulated seconds since the last call, and what is being done.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn()
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=seconds)
        done_s = 0.0

        def progress(simulated_s: float, what: str) -> None:
            nonlocal done_s
            done_s += simulated_s
            bar.update(task, description=what, completed=done_s, total=max(seconds, done_s))

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
