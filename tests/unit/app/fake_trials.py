"""A command that runs trials of a few milliseconds: `python -m tests.unit.app.fake_trials STORE TRIALS [SCHEDULER]`."""

from __future__ import annotations

import hashlib
import os
import sys
from pathlib import Path

from app.experiments.pool import connected_to, pending, run_trials
from app.experiments.store import Store
from app.protocol.trial import Result, Trial
from app.startup.ending import ended, obey_signals
from tests.unit.app.trial_makers import make_outcome, make_trial

DEADLY = 666  # the seed of a trial that kills its worker
FAILING = 13  # the seed of one that fails


def run(trial: Trial) -> Result:
    """Some milliseconds of work."""
    text = trial.id.encode()
    for _ in range(5000):
        text = hashlib.sha256(text).digest()
    result = make_outcome(trial).result
    assert result is not None
    return result


def run_badly(trial: Trial) -> Result:
    """One of these kills its worker, another fails."""
    if trial.seed == DEADLY:
        os.kill(os.getpid(), 9)
    if trial.seed == FAILING:
        raise ValueError("no such door")
    return run(trial)


def trials(count: int) -> list[Trial]:
    return [make_trial(seed) for seed in range(1000, 1000 + count)]


def main(store: str, count: str, scheduler: str | None = None) -> int:
    with Store(Path(store)) as kept:
        if not pending(trials(int(count)), kept):
            return 0
        with connected_to(scheduler, 2) as client:
            print("begun", flush=True)
            run_trials(trials(int(count)), kept, client, run=run, expected_s=0.1)
    return 0


if __name__ == "__main__":
    obey_signals()
    sys.exit(ended(lambda: main(*sys.argv[1:])))
