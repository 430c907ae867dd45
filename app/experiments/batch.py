"""What a worker does: a batch of trials, one after the other."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence

from app.experiments.outcome import Outcome
from app.trials.code_version import code_version
from app.trials.trial import Result, Trial, run_trial

RunOne = Callable[[Trial], Result]


def run_stored(trial: Trial) -> Result:
    """Run a trial to its end. ValueError if it was made by another version of the program than this worker's."""
    if trial.version != code_version():
        raise ValueError(f"this worker's program is version {code_version()}, the trial is of {trial.version}")
    return run_trial(trial)[0]


def run_batch(trials: Sequence[Trial], run: RunOne) -> list[Outcome]:
    """A trial that fails is an outcome, too: the others of its batch go on."""
    return [_outcome(trial, run) for trial in trials]


def _outcome(trial: Trial, run: RunOne) -> Outcome:
    try:
        return Outcome(trial.id, run(trial))
    except Exception as error:
        return Outcome(trial.id, error=f"{type(error).__name__}: {error}")


def dask_setup(_worker: object) -> None:
    """Called by Dask in each worker of our own cluster: one core each, and Ctrl+C is the client's matter."""
    import cv2

    cv2.setNumThreads(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
