"""Runs one experiment or all: the trials that are not in the store yet, then table, figures and page."""

from __future__ import annotations

import argparse
import shlex
import shutil
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from app.cli.experiment import check_whole
from app.cli.options import compile_first
from app.experiments.export import write_csv
from app.experiments.live import LiveTable
from app.experiments.pool import Duration, Workers, duration_of, pending, run_trials, time_words
from app.experiments.report import Report, make_folder, write_index, write_outputs
from app.experiments.store import Store
from app.experiments.summary import summarise, table_of
from app.protocol.experiment import EngineName, Experiment, catalogue, find_experiment
from app.protocol.trial import Trial

OUT = Path("experiments")


@dataclass(frozen=True, slots=True)
class _Plan:
    """An experiment, its trials, and how long those that were not run yet will take."""

    experiment: Experiment
    trials: list[Trial]
    duration: Duration


def run_one(name: str, args: argparse.Namespace) -> int:
    """ValueError says what is wrong with the experiment, before anything is run."""
    experiment = find_experiment(name)
    if name.endswith(".toml"):
        check_whole(experiment)
    folder = make_folder(args.out or OUT / experiment.name)
    with Store(args.store) as store, _workers(args) as workers:
        plan = _planned(experiment, args, store)
        _run(plan, args, store, workers)
        _finish(plan, args, store, workers, folder, _command(name, args))
        if args.csv is not None:
            write_csv(args.csv, experiment, store.of_experiment(experiment.name))
            print(f"all stored trials: {args.csv}")
    return 0


def run_all(args: argparse.Namespace) -> int:
    """Every experiment of the catalogue that has the engine asked for."""
    folder = make_folder(args.out or OUT)
    experiments = [each for each in catalogue() if args.engine == "all" or args.engine in each.engines]
    with Store(args.store) as store, _workers(args) as workers:
        plans = [_planned(experiment, args, store) for experiment in experiments]
        seconds = sum(plan.duration.seconds for plan in plans) / workers.count
        trials = sum(plan.duration.trials for plan in plans)
        print(f"{len(plans)} experiments, {trials} trials to run: about {time_words(seconds)}", file=sys.stderr)
        reports: list[Report] = []
        for plan in plans:
            _run(plan, args, store, workers)
            reports.append(_finish(plan, args, store, workers, folder, _command("all", args)))
        print(f"all of them: {write_index(reports, folder, _command('all', args))}")
    return 0


def _workers(args: argparse.Namespace) -> Workers:
    return Workers(args.scheduler, args.workers, before=compile_first)


def _planned(experiment: Experiment, args: argparse.Namespace, store: Store) -> _Plan:
    engines: list[EngineName] | None = None if args.engine == "all" else [args.engine]
    trials = experiment.make_trials(engines, args.trials, args.quick)
    measured = store.seconds(experiment.name, args.quick)
    waiting = Counter(trial.engine for trial in pending(trials, store))
    return _Plan(experiment, trials, duration_of(experiment, waiting, measured, args.quick))


def _run(plan: _Plan, args: argparse.Namespace, store: Store, workers: Workers) -> None:
    todo = plan.duration.trials
    if not todo:
        return
    client = workers.client
    expected_s = plan.duration.seconds / todo
    print(
        f"{plan.experiment.name}: {todo} trials to run, {plan.duration.words(workers.count)}",
        file=sys.stderr,
        flush=True,
    )
    try:
        with LiveTable(
            plan.experiment, plan.trials, store.stored(plan.trials), plan.duration.seconds / workers.count
        ) as live:
            run_trials(plan.trials, store, client, expected_s=expected_s, on_ended=live.add)
    except KeyboardInterrupt:
        done = len(plan.trials) - len(pending(plan.trials, store))
        print(
            f"{plan.experiment.name}: {done} of {len(plan.trials)} trials are kept in {store.path}; the same command goes on:\n"
            f"  {_command(' '.join(args.what), args)}",
            file=sys.stderr,
        )
        raise


def _finish(
    plan: _Plan, args: argparse.Namespace, store: Store, workers: Workers, folder: Path, command: str
) -> Report:  # fmt: skip
    experiment, stored = plan.experiment, store.stored(plan.trials)
    Console(soft_wrap=True).print(table_of(experiment, summarise(experiment, stored)))
    for trial in [trial for trial in stored if trial.error][:3]:
        print(f"trial {trial.id} failed: {trial.error}; the next command runs it again")
    table, report = write_outputs(experiment, plan.trials, stored, folder, workers, command=command)
    if not args.quick:
        _show_in_gallery(report.figures, store.path.parent / "figures")
    print(f"page: {report.page}\nfigures: {folder / 'figures'}\ntable: {table}\n", flush=True)
    return report


def _show_in_gallery(figures: Sequence[Path], folder: Path) -> None:
    """The page's gallery shows the figures that lie beside the store."""
    folder.mkdir(parents=True, exist_ok=True)
    for figure in figures:
        shutil.copy2(figure, folder)


def _command(name: str, args: argparse.Namespace) -> str:
    """The command that makes the same again."""
    words = ["ratslam", "experiment", name]
    words += [] if args.engine == "all" else ["--engine", args.engine]
    words += [] if args.trials is None else ["--trials", str(args.trials)]
    words += ["--quick"] if args.quick else []
    for option, value in (("--scheduler", args.scheduler), ("--out", args.out), ("--store", args.store)):
        words += [] if value is None else [option, str(value)]
    return shlex.join(words)
