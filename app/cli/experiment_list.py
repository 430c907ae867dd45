"""The experiments, in words: paper and figure, what each asks, and how long it takes here."""

from __future__ import annotations

import argparse
import sys
import textwrap
from pathlib import Path

from app.experiments.runner import duration_of, time_words
from app.experiments.store import Store, default_path
from app.experiments.workers import cores
from app.protocol.experiment import Experiment, catalogue, names

WIDTH = 100


def list_experiments(args: argparse.Namespace) -> int:
    """Print them. Durations are measured where trials were run before."""
    workers, total_s = args.workers or cores(), 0.0
    measured_of = _measured(args.store, args.quick)
    for experiment in catalogue():
        measured = measured_of.get(experiment.name, {})
        duration = duration_of(experiment, experiment.how_many(args.trials, args.quick), measured, args.quick)
        total_s += duration.seconds / workers
        _tell(experiment, f"{duration.trials} trials, {duration.words(workers)}")
    print(f"\nAll together: {time_words(total_s)} with {workers} {'worker' if workers == 1 else 'workers'}.")
    print(
        "`ratslam experiment NAME` runs one, `ratslam experiment all` every one; what was run before is not run again."
    )
    return 0


def _measured(path: Path | None, quick: bool) -> dict[str, dict[str, float]]:
    """Wall seconds of a trial by experiment and engine. A store that cannot be read is told of, and nothing is known then."""
    try:
        path = path or default_path()
        if path.is_file():
            with Store(path, reading=True) as store:
                return {name: store.seconds(name, quick) for name in names()}
    except ValueError as error:
        print(f"ratslam: note: {error}", file=sys.stderr)
    return {}


def _tell(experiment: Experiment, duration: str) -> None:
    print(f"{experiment.name}: {experiment.title} ({experiment.paper})")
    print(textwrap.fill(experiment.asks, WIDTH, initial_indent="    ", subsequent_indent="    "))
    print(f"    {duration}")
