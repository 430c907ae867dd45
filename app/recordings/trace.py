"""The way through a recording, a row a frame."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.recordings.playing import Step
from disk import whole_file
from ratslam_core import ExperienceMap

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
