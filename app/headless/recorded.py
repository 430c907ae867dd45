"""A recording played without a server, as fast as possible, and its report: `ratslam headless --recording`."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np

from app.evaluation.alignment import rmse
from app.headless.loop import Progress, silent
from app.headless.report import rounded, size
from app.recordings.playing import Player, Step
from app.recordings.recording import Pose
from app.recordings.trace import Trace
from ratslam_core import Pose2, RatSlam

TELL_AFTER = 20  # moments between two calls of `progress`


def run_recording(player: Player, progress: Progress = silent) -> tuple[dict[str, Any], Trace, RatSlam]:
    """Play a recording to its end. Returns the report, the trace and the brain. What the recording lacks is absent.

    ValueError: nothing in it could be played after all.
    """
    trace, judging, began = Trace(), _Judging(), time.perf_counter()
    step: Step | None = None
    told_s = 0.0
    for count, step in enumerate(player.steps(), start=1):
        trace.note(step)
        judging.note(step)
        if count % TELL_AFTER == 0:
            progress(step.moment.time_s - told_s, "playing")
            told_s = step.moment.time_s
    about = player.recording.about
    if step is None:
        raise ValueError(f"{about.name}: no moment of it can be played. {' '.join(about.problems[:1])}".strip())
    wall = time.perf_counter() - began
    report: dict[str, Any] = {
        "recording": about.name,
        "format": about.format,
        "has": sorted(about.has),
        "seed": player.seed,
        "simulated_s": round(step.moment.time_s, 3),
        "wall_s": round(wall, 3),
        "real_time_factor": round(step.moment.time_s / max(wall, 1e-9), 1),
        "frames": len(trace),
        "metres": round(judging.metres, 3),
        **size(step.brain),
        **judging.error(trace, step.brain),
        "problems": list(about.problems),
        "state_hash": step.brain.digest().hex(),
    }
    return report, trace, step.brain


class _Judging:
    """Keeps what is needed to compare the way with the truth."""

    def __init__(self) -> None:
        self.metres = 0.0
        self._pose = Pose2(0.0, 0.0, 0.0)
        self._odometry: list[tuple[float, float]] = []
        self._truth: list[Pose] = []
        self._at: list[int] = []  # rows of the trace that have a truth
        self._row = 0

    def note(self, step: Step) -> None:
        way, turn = step.motion.speed * step.motion.dt, step.motion.yaw_rate * step.motion.dt
        self._pose = self._pose.compose(Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn))
        self.metres += abs(way)
        if step.moment.truth is not None:
            self._truth.append(step.moment.truth)
            self._odometry.append((self._pose.x, self._pose.y))
            self._at.append(self._row)
        self._row += 1

    def error(self, trace: Trace, brain: RatSlam) -> dict[str, Any]:
        """RMSE (m) of the way through the map and by odometry alone, each laid on the truth; nothing without a truth."""
        if not self._truth:
            return {}
        truth = np.array(self._truth)[:, :2]
        mapped = trace.poses(brain.experience_map)[self._at, :2]
        return {
            "error_m": {
                "map": rounded(rmse(mapped, truth)),
                "odometry": rounded(rmse(np.array(self._odometry), truth)),
            }
        }
