"""`ratslam experiment`: lists the experiments, runs one or all, opens one of their trials, checks a file."""

from __future__ import annotations

import argparse
import sys
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.options import ENGINES, Verbs, port_number
from disk import require_writable
from disk.limits import TRIALS

if TYPE_CHECKING:
    from app.protocol.experiment import Experiment

WIDTH = 100
_RESERVED = ("all", "check", "open", "results", "verdicts")


def add_experiment(commands: Verbs) -> None:
    parser = commands.add_parser(
        "experiment",
        help="run the papers' experiments, or one of your own",
        description="Without a name: lists the experiments.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="NAME or FILE.toml   runs one; what was run before is not run again\n"
        "all                 runs every experiment that comes with the program\n"
        "open ID             opens a trial in the dashboard, at the moment that decided it\n"
        "check FILE.toml     says whether a file of your own is right\n"
        "results             writes results.md and results.json from the stored trials (--out, default ./docs)\n"
        "verdicts            what the papers claim, and whether it holds by results.json (--out, default: this program's);\n"
        "                    fails when a verdict has changed",
    )
    parser.add_argument("what", nargs="*", metavar="NAME|FILE.toml|all|open ID|check FILE", help="see below")
    parser.add_argument("--engine", choices=(*ENGINES, "all"), default="all", help="whose rules (default all)")
    parser.add_argument("--trials", type=int, metavar="N", help="trials in each cell (default: the experiment's)")
    parser.add_argument("--quick", action="store_true", help="made short, to see that it works")
    parser.add_argument(
        "--workers", type=int, metavar="N", help="processes on this machine (default: one for each core)"
    )
    parser.add_argument("--scheduler", metavar="ADDRESS", help="use this Dask cluster, such as tcp://127.0.0.1:8786")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="where page, figures and table go (default ./experiments/NAME)"
    )
    parser.add_argument(
        "--store", type=Path, metavar="FILE", help="where trials are kept (default ~/.ratslam/experiments.sqlite)"
    )
    parser.add_argument(
        "--csv",
        type=Path,
        metavar="FILE",
        help="also write all stored trials of the experiment, of every version, to FILE",
    )
    parser.add_argument(
        "--port",
        type=port_number,
        default=8000,
        help="with open: as for `ratslam run` (default 8000, 0 = any free one)",
    )
    parser.set_defaults(do=_experiment)


def _experiment(args: argparse.Namespace) -> int:
    _check(args)
    match args.what:
        case []:
            return _list(args)
        case ["open", trial_id]:
            return _open(trial_id, args)
        case ["check", file]:
            return _check_file(file)
        case ["open" | "check" as verb, *_]:
            raise ValueError(
                f"experiment {verb} takes {'the id of a trial' if verb == 'open' else 'a file'}, and one only"
            )
        case ["all"]:
            from app.cli.experiment_run import run_all

            return run_all(args)
        case ["results"]:
            return _results(args)
        case ["verdicts"]:
            return _verdicts(args)
        case [name]:
            from app.cli.experiment_run import run_one

            return run_one(name, args)
        case names:
            raise ValueError(
                f"one experiment at a time, got {', '.join(names)}; `ratslam experiment all` runs every one"
            )


def _check(args: argparse.Namespace) -> None:
    if args.trials is not None and not 1 <= args.trials <= TRIALS:
        raise ValueError(f"--trials must be from 1 to {TRIALS}, got {args.trials}")
    if args.workers is not None and not 1 <= args.workers <= 1024:
        raise ValueError(f"--workers must be from 1 to 1024, got {args.workers}")
    if args.scheduler is not None and args.workers is not None:
        raise ValueError(
            f"--workers {args.workers} are processes on this machine; the cluster of --scheduler has its own"
        )
    if args.what == ["all"] and args.csv is not None:
        raise ValueError("--csv takes the trials of one experiment; name it")
    require_writable("--csv", args.csv)


def _list(args: argparse.Namespace) -> int:
    """Paper and figure, what each asks, and how long it takes here: measured where trials were run before."""
    from app.experiments.pool import cores, duration_of, time_words
    from app.protocol.experiment import catalogue

    workers, total_s = args.workers or cores(), 0.0
    measured_of = _measured(args.store, args.quick)
    for experiment in catalogue():
        measured = measured_of.get(experiment.name, {})
        duration = duration_of(experiment, experiment.how_many(args.trials, args.quick), measured, args.quick)
        total_s += duration.seconds / workers
        _print_plan(experiment, f"{duration.trials} trials, {duration.words(workers)}")
    print(f"\nAll together: {time_words(total_s)} with {workers} {'worker' if workers == 1 else 'workers'}.")
    print(
        "`ratslam experiment NAME` runs one, `ratslam experiment all` every one; what was run before is not run again."
    )
    return 0


def _measured(path: Path | None, quick: bool) -> dict[str, dict[str, float]]:
    """Wall seconds of a trial by experiment and engine. A store that cannot be read is told of, and nothing is known then."""
    from app.experiments.store import Store, default_path
    from app.protocol.experiment import names

    try:
        path = path or default_path()
        if path.is_file():
            with Store(path, reading=True) as store:
                return {name: store.seconds(name, quick) for name in names()}
    except ValueError as error:
        print(f"ratslam: note: {error}", file=sys.stderr)
    return {}


def _print_plan(experiment: Experiment, duration: str) -> None:
    print(f"{experiment.name}: {experiment.title} ({experiment.paper})")
    print(textwrap.fill(experiment.asks, WIDTH, initial_indent="    ", subsequent_indent="    "))
    print(f"    {duration}")


def _open(trial_id: str, args: argparse.Namespace) -> int:
    from app.cli.run import Serving, run_with_trial
    from app.experiments.store import Store, open_trial

    with Store(args.store, reading=True) as store:
        opened = open_trial(trial_id, store)
    for words in opened.warnings:
        print(f"ratslam: note: {words}", file=sys.stderr)
    return run_with_trial(opened.trial, opened.moment_s, serving=Serving(args.port))


def _results(args: argparse.Namespace) -> int:
    from app.experiments.report import make_folder
    from app.experiments.results import write_results
    from app.experiments.store import Store
    from app.protocol.experiment import catalogue

    folder = make_folder(args.out or Path("docs"))
    with Store(args.store) as store:
        runs = [(experiment, store.stored(experiment.make_trials())) for experiment in catalogue()]
    for path in write_results(runs, folder):
        print(path)
    return 0


def _verdicts(args: argparse.Namespace) -> int:
    from app.experiments.results import DOCS, cells_of, read_results
    from app.experiments.verdicts import broken, rows, verdicts
    from app.protocol.experiment import catalogue

    data = read_results((args.out or DOCS) / "results.json")
    found = list(verdicts((experiment, cells_of(data, experiment.name)) for experiment in catalogue()))
    for name, says, paper, ours, why in rows(found):
        print(f"{name}: {says}")
        told = (("by its rules", paper), ("by ours", ours), ("why", why))
        print(*(f"    {head}: {text}" for head, text in told if text), sep="\n")
    changed = broken(found)
    for words in changed:
        print(f"ratslam: {words}", file=sys.stderr)
    return 1 if changed else 0


def check_whole(experiment: Experiment) -> None:
    """What a file of one's own must stand before any of it is run. ValueError says what does not fit together."""
    from app.experiments.report import check_drawing

    experiment.check()
    check_drawing(experiment)


def _check_file(file: str) -> int:
    from app.protocol.experiment import read_experiment

    experiment = read_experiment(Path(file))
    if experiment.name in _RESERVED:
        raise ValueError(f"{file}: name: {experiment.name!r} is a word of the command; choose another")
    try:
        check_whole(experiment)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
    cells, trials = len(experiment.cells()), len(experiment.make_trials())
    print(f"{file}: {experiment.title}: {cells} {'cell' if cells == 1 else 'cells'}, {trials} trials; all is right")
    return 0
