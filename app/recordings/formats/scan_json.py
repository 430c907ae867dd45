"""Scans and wheels as one JSON object, as the logs of Intel are passed on: {"map": {time: {"range": [...], "x": ...}}}."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np

from app.recordings.formats.carmen import SICK_LIMIT_M, front_angles
from app.recordings.formats.lines import UNPACKED, open_whole
from app.recordings.formats.problems import Problems
from app.recordings.formats.sensed import Beams, Rates, Sensed, ns_of
from app.recordings.formats.streamed import StreamedRecording

MOST_BYTES = 200_000_000  # unpacked; a JSON object has to be read as a whole
MOST_BEAMS = 10_000


def open_scans(path: Path) -> StreamedRecording:
    """ValueError: it is no such file."""
    scans = _read(path)
    uses = (f"ranges: {len(scans)} scans", "speed and yaw rate: the robot's poses beside them")
    return StreamedRecording(path.name, "scans as JSON", partial(_sensed, path.name, scans), uses)


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


def _sensed(name: str, scans: dict[str, dict[str, Any]], problems: Problems) -> Iterator[Sensed]:
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
