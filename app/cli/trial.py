"""`ratslam trial`: one trial of ACRA 2006: 20 minutes of exploring, then three goals in the corners, in order."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from app.cli.options import ENGINES, Verbs
from app.cli.progress import compile_first, with_progress
from app.cli.reports import write_report
from disk import require_writable

SIZES = (8, 512)


def add_trial(commands: Verbs) -> None:
    trial = commands.add_parser("trial", help="one trial of the 2006 study: explore, then three goals in the corners")
    trial.add_argument("--pose-cells", type=int, default=64, metavar="N", help="N x N pose cells (default 64)")
    trial.add_argument(
        "--ambiguity",
        type=float,
        default=0.0,
        metavar="%",
        help="N_vis: per cent of scenes taken for others (default 0)",
    )
    trial.add_argument("--vision", choices=("camera", "scene"), default="camera", help="images, or numbers of scenes")
    trial.add_argument("--engine", choices=ENGINES, default="ours", help="our rules or the paper's")
    trial.add_argument("--seed", type=int, default=1, help="same seed, same trial (default 1)")
    trial.add_argument(
        "--report", type=Path, metavar="FILE", help="write the report to FILE as JSON (default: print it)"
    )
    trial.set_defaults(do=_trial)


def _trial(args: argparse.Namespace) -> int:
    low, high = SIZES
    if not low <= args.pose_cells <= high:
        raise ValueError(f"--pose-cells must be from {low} to {high}, got {args.pose_cells}")
    if not 0 <= args.ambiguity <= 100:
        raise ValueError(f"--ambiguity must be from 0 to 100 (per cent), got {args.ambiguity:g}")
    if not 0 <= args.seed < 2**32:
        raise ValueError(f"--seed must be from 0 to {2**32 - 1}, got {args.seed}")
    require_writable("--report", args.report)
    from app.trials.size_and_ambiguity import SizeAndAmbiguity
    from app.trials.trial import run_trial

    asked = SizeAndAmbiguity(args.pose_cells, args.ambiguity, args.vision, args.engine, args.seed)
    compile_first()
    result, course = with_progress(20 * 60 + 3 * 40, lambda progress: run_trial(asked.trial, progress))
    report = asked.report(result, course)
    write_report(report, args.report, _words(report))
    return 0


def _words(report: dict[str, Any]) -> str:
    reached = sum(goal["reached"] for goal in report["goals"])
    cells = report["pose_cells"]
    return (
        f"{cells} x {cells} pose cells, {report['ambiguity']:g} %, {report['vision']}, {report['engine']}, seed "
        f"{report['seed']}: {reached} of {len(report['goals'])} goals reached, map error {report['error_m']} m"
    )
