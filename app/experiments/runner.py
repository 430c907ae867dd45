"""Runs the trials that are not in the store, in batches, on all workers, and says before how long that will take.

This process alone writes to the store.
"""

from __future__ import annotations

import math
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import CancelledError
from dataclasses import dataclass
from typing import Any

from app.experiments.store import Outcome, Store
from app.experiments.workers import RunOne, run_batch, run_stored
from app.protocol.experiment import Experiment
from app.protocol.trial import Trial

BATCH_S = 2.0  # work in a batch: what is lost with a worker, against what handing it out costs
MOST_AT_ONCE = 250  # trials in a batch, if they do nothing
AHEAD = 3  # batches handed out for each thread, so that none waits for the client
TRIES = 4  # a trial whose worker died so often has failed
COUNT_EVERY_S = 2.0  # how often the threads are counted: a cluster may grow
REAL_TIMES = 100.0  # simulated seconds in one of a core, where nothing has been measured
SET_UP_S = 0.5  # of a session

Tell = Callable[[Sequence[tuple[Trial, Outcome]]], None]


def pending(trials: Iterable[Trial], store: Store) -> list[Trial]:
    """The trials that have no scores yet, each once, in their order."""
    by_id = {trial.id: trial for trial in trials}
    done = store.done(by_id)
    return [trial for trial in by_id.values() if trial.id not in done]


def run_trials(
    trials: Iterable[Trial], store: Store, client: Any, *, expected_s: float = BATCH_S, run: RunOne = run_stored,
    tell: Tell | None = None,
) -> None:  # fmt: skip
    """Run what is pending. expected_s: about how long a trial takes; run: what a worker does with it.

    tell: is given what has ended and is kept. ValueError: the cluster has gone; what had come is kept.
    """
    running = _Running(pending(trials, store), client, run, expected_s)
    for ended in running.ended():
        store.add(ended)
        if tell is not None:
            tell(ended)


class _Running:
    """Batches on their way. A batch whose worker died is handed out again, trial by trial: one of them may be to blame."""

    def __init__(self, trials: list[Trial], client: Any, run: RunOne, expected_s: float) -> None:
        self._waiting = deque(trials)
        self._suspects: deque[Trial] = deque()  # each goes alone
        self._client, self._run = client, run
        self._each_s, self._seen, self._spent_s = expected_s, 0, 0.0
        self._air: dict[Any, list[Trial]] = {}
        self._tries: Counter[str] = Counter()
        self._threads, self._counted_s = 1, -math.inf

    def ended(self) -> Iterable[list[tuple[Trial, Outcome]]]:
        """What ends, as it does."""
        from distributed import as_completed

        coming: Any = as_completed(loop=self._client.loop)
        self._hand_out(coming)
        try:
            for future in coming:
                if future.status in ("pending", "lost"):  # its worker died with the result, and it is run again
                    coming.add(future)
                    continue
                ended = self._taken(future, self._air.pop(future))
                self._hand_out(coming)
                if ended:
                    yield ended
        finally:
            if self._air:
                self._client.cancel(list(self._air), force=True)

    def _taken(self, future: Any, batch: list[Trial]) -> list[tuple[Trial, Outcome]]:
        try:
            outcomes: dict[str, Outcome] = {outcome.trial_id: outcome for outcome in future.result()}
        except CancelledError:
            raise ValueError("the cluster has gone; the same command goes on where this one stopped") from None
        except Exception as error:
            return self._tried(batch, f"{type(error).__name__}: {error}")
        self._learn(list(outcomes.values()))
        return [(trial, outcomes[trial.id]) for trial in batch]

    def _tried(self, batch: list[Trial], error: str) -> list[tuple[Trial, Outcome]]:
        """Their worker died, or could not be given them."""
        failed: list[tuple[Trial, Outcome]] = []
        for trial in batch:
            self._tries[trial.id] += 1
            if self._tries[trial.id] < TRIES:
                self._suspects.append(trial)
            else:
                failed.append((trial, Outcome(trial.id, error=error)))
        return failed

    def _learn(self, outcomes: list[Outcome]) -> None:
        walls = [outcome.result.wall_s for outcome in outcomes if outcome.result is not None]
        self._seen, self._spent_s = self._seen + len(walls), self._spent_s + sum(walls)
        if self._seen:
            self._each_s = self._spent_s / self._seen

    def _hand_out(self, coming: Any) -> None:
        while len(self._air) < AHEAD * self._count_threads() and (self._suspects or self._waiting):
            batch = [self._suspects.popleft()] if self._suspects else self._next_batch()
            future = self._client.submit(run_batch, batch, self._run, pure=False, retries=1)
            self._air[future] = batch
            coming.add(future)

    def _next_batch(self) -> list[Trial]:
        fair = math.ceil(len(self._waiting) / (AHEAD * self._threads))  # towards the end, all are kept busy
        wanted = round(BATCH_S / max(self._each_s, BATCH_S / MOST_AT_ONCE))
        return [self._waiting.popleft() for _ in range(max(1, min(wanted, fair)))]

    def _count_threads(self) -> int:
        now_s = time.monotonic()
        if now_s - self._counted_s > COUNT_EVERY_S:
            self._threads, self._counted_s = max(1, sum(self._client.nthreads().values())), now_s
        return self._threads


@dataclass(frozen=True, slots=True)
class Duration:
    """Wall time of trials on one core, in s. measured: each engine's from trials that were run on this store's machine."""

    seconds: float
    trials: int
    measured: bool

    def words(self, workers: int) -> str:
        """Such as `12 min, measured`."""
        return f"{time_words(self.seconds / max(1, workers))}, {'measured' if self.measured else 'estimated'}"


def duration_of(
    experiment: Experiment, trials: Counter[str], measured: dict[str, float], quick: bool = False
) -> Duration:
    """trials: how many, by engine. measured: wall seconds of a trial, by engine, as far as they are known."""
    estimated_s = experiment.seconds(quick) / REAL_TIMES + SET_UP_S
    seconds = sum(measured.get(engine, estimated_s) * count for engine, count in trials.items())
    return Duration(seconds, trials.total(), all(engine in measured for engine in trials))


def time_words(seconds: float) -> str:
    """Such as `40 s`, `12 min` or `3.5 h`."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
