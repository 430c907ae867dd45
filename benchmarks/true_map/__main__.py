"""The bars of the map that stays true, each as a command that prints its figure beside it.

    python -m benchmarks.true_map office twins --seeds 1 2 3      # these rows on these seeds
    python -m benchmarks.true_map halls --worlds campus           # a row in one of its worlds
    python -m benchmarks.true_map --report bars.json              # all of them: a day and a night

Each row begins by saying how long it will take. Ctrl+C ends with the figures of the runs that are done.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from app.config import Config, Value, parse_value
from benchmarks.back_end.rows import DATA
from benchmarks.true_map import local
from benchmarks.true_map.figures import Figure, Report, of_run
from benchmarks.true_map.jobs import Job, run_all, words_of_time
from benchmarks.true_map.rows import PLANS, ROWS, WORLDS, Options
from disk import require_writable, write_whole


def main(argv: list[str] | None = None) -> int:
    parser, args = _arguments(argv)
    try:
        require_writable("--report", args.report)
        options = _options(args)
    except (OSError, ValueError) as error:
        parser.error(str(error))
    told: list[dict[str, Any]] = []
    try:
        for name in args.rows:
            told.append(_row(name, options, args.workers))
            if told[-1]["partial"]:
                return 130
    finally:
        if args.report is not None:
            write_whole(args.report, json.dumps(told, indent=1) + "\n")
    return 0


def _row(name: str, options: Options, workers: int) -> dict[str, Any]:
    """Make the runs of a row and print its figures; after Ctrl+C, of the runs that were done."""
    if name in local.ROWS:
        print(f"{name}: {local.ROWS[name][0]}", flush=True)
        figures = list(_printed(name, local.ROWS[name][1](options.data)))
        return _told(name, figures, [], partial=False)
    row = ROWS[name]
    jobs = row.planned(options)
    if not jobs:
        print(f"{name}: skipped, there is nothing to run: {_why(name, options)}", flush=True)
        return _told(name, [], [], partial=False)
    print(f"{name}: {row.work}; {words_of_time(jobs, workers)}", flush=True)
    done: list[tuple[Job, Report]] = []
    try:
        _make(jobs, workers, done)
    except KeyboardInterrupt:
        print(f"{name}: stopped after {len(done)} of {len(jobs)} runs; their figures:", flush=True)
    return _judged(name, jobs, done)


def _make(jobs: list[Job], workers: int, done: list[tuple[Job, Report]]) -> None:
    for job, report in run_all(jobs, workers):
        done.append((job, report))
        print(f"  {len(done)} of {len(jobs)}: {of_run(report)}", flush=True)


def _judged(name: str, jobs: list[Job], done: list[tuple[Job, Report]]) -> dict[str, Any]:
    runs = [report for _, report in sorted(done, key=lambda pair: jobs.index(pair[0]))]
    figures = list(_printed(name, ROWS[name].judge(runs))) if runs else []
    return _told(name, figures, runs, partial=len(done) < len(jobs))


def _printed(name: str, figures: Iterator[Figure]) -> Iterator[Figure]:
    for figure in figures:
        verdict = "" if figure.holds is None else "holds" if figure.holds else "MISSED"
        beside = f"bar {figure.bar}" if figure.bar else ""
        print(f"{name:11} {figure.what:38} {figure.words:26} {beside:22} {verdict}".rstrip(), flush=True)
        yield figure


def _told(name: str, figures: list[Figure], runs: list[Report], *, partial: bool) -> dict[str, Any]:
    rows = [{"what": f.what, "value": f.value, "words": f.words, "bar": f.bar, "holds": f.holds} for f in figures]
    return {"row": name, "partial": partial, "figures": rows, "runs": runs}


def _why(name: str, options: Options) -> str:
    if name == "plans" and not any((options.data / file).is_file() for file, _ in PLANS.values()):
        return f"no floor plans are in {options.data}; give their folder with --data"
    return f"it has no world named {' or '.join(options.worlds)}"


def _options(args: argparse.Namespace) -> Options:
    """ValueError says what is wrong with them."""
    values: dict[str, Value] = {}
    for pair in args.set:
        dotted, equals, value = pair.partition("=")
        if not equals:
            raise ValueError(f"--set takes NAME=VALUE, got {pair!r}")
        values[dotted] = parse_value(value)
    Config().with_values(values)
    if args.workers < 1 or args.deliveries < 1:
        raise ValueError("--workers and --deliveries must be 1 or more")
    if len(set(args.seeds)) < len(args.seeds) or min(args.seeds, default=0) < 0:
        raise ValueError("--seeds must be different numbers from 0 on")
    return Options(args.data, tuple(args.seeds), tuple(args.worlds), args.deliveries, values)


def _arguments(argv: list[str] | None) -> tuple[argparse.ArgumentParser, argparse.Namespace]:
    names = [*ROWS, *local.ROWS]
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.true_map", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"of: {', '.join(names)} (default: all)")
    parser.add_argument("--seeds", type=int, nargs="+", default=[], metavar="S", help="instead of the row's own seeds")
    parser.add_argument("--worlds", nargs="+", default=[], choices=[*WORLDS, *PLANS], metavar="W", help="only in these")
    parser.add_argument("--deliveries", type=int, default=1143, metavar="N", help="in the row of that name (1143)")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="change parameters, to compare")
    parser.add_argument("--workers", type=int, default=2, help="runs at the same time (default 2)")
    parser.add_argument("--data", type=Path, default=DATA, metavar="FOLDER", help="with plans and graphs of others")
    parser.add_argument("--report", type=Path, metavar="FILE", help="write figures and runs to FILE as JSON")
    args = parser.parse_args(argv)
    for name in args.rows:
        if name not in names:
            parser.error(f"there is no row {name!r}; expected one of: {', '.join(names)}")
    args.rows = args.rows or names
    return parser, args


if __name__ == "__main__":
    sys.exit(main())
