"""One trial of ACRA 2006 by its own two numbers, size and ambiguity, outside of the table's levels."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

from app.trials.course import Course
from app.trials.experiment import EngineName, find_experiment
from app.trials.steps import Values
from app.trials.trial import Result, Trial

PER_CENT = 0.01
_CAMERA: dict[str, str] = {"paper": "template", "ours": "image and sonars"}


def trial_of(pose_cells: int, ambiguity: float, vision: str, engine: EngineName, seed: int) -> Trial:
    """ambiguity: N_vis in per cent. vision: "camera" or "scene", numbers of scenes from the true pose, as in the paper."""
    table = find_experiment("table")
    first = table.make_trials([engine], 1)[0]
    values: Values = {
        **first.values,
        "local_view.front_end": "scene numbers" if vision == "scene" else _CAMERA[engine],
        "robot.camera": vision == "camera",
        "pose_cells.n_x": pose_cells,
        "pose_cells.n_y": pose_cells,
        "local_view.false_positives": ambiguity * PER_CENT,
    }
    return replace(first, levels=(f"{ambiguity:g} %", f"{pose_cells} x {pose_cells}"), seed=seed, values=values)


def report_of(result: Result, course: Course, args: argparse.Namespace) -> dict[str, Any]:
    """The report. docs/reports.md tells what each key means."""
    return {
        "pose_cells": args.pose_cells,
        "ambiguity": args.ambiguity,
        "vision": args.vision,
        "engine": args.engine,
        "seed": args.seed,
        "goals": [
            {
                "name": visit.name,
                "reached": visit.reached,
                "time_s": round(visit.time_s, 3),
                "miss_m": round(visit.miss_m, 3),
                "why": visit.why,
            }
            for visit in course.visits
        ],
        "error_m": round(result.scores["error_m"], 3),
        "wall_s": round(result.wall_s, 3),
        "simulated_s": round(result.simulated_s, 3),
        "state_hash": result.state_hash,
    }
