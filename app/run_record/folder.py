"""The folder in which runs keep themselves: one folder a run, the oldest of which are deleted under a budget."""

from __future__ import annotations

import contextlib
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

from disk import user_folder
from disk.locks import lock

LINES, BRAIN, STATE = "run.jsonl", "brain.npz", "state.npz"
BUDGET_MB = 200.0
MOST_RUNS = 200
FRESH_S = 60.0  # where there are no locks, a run that goes on is touched far more often than that
MOST_STATES = 3  # runs that keep a state, with its brain; the others are resumed from their orders


def runs_folder() -> Path:
    """It need not exist. ValueError without a home."""
    return user_folder("runs")


def all_runs() -> list[Path]:
    """The folders of all runs, the newest first."""
    try:
        found = [path.parent for path in runs_folder().glob(f"*/{LINES}")]
    except ValueError:  # no home directory: nothing is kept
        return []
    return sorted(found, key=_age, reverse=True)


def is_open(folder: Path) -> bool:
    """Whether a program is writing this run now. Without locks: whether one has within the last minute, in which it would."""
    try:
        with (folder / LINES).open("rb") as file:
            free = lock(file, shared=True)
    except OSError:
        return False
    return time.time() - _age(folder) < FRESH_S if free is None else not free


def busy_words(folder: Path) -> str:
    """Why a run that is open cannot be gone on with or deleted."""
    with (folder / LINES).open("rb") as file:
        if lock(file, shared=True) is None:
            return f"was written less than {FRESH_S:g} s ago, and {folder.parent} has no file locks to tell whether it goes on"
    return "is going on in another program"


def delete(folder: Path) -> None:
    """ValueError: the run is still going on. OSError: it cannot be deleted."""
    if is_open(folder):
        raise ValueError(f"the run {folder.name} {busy_words(folder)}; end its program first")
    shutil.rmtree(folder)


def tidy(budget_mb: float = BUDGET_MB, most: int = MOST_RUNS) -> None:
    """Delete the oldest runs until the rest is within the budget. The newest, the newest with a state, runs that go on and what
    cannot be deleted stay."""
    room, runs, states = budget_mb * 1e6, all_runs(), 0
    for number, folder in enumerate(runs):
        has_state = (folder / STATE).exists()
        states += has_state
        if has_state and states > MOST_STATES and not is_open(folder):
            with contextlib.suppress(OSError):
                (folder / STATE).unlink(missing_ok=True)
        room -= sum(_sizes(folder))
        stays = number == 0 or (has_state and states == 1)
        if not stays and (room < 0 or number >= most) and not is_open(folder):
            with contextlib.suppress(OSError, ValueError):
                delete(folder)


def _sizes(folder: Path) -> Iterator[int]:
    with contextlib.suppress(OSError):
        for path in folder.iterdir():
            yield path.stat().st_size


def _age(folder: Path) -> float:
    try:
        return (folder / LINES).stat().st_mtime
    except OSError:
        return 0.0
