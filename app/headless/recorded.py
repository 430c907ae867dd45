"""`ratslam headless --recording`: a recording played as fast as possible, its report, and the way through it, a row a frame."""

from __future__ import annotations

import math
import time
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.evaluation.agreement import rmse
from app.headless.report import rounded, size
from app.protocol.course import REPORT_AFTER, Progress
from app.recordings.playing import Player, Step
from app.recordings.recording import Pose
from disk import whole_file
from ratslam_core import ExperienceMap, Pose2, RatSlam

HEADER = "frame,time_s,view,experience,x,y,heading_rad,made_at_frame"
_COLUMNS = 8  # frame, time, view, experience, place beside the experience (x, y, heading), frame at which it was made


class Trace:
    """Keeps 64 bytes a frame. Places are those of the map as it is when they are asked for.

    So a loop that is closed later also mends where the robot was before; the place beside its experience is of its time.
    """

    def __init__(self) -> None:
        self._rows = array("d")
        self._made_at = array("q")

    def note(self, step: Step) -> None:
        """Note one step of the player, in the order of the steps."""
        map_, frame = step.brain.experience_map, step.moment.frame
        while len(self._made_at) < len(map_):
            self._made_at.append(frame)
        local, active = map_.local_pose, step.estimate.experience
        self._rows.extend((
            frame, step.moment.time_s, step.estimate.recognition.view, active, local.x, local.y, local.heading_rad,
            self._made_at[active],
        ))  # fmt: skip

    def __len__(self) -> int:
        return len(self._rows) // _COLUMNS

    def poses(self, map_: ExperienceMap) -> NDArray[np.float64]:
        """x, y (m), heading (rad) of each frame in the map as it is now, (n, 3)."""
        rows = np.frombuffer(self._rows, np.float64).reshape(-1, _COLUMNS)
        at = map_.poses[rows[:, 3].astype(np.int64)]
        c, s = np.cos(at[:, 2]), np.sin(at[:, 2])
        x, y = at[:, 0] + c * rows[:, 4] - s * rows[:, 5], at[:, 1] + s * rows[:, 4] + c * rows[:, 5]
        heading = np.arctan2(np.sin(at[:, 2] + rows[:, 6]), np.cos(at[:, 2] + rows[:, 6]))
        return np.stack([x, y, heading], axis=1)

    def lines(self, map_: ExperienceMap) -> Iterator[str]:
        """The table as CSV, a line at a time. Numbers are written so that they are read back exactly."""
        yield HEADER
        for k, (x, y, heading) in enumerate(self.poses(map_).tolist()):
            frame, time_s, view, experience, *_, made = self._rows[k * _COLUMNS : (k + 1) * _COLUMNS]
            yield f"{frame:.0f},{time_s!r},{view:.0f},{experience:.0f},{x!r},{y!r},{heading!r},{made:.0f}"

    def write(self, file: Path, map_: ExperienceMap) -> None:
        """Write it as CSV, wholly or not at all."""
        with whole_file(file) as out:
            for line in self.lines(map_):
                out.write(f"{line}\n".encode())


def run_recording(player: Player, progress: Progress | None = None) -> tuple[dict[str, Any], Trace, RatSlam]:
    """Play a recording to its end. Returns the report, the trace and the brain. What the recording lacks is absent.

    ValueError: nothing in it could be played after all.
    """
    trace, judging, began = Trace(), _Judging(), time.perf_counter()
    step: Step | None = None
    reported_s = 0.0
    for count, step in enumerate(player.steps(), start=1):
        trace.note(step)
        judging.note(step)
        if progress is not None and count % REPORT_AFTER == 0:
            progress(step.moment.time_s - reported_s, "playing")
            reported_s = step.moment.time_s
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
