"""`ratslam headless`: the closed loop without a server, and its report."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from app.cli.options import Verbs, add_session_options, session_of
from app.cli.progress import with_progress
from app.startup.compiling import Compiling, say_how_far
from disk import require_writable, write_whole


def add_headless(commands: Verbs) -> None:
    headless = commands.add_parser("headless", help="run the same closed loop without a server, as fast as possible")
    add_session_options(headless)
    headless.add_argument("--minutes", type=float, default=20.0, help="simulated minutes of exploring (default 20)")
    headless.add_argument("--goals", type=int, default=0, metavar="K", help="then visit K places spread over the map")
    headless.add_argument("--kidnap-at", type=float, nargs="*", default=[], metavar="S", help="kidnap at these seconds")
    headless.add_argument("--save-brain", type=Path, metavar="FILE", help="save the brain to FILE at the end")
    headless.add_argument(
        "--report", type=Path, metavar="FILE", help="write the report to FILE as JSON (default: print it)"
    )
    headless.set_defaults(do=_headless)


def _headless(args: argparse.Namespace) -> int:
    _check(args)
    world, config, brain = session_of(args)
    for option, file in (("--report", args.report), ("--save-brain", args.save_brain)):
        require_writable(option, file)
    from app.headless import BrainFile, run_headless

    brain_file = None if args.save_brain is None else BrainFile(args.save_brain)
    _compile()
    report = with_progress(
        args.minutes * 60,
        lambda progress: run_headless(
            world, args.seed, args.minutes,
            config=config, goals=args.goals, kidnap_at_s=args.kidnap_at, progress=progress,
            brain=brain, brain_file=brain_file,
        ),
    )  # fmt: skip
    try:
        _tell(report, args.report)
    finally:
        if brain_file is not None:
            brain_file.save()
    return 0


def _check(args: argparse.Namespace) -> None:
    for name, value, low in (("--minutes", args.minutes, 0.0), ("--goals", args.goals, 0)):
        if not low <= value < 1e6:
            raise ValueError(f"{name} must be from {low:g} to 1e6, got {value!r}")
    for at in args.kidnap_at:
        if not 0 <= at < args.minutes * 60:
            raise ValueError(f"--kidnap-at must be from 0 to below {args.minutes * 60:g} s, got {at:g}")


def _compile() -> None:
    compiling = Compiling()
    try:
        compiling.wait(say_how_far)
    finally:
        compiling.stop()


def _tell(report: dict[str, Any], file: Path | None) -> None:
    text = json.dumps(report, indent=2) + "\n"
    if file is None:
        print(text, end="")
        return
    try:
        write_whole(file, text)
    except OSError:
        print(text, end="")  # the run is over: its report is not lost for want of a file
        raise
    reached = sum(goal["reached"] for goal in report["goals"])
    goals = f", {reached} of {len(report['goals'])} goals reached" if report["goals"] else ""
    error = report["error_m"]
    print(
        f"{report['world']}, seed {report['seed']}: map error {error['map']} m, odometry alone {error['odometry']} m{goals}; "
        f"{report['real_time_factor']:g} x real time; report in {file}"
    )
