"""`ratslam deliver`: hours of deliveries between places spread over the map, and their report."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from app.cli.options import Verbs, add_session_options, session_of, write_report
from app.cli.progress import compile_first, with_progress
from disk import require_writable

DELIVERY_S = 40.0  # about what a delivery takes, for the progress bar


def add_deliver(commands: Verbs) -> None:
    deliver = commands.add_parser("deliver", help="explore, then deliver between places spread over the map, for hours")
    add_session_options(deliver)
    deliver.add_argument("--minutes", type=float, default=20.0, help="simulated minutes of exploring (default 20)")
    deliver.add_argument("--goals", type=int, default=11, metavar="K", help="places, spread over the map (default 11)")
    deliver.add_argument("--deliveries", type=int, default=110, metavar="N", help="how many in all (default 110)")
    deliver.add_argument(
        "--timeout", type=float, default=300.0, metavar="S", help="a longer delivery fails (default 300)"
    )
    deliver.add_argument(
        "--report", type=Path, metavar="FILE", help="write the report to FILE as JSON (default: print it)"
    )
    deliver.set_defaults(do=_deliver)


def _deliver(args: argparse.Namespace) -> int:
    _check(args)
    world, config, brain = session_of(args)
    require_writable("--report", args.report)
    from app.headless import Deliveries

    compile_first()
    runs: list[Deliveries] = []

    def work(progress: Any) -> None:
        runs.append(
            Deliveries(
                world, args.seed, minutes=args.minutes, goals=args.goals, deliveries=args.deliveries,
                timeout_s=args.timeout, config=config, brain=brain, progress=progress,
            )
        )  # fmt: skip
        runs[0].carry_out()

    try:
        with_progress(args.minutes * 60 + args.deliveries * DELIVERY_S, work)
    except KeyboardInterrupt:
        if runs:
            _tell(runs[0].report(), args)
        raise
    _tell(runs[0].report(), args)
    return 0


def _check(args: argparse.Namespace) -> None:
    for name, value, low, high, advice in (
        ("--minutes", args.minutes, 0.1, 1e6, "the robot must have seen the places to which it delivers"),
        ("--goals", args.goals, 2, 1000, "a delivery leads from one place to another"),
        ("--deliveries", args.deliveries, 1, 1e6, "the bar of two weeks in an office is 1143"),
        ("--timeout", args.timeout, 1, 1e6, "seconds that a delivery may take, 300 by default"),
    ):
        if not low <= value <= high:
            raise ValueError(f"{name} must be from {low:g} to {high:g}, got {value:g}; {advice}")


def _tell(report: dict[str, Any], args: argparse.Namespace) -> None:
    done, failed = report["deliveries"], len(report["failures"])
    stopped = f"stopped early, after {done} of {args.deliveries} deliveries: " if report["partial"] else ""
    words = (
        f"{report['world']}, seed {report['seed']}: {stopped}{report['succeeded']} of {done} deliveries succeeded, "
        f"{failed} failed; {report['metres'] / 1000:.2f} km in {report['simulated_s'] / 3600:.2f} h, "
        f"{report['real_time_factor']:g} x real time"
    )
    write_report(report, args.report, words)
