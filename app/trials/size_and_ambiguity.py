"""One trial of ACRA 2006 by its own two numbers, size and ambiguity, outside of the table's levels."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from app.trials.course import Course
from app.trials.experiment import EngineName, find_experiment
from app.trials.steps import Values
from app.trials.trial import Result, Trial

PER_CENT = 0.01
_CAMERA: dict[str, str] = {"paper": "template", "ours": "image and sonars"}


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
        first = find_experiment("table").make_trials([self.engine], 1)[0]
        size = self.pose_cells
        values: Values = {
            **first.values,
            "local_view.front_end": "scene numbers" if self.vision == "scene" else _CAMERA[self.engine],
            "robot.camera": self.vision == "camera",
            "pose_cells.n_x": size,
            "pose_cells.n_y": size,
            "local_view.false_positives": self.ambiguity * PER_CENT,
        }
        return replace(first, levels=(f"{self.ambiguity:g} %", f"{size} x {size}"), seed=self.seed, values=values)

    def report(self, result: Result, course: Course) -> dict[str, Any]:
        """The report. docs/reports.md tells what each key means."""
        goals = [
            {
                "name": visit.name,
                "reached": visit.reached,
                "time_s": round(visit.time_s, 3),
                "miss_m": round(visit.miss_m, 3),
                "why": visit.why,
            }
            for visit in course.visits
        ]
        return {
            **asdict(self),
            "goals": goals,
            "error_m": round(result.scores["error_m"], 3),
            "wall_s": round(result.wall_s, 3),
            "simulated_s": round(result.simulated_s, 3),
            "state_hash": result.state_hash,
        }
