"""Logs of robots with a laser: its scans as what is seen, the raw wheels as odometry. As text, by CARMEN; and as one JSON
object, as the logs of Intel are passed on: {"map": {time: {"range": [...], "x": ...}}}.
"""

from __future__ import annotations

import json
import math
import re
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.files import UNPACKED, lines_of, open_whole
from app.recordings.formats.sensed import Beams, Problems, Rates, Sensed, ns_of
from app.recordings.formats.streamed import StreamedRecording
from app.recordings.recording import Pose
from disk.words import plain

SICK_LIMIT_M = 81.0  # a SICK laser reports 81.83 m and the like where nothing comes back
# What makes a text a log of CARMEN. Of lasers of which there are several, the first one looks ahead.
WORDS = ("FLASER", "ROBOTLASER1", "RAWLASER1", "ODOM", "RLASER", "TRUEPOS")
_LASERS = re.compile(r"FLASER|ROBOTLASER\d|RAWLASER\d|RLASER|LASER\d")
_LEAST = 0.5  # of the lines of the laser with the most, so that a few lines of another kind do not hide it
_MOST_BEAMS, _MOST_WORDS = 10_000, 100


@lru_cache(maxsize=64)
def front_angles(beams: int, ahead: float = 0.0) -> tuple[float, ...]:
    """Of a laser that looks over half a circle, from the right to the left; ahead: of its middle (rad)."""
    step = math.pi / (beams if beams % 2 == 0 else max(1, beams - 1))
    return tuple(ahead - math.pi / 2 + k * step for k in range(beams))


@lru_cache(maxsize=64)
def _beams(start: float, step: float, n: int, limit_m: float) -> Beams:
    return Beams(tuple(start + k * step for k in range(n)), limit_m)


def open_carmen(path: Path) -> StreamedRecording:
    """The lines of one laser; odometry from their own poses, or from ODOM lines. ValueError: there is no scan in it."""
    counts = _counted(path)
    lasers = [word for word in counts if _LASERS.fullmatch(word)]
    enough = [word for word in lasers if counts[word] >= _LEAST * max(counts[laser] for laser in lasers)]
    laser = min(enough, key=_rank, default=None)
    if laser is None:
        there = ", ".join(f"{plain(word, 20)} ({n})" for word, n in list(counts.items())[:6]) or "no lines"
        raise ValueError(
            f"{path.name}: no line with a scan; expected FLASER, ROBOTLASER1, RAWLASER1 or the like, found {there}"
        )
    wheels = "ODOM lines" if laser.startswith("RAW") else f"the robot's poses in {laser} lines"
    uses = (f"ranges: {laser} lines", f"speed and yaw rate: {wheels}", "truth: TRUEPOS lines")
    unused = tuple(_unused(counts, laser))
    return StreamedRecording(path.name, "CARMEN log", partial(_sensed, path, laser), uses, unused)


def _counted(path: Path) -> Counter[str]:
    """Lines by their first word. Those of words beyond the first hundred are counted together."""
    counts: Counter[str] = Counter()
    for _, line in lines_of(path):
        if word := _word(line):
            counts[word if word in counts or len(counts) < _MOST_WORDS else "others"] += 1
    return counts


def _word(line: str) -> str:
    """The first one; empty of a comment and of an empty line."""
    cells = line.split(None, 1)
    return cells[0] if cells and not cells[0].startswith("#") else ""


def _rank(laser: str) -> tuple[int, str]:
    """FLASER, ROBOTLASER1, RAWLASER1, then those that look elsewhere."""
    return (WORDS.index(laser) if laser in WORDS else len(WORDS)), laser


def _unused(counts: Counter[str], laser: str) -> Iterator[str]:
    for word, n in counts.items():
        if word in (laser, "TRUEPOS") or (word == "ODOM" and laser.startswith("RAW")):
            continue
        why = "not read"
        if _LASERS.fullmatch(word):
            why = f"ranges come from {laser} lines"
        elif word == "ODOM":
            why = f"odometry comes from {laser} lines"
        elif word == "PARAM":
            why = "the robot's parameters are not needed"
        yield f"{plain(word, 20)}, {n} lines: {why}"


def _sensed(path: Path, laser: str, problems: Problems) -> Iterator[Sensed]:
    rates, scan = Rates(), -1
    used = {laser, "TRUEPOS", "ODOM"} if laser.startswith("RAW") else {laser, "TRUEPOS"}
    for number, line in lines_of(path):
        word = _word(line)
        if word not in used:
            continue
        source, where, cells = f"{word} lines", f"{path.name}: line {number}", line.split()
        problems.seen(source)
        scan += word == laser
        try:
            sensed = _READERS[word.rstrip("0123456789")](cells, where, rates)
            yield replace(sensed, frame=scan if word == laser else None, source=source)
        except (ValueError, IndexError, OverflowError) as error:
            what = "too few numbers" if isinstance(error, IndexError) else str(error)
            problems.add("lines left out", where, f"left out: {what}")


def _odom(cells: list[str], where: str, rates: Rates) -> Sensed:
    """ODOM x y theta tv rv accel time host time."""
    return _moved(Sensed(ns_of(cells[7]), where), _pose(cells[1:4]), rates)


def _truepos(cells: list[str], where: str, _rates: Rates) -> Sensed:
    """TRUEPOS true_x true_y true_theta odom_x odom_y odom_theta time host time, of CARMEN's simulator."""
    return Sensed(ns_of(cells[7]), where, truth=_pose(cells[1:4]))


def _laser(cells: list[str], where: str, rates: Rates) -> Sensed:
    """FLASER n r... x y theta odom_x odom_y odom_theta time host time. RLASER looks back."""
    n = _count(cells[1])
    after = cells[2 + n :]
    beams = Beams(front_angles(n, math.pi if cells[0] == "RLASER" else 0.0), SICK_LIMIT_M)
    sensed = Sensed(ns_of(after[6]), where, ranges_m=_ranges(cells[2 : 2 + n], SICK_LIMIT_M), beams=beams)
    return _moved(sensed, _pose(after[3:6]), rates)


def _robotlaser(cells: list[str], where: str, rates: Rates) -> Sensed:
    """ROBOTLASER1 type start fov step limit accuracy remission n r... m rem... laser's pose, robot's pose, ... time host time."""
    ranges, beams, after = _raw(cells)
    return _moved(Sensed(ns_of(after[11]), where, ranges_m=ranges, beams=beams), _pose(after[3:6]), rates)


def _rawlaser(cells: list[str], where: str, _rates: Rates) -> Sensed:
    """RAWLASER1 type start fov step limit accuracy remission n r... m rem... time host time."""
    ranges, beams, after = _raw(cells)
    return Sensed(ns_of(after[0]), where, ranges_m=ranges, beams=beams)


_READERS = {
    "ODOM": _odom, "TRUEPOS": _truepos, "FLASER": _laser, "RLASER": _laser, "LASER": _laser,
    "ROBOTLASER": _robotlaser, "RAWLASER": _rawlaser,
}  # fmt: skip


def _raw(cells: list[str]) -> tuple[NDArray[np.float64], Beams, list[str]]:
    """The ranges, their beams, and what comes after the remissions."""
    start, step, limit, n = float(cells[2]), float(cells[4]), float(cells[5]), _count(cells[8])
    if not (abs(start) <= 7 and abs(step) <= 7 and limit > 0):
        raise ValueError("its angles or its range are none of a laser")
    ranges, remissions = _ranges(cells[9 : 9 + n], limit), int(cells[9 + n])
    if remissions < 0:
        raise ValueError("a number of remissions below 0")
    return ranges, _beams(start, step, n, limit), cells[10 + n + remissions :]


def _ranges(cells: list[str], limit_m: float) -> NDArray[np.float64]:
    ranges = np.array([float(cell) for cell in cells])
    if np.isnan(ranges).any():
        raise ValueError("a range is not a number")
    return np.where((ranges >= limit_m) | (ranges <= 0), np.inf, ranges)


def _moved(sensed: Sensed, pose: Pose, rates: Rates) -> Sensed:
    speed, yaw_rate = rates.since(sensed.time_ns, pose) or (None, None)
    return replace(sensed, speed=speed, yaw_rate=yaw_rate)


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


MOST_BYTES = 200_000_000  # unpacked; a JSON object has to be read as a whole
MOST_BEAMS = 10_000


def open_scans(path: Path) -> StreamedRecording:
    """ValueError: it is no such file."""
    scans = _read(path)
    uses = (f"ranges: {len(scans)} scans", "speed and yaw rate: the robot's poses beside them")
    return StreamedRecording(path.name, "scans as JSON", partial(_json_sensed, path.name, scans), uses)


def _read(path: Path) -> dict[str, dict[str, Any]]:
    try:
        with open_whole(path) as file:
            most = min(MOST_BYTES, UNPACKED * path.stat().st_size + 1_000_000)
            data = file.read(most + 1)
        if len(data) > most:
            raise ValueError(f"more than {most} bytes")
        tree: Any = json.loads(data)
    except (ValueError, RecursionError, EOFError, zlib.error, OSError) as error:
        raise ValueError(f"{path.name}: cannot be read as JSON: {str(error)[:200]}") from None
    scans: Any = cast(Any, tree).get("map") if isinstance(tree, dict) else None
    if not isinstance(scans, dict) or not all(isinstance(scan, dict) for scan in cast(dict[str, Any], scans).values()):
        raise ValueError(f"{path.name}: no object 'map' of scans by their times")
    return cast(dict[str, dict[str, Any]], scans)


def _json_sensed(name: str, scans: dict[str, dict[str, Any]], problems: Problems) -> Iterator[Sensed]:
    rates = Rates()
    for number, (time, scan) in enumerate(scans.items()):
        where = f"{name}: scan {number}"
        problems.seen("scans")
        try:
            time_ns, pose = ns_of(time), (float(scan["x"]), float(scan["y"]), float(scan["theta"]))
            ranges = np.array(scan["range"], np.float64)
            if ranges.ndim != 1 or not 0 < len(ranges) <= MOST_BEAMS or np.isnan(ranges).any():
                raise ValueError(f"range must be a list of up to {MOST_BEAMS} numbers")
            if not math.hypot(*pose) < 1e7:
                raise ValueError("its pose is not finite, or far off")
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            what = f"it has no {error}" if isinstance(error, KeyError) else str(error)
            problems.add("scans left out", where, f"left out: {what}")
            continue
        speed, yaw_rate = rates.since(time_ns, pose) or (None, None)
        ranges = np.where((ranges >= SICK_LIMIT_M) | (ranges <= 0), np.inf, ranges)
        beams = Beams(front_angles(len(ranges)), SICK_LIMIT_M)
        yield Sensed(time_ns, where, None, ranges, speed, yaw_rate, frame=number, beams=beams, source="scans")
