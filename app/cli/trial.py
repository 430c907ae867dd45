"""`ratslam trial`: one trial of ACRA 2006 by its own two numbers, size and ambiguity, outside of the table's levels.

20 minutes of exploring, then three goals in the corners, in order.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from app.cli.options import ENGINES, Verbs, compile_first, with_progress, write_report
from disk import require_writable

if TYPE_CHECKING:
    from app.protocol.course import Course
    from app.protocol.experiment import EngineName
    from app.protocol.steps import Values
    from app.protocol.trial import Result, Trial

_SIZES = (8, 512)
_PER_CENT = 0.01
_CAMERA: dict[str, str] = {"paper": "template", "ours": "image and sonars"}


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
    low, high = _SIZES
    if not low <= args.pose_cells <= high:
        raise ValueError(f"--pose-cells must be from {low} to {high}, got {args.pose_cells}")
    if not 0 <= args.ambiguity <= 100:
        raise ValueError(f"--ambiguity must be from 0 to 100 (per cent), got {args.ambiguity:g}")
    if not 0 <= args.seed < 2**32:
        raise ValueError(f"--seed must be from 0 to {2**32 - 1}, got {args.seed}")
    require_writable("--report", args.report)
    from app.protocol.trial import run_trial

    asked = SizeAndAmbiguity(args.pose_cells, args.ambiguity, args.vision, args.engine, args.seed)
    compile_first()
    result, course = with_progress(20 * 60 + 3 * 40, lambda progress: run_trial(asked.trial, progress))
    report = asked.report(result, course)
    write_report(report, args.report, _words(report))
    return 0


@dataclass(frozen=True, slots=True)
class SizeAndAmbiguity:
    """vision: "camera" or "scene", numbers of scenes from the true pose, as in the paper."""

    pose_cells: int  # along each side
    ambiguity: float  # N_vis, per cent
    vision: Literal["camera", "scene"]
    engine: EngineName
    seed: int

    @property
    def trial(self) -> Trial:
        """The table's trial with these numbers."""
        from app.protocol.experiment import find_experiment

        first = find_experiment("table").make_trials([self.engine], 1)[0]
        size = self.pose_cells
        values: Values = {
            **first.values,
            "local_view.front_end": "scene numbers" if self.vision == "scene" else _CAMERA[self.engine],
            "robot.camera": self.vision == "camera",
            "pose_cells.n_x": size,
            "pose_cells.n_y": size,
            "local_view.false_positives": self.ambiguity * _PER_CENT,
        }
        return replace(first, levels=(f"{self.ambiguity:g} %", f"{size} x {size}"), seed=self.seed, values=values)

    def report(self, result: Result, course: Course) -> dict[str, Any]:
        """The report. docs/reports.md tells what each key means."""
        goals = [
            {
                "name": visit.name, "reached": visit.reached, "time_s": round(visit.time_s, 3),
                "miss_m": round(visit.miss_m, 3), "why": visit.why,
            }
            for visit in course.visits
        ]  # fmt: skip
        return {
            **asdict(self),
            "goals": goals,
            "error_m": round(result.scores["error_m"], 3),
            "wall_s": round(result.wall_s, 3),
            "simulated_s": round(result.simulated_s, 3),
            "state_hash": result.state_hash,
        }


def _words(report: dict[str, Any]) -> str:
    reached = sum(goal["reached"] for goal in report["goals"])
    cells = report["pose_cells"]
    return (
        f"{cells} x {cells} pose cells, {report['ambiguity']:g} %, {report['vision']}, {report['engine']}, seed "
        f"{report['seed']}: {reached} of {len(report['goals'])} goals reached, map error {report['error_m']} m"
    )
