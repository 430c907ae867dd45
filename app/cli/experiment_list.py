"""The experiments, in words: paper and figure, what each asks, and how long it takes here."""

from __future__ import annotations

import argparse
import textwrap

from app.experiments.cluster import cores
from app.experiments.durations import duration_of, time_words
from app.experiments.store import Store, default_path
from app.trials.experiment import Experiment, catalogue

WIDTH = 100


def list_experiments(args: argparse.Namespace) -> int:
    """Print them. Durations are measured where trials were run before."""
    workers, total_s = args.workers or cores(), 0.0
    path = args.store or default_path()
    store = Store(path) if path.is_file() else None
    for experiment in catalogue():
        measured = {} if store is None else store.seconds(experiment.name, args.quick)
        duration = duration_of(experiment, experiment.make_trials(trials=args.trials, quick=args.quick), measured)
        total_s += duration.seconds / workers
        _tell(experiment, f"{duration.trials} trials, {duration.words(workers)}")
    if store is not None:
        store.close()
    print(f"\nAll together: {time_words(total_s)} with {workers} {'worker' if workers == 1 else 'workers'}.")
    print(
        "`ratslam experiment NAME` runs one, `ratslam experiment all` every one; what was run before is not run again."
    )
    return 0


def _tell(experiment: Experiment, duration: str) -> None:
    print(f"{experiment.name}: {experiment.title} ({experiment.paper})")
    print(textwrap.fill(experiment.asks, WIDTH, initial_indent="    ", subsequent_indent="    "))
    print(f"    {duration}")
