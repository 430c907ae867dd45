"""What keeping and handing out a trial costs: ten thousand that do nothing. `python -m benchmarks.trials`

Of 10^4 trials, each of which would run in the office for 20 minutes, all is done but the run itself: they are made, looked up,
sent to a worker in batches, taken back and kept with eight scores in a file.
"""

from __future__ import annotations

import argparse
import itertools
import json
import tempfile
import time
from pathlib import Path
from typing import Any

from app.experiments.pool import connected_to, pending, run_trials
from app.experiments.store import Store
from app.protocol.course import Moment
from app.protocol.experiment import find_experiment
from app.protocol.trial import Result, Trial

BAR_MS = 5.0


def do_nothing(trial: Trial) -> Result:
    """A trial that ends before it begins."""
    return Result(trial.id, {f"score_{k}": float(trial.seed) for k in range(8)}, Moment(0.0, "the end"), 0.0, 0.0, "")


def measure(trials: int, workers: int | None) -> dict[str, Any]:
    """ms a trial, by what is done."""
    table = find_experiment("table")
    cells = len(table.make_trials(trials=1))
    clock = [time.perf_counter()]
    plan = table.make_trials(trials=-(-trials // cells))[:trials]
    clock.append(time.perf_counter())
    with tempfile.TemporaryDirectory() as folder, Store(Path(folder) / "trials.sqlite") as store:
        with connected_to(None, workers) as client:
            clock.append(time.perf_counter())
            run_trials(plan, store, client, run=do_nothing)
            clock.append(time.perf_counter())
        clock.append(time.perf_counter())
        left, kept = len(pending(plan, store)), len(store.of_experiment(table.name))
        clock.append(time.perf_counter())
        size = store.path.stat().st_size
    spent = [1000 * (b - a) / trials for a, b in itertools.pairwise(clock)]
    made, started, ran, ended, read = spent
    return {
        "trials": trials,
        "kept": kept,
        "left": left,
        "ms_made": round(made, 3),
        "ms_run_and_kept": round(ran, 3),
        "ms_read_again": round(read, 3),
        "ms_in_all": round(made + ran + read, 3),
        "bar_ms": BAR_MS,
        "s_to_start_workers": round(started * trials / 1000, 1),
        "s_to_end_workers": round(ended * trials / 1000, 1),
        "bytes_a_trial": round(size / trials),
    }


def main() -> None:
    """Print the figures as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=10_000)
    parser.add_argument("--workers", type=int, default=None)
    args = parser.parse_args()
    print(json.dumps(measure(args.trials, args.workers), indent=2))


if __name__ == "__main__":
    main()
