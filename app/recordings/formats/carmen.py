"""Logs of CARMEN: the laser's scans as what is seen, the raw wheels as odometry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.lines import lines_of
from app.recordings.formats.problems import Problems
from app.recordings.formats.sensed import Rates, Sensed, ns_of
from app.recordings.formats.streamed import Beams, StreamedRecording
from app.recordings.recording import Pose

WORDS = ("FLASER", "ROBOTLASER1", "RAWLASER1", "ODOM")
SICK_LIMIT_M = 81.0  # a SICK laser reports 81.83 m and the like where nothing comes back
_MOST_BEAMS = 10_000


def front_angles(beams: int) -> tuple[float, ...]:
    """Of a laser that looks over half a circle, from the right to the left."""
    step = math.pi / (beams if beams % 2 == 0 else max(1, beams - 1))
    return tuple(-math.pi / 2 + k * step for k in range(beams))


class _Scans:
    """The kind of line that the scans are taken from, and the beams of the first."""

    def __init__(self, word: str) -> None:
        self.word = word
        self.beams = Beams()

    def ranges(self, cells: list[str], angles: tuple[float, ...], limit_m: float) -> NDArray[np.float64]:
        ranges = np.array([float(cell) for cell in cells])
        if not self.beams.angles_rad:
            self.beams = Beams(angles, limit_m)
        if len(ranges) != len(self.beams.angles_rad):
            raise ValueError(f"{len(ranges)} ranges, but the first scan has {len(self.beams.angles_rad)}")
        if np.isnan(ranges).any():
            raise ValueError("a range is not a number")
        return np.where((ranges >= limit_m) | (ranges <= 0), np.inf, ranges)


def open_carmen(path: Path) -> StreamedRecording:
    """FLASER, ROBOTLASER1 or RAWLASER1 lines; odometry from their own poses, or from ODOM lines. ValueError: none of them."""
    counts: dict[str, int] = dict.fromkeys(WORDS, 0)
    for _, line in lines_of(path):
        word = line.split(" ", 1)[0]
        if word in counts:
            counts[word] += 1
    word = next((name for name in WORDS[:3] if counts[name]), None)
    if word is None:
        raise ValueError(f"{path.name}: no line with a scan; expected FLASER, ROBOTLASER1 or RAWLASER1")
    scans = _Scans(word)
    wheels = "ODOM lines" if word == "RAWLASER1" else f"the robot's poses in {word} lines"
    uses = (f"ranges: {counts[word]} {word} lines", f"speed and yaw rate: {wheels}")
    return StreamedRecording(path.name, "CARMEN log", partial(_sensed, path, scans), lambda: scans.beams, uses)


def _sensed(path: Path, scans: _Scans, problems: Problems) -> Iterator[Sensed]:
    rates = Rates()
    for number, line in lines_of(path):
        cells = line.split()
        if not cells or cells[0] not in (scans.word, "ODOM"):
            continue
        try:
            where = f"{path.name}: line {number}"
            if cells[0] == "ODOM":
                if scans.word == "RAWLASER1":
                    yield _moved(ns_of(cells[7]), where, None, _pose(cells[1:4]), rates)
            else:
                yield _READERS[cells[0]](cells, where, scans, rates)
        except (ValueError, IndexError, OverflowError) as error:
            what = "too few numbers" if isinstance(error, IndexError) else str(error)
            problems.add("lines left out", f"{path.name}: line {number}", f"left out: {what}")


def _flaser(cells: list[str], where: str, scans: _Scans, rates: Rates) -> Sensed:
    """FLASER n r... x y theta odom_x odom_y odom_theta time host time."""
    n = _count(cells[1])
    after = cells[2 + n :]
    ranges = scans.ranges(cells[2 : 2 + n], front_angles(n), SICK_LIMIT_M)
    return _moved(ns_of(after[6]), where, ranges, _pose(after[3:6]), rates)


def _robotlaser(cells: list[str], where: str, scans: _Scans, rates: Rates) -> Sensed:
    """ROBOTLASER1 type start fov step limit accuracy remission n r... m rem... laser's pose, robot's pose, ... time host time."""
    ranges, after = _raw(cells, scans)
    return _moved(ns_of(after[11]), where, ranges, _pose(after[3:6]), rates)


def _rawlaser(cells: list[str], where: str, scans: _Scans, _rates: Rates) -> Sensed:
    """RAWLASER1 type start fov step limit accuracy remission n r... m rem... time host time."""
    ranges, after = _raw(cells, scans)
    return Sensed(ns_of(after[0]), where, ranges_m=ranges)


_READERS = {"FLASER": _flaser, "ROBOTLASER1": _robotlaser, "RAWLASER1": _rawlaser}


def _raw(cells: list[str], scans: _Scans) -> tuple[NDArray[np.float64], list[str]]:
    """The ranges, and what comes after the remissions."""
    start, step, limit, n = float(cells[2]), float(cells[4]), float(cells[5]), _count(cells[8])
    if not (abs(start) <= 7 and abs(step) <= 7 and limit > 0):
        raise ValueError("its angles or its range are none of a laser")
    ranges = scans.ranges(cells[9 : 9 + n], tuple(start + k * step for k in range(n)), limit)
    remissions = int(cells[9 + n])
    if remissions < 0:
        raise ValueError("a number of remissions below 0")
    return ranges, cells[10 + n + remissions :]


def _moved(time_ns: int, where: str, ranges: NDArray[np.float64] | None, pose: Pose, rates: Rates) -> Sensed:
    speed, yaw_rate = rates.since(time_ns, pose) or (None, None)
    return Sensed(time_ns, where, None, ranges, speed, yaw_rate)


def _count(text: str) -> int:
    n = int(text)
    if not 0 < n <= _MOST_BEAMS:
        raise ValueError(f"{n} ranges; from 1 to {_MOST_BEAMS} can be")
    return n


def _pose(cells: list[str]) -> Pose:
    x, y, heading = (float(cell) for cell in cells)
    if not (math.hypot(x, y) < 1e7 and abs(heading) < 1e6):
        raise ValueError("the robot's pose is not finite, or far off")
    return x, y, heading
