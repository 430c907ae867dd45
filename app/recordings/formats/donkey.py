"""Tubs of Donkey cars: the catalogs of version 2, and the files `record_N.json` of version 1."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, cast

from app.recordings.formats.files import lines_of
from app.recordings.formats.lying import by_number
from app.recordings.formats.pictures import beside, read_picture, within
from app.recordings.formats.sensed import Problems, Sensed, ns_of
from app.recordings.formats.streamed import StreamedRecording
from disk.words import plain

MANIFEST = "manifest.json"
SPEEDS = ("enc/speed", "pos/speed", "rs2/vel", "odom/speed")
_RECORDS = "records"
RATE_HZ = 20.0  # a Donkey car's loop, where no record tells its time
_USES = (
    "camera: cam/image_array",
    "throttle: user/throttle, or pilot/throttle while the pilot drives",
    "yaw rate: imu/gyr_z in degrees a second, up is positive",
    f"speed: {' or '.join(SPEEDS)} in m/s",
)


def open_tub(folder: Path, used: set[str]) -> StreamedRecording:
    """Frames are counted as in the catalogs; those that were deleted are left out. Without a manifest all catalogs are read.

    used: is filled with the names of the files that belong to it. ValueError: it is none.
    """
    return StreamedRecording(folder.name, "Donkey tub", partial(_sensed, folder, used), uses=_USES)


def open_old_tub(folder: Path, used: set[str]) -> StreamedRecording:
    """A tub of version 1: one JSON file a record."""
    return StreamedRecording(folder.name, "Donkey tub, version 1", partial(_old, folder, used), uses=_USES)


def _sensed(folder: Path, used: set[str], problems: Problems) -> Iterator[Sensed]:
    catalogs, deleted = _catalogs(folder, problems)
    used |= {MANIFEST, *catalogs, *(f"{catalog}_manifest" for catalog in catalogs)}
    row = 0
    for catalog in catalogs:
        try:
            path = within(folder, catalog)
            for number, line in lines_of(path):
                if line.strip():
                    where = f"{path.name}: line {number}"
                    if (sensed := _record(folder, line, where, row, deleted, used, problems)) is not None:
                        yield sensed
                    row += 1
        except ValueError as error:
            problems.add("catalogs left out", MANIFEST, f"the rest of {catalog!r} is left out: {error}")


def _catalogs(folder: Path, problems: Problems) -> tuple[list[str], frozenset[int]]:
    """Names of the catalogs, and the numbers of records that were deleted; of a tub whose manifest is gone or tells nothing,
    all catalogs there are."""
    there = sorted((path.name for path in folder.glob("*.catalog")), key=by_number)
    try:
        return _manifest(folder)
    except ValueError as error:
        if not there:
            raise
        what = str(error).removeprefix(f"{MANIFEST}: ") if (folder / MANIFEST).exists() else "it is not there"
        problems.add("manifest", MANIFEST, f"{what}; all catalogs are read, with the records that were deleted")
        return there, frozenset()


def _manifest(folder: Path) -> tuple[list[str], frozenset[int]]:
    """Names of the catalogs, and the numbers of records that were deleted."""
    for _, line in lines_of(folder / MANIFEST):
        about = _json(line, MANIFEST) if '"paths"' in line else None
        if not isinstance(about, dict):
            continue
        paths, deleted = cast(Any, about).get("paths"), cast(list[Any], cast(Any, about).get("deleted_indexes") or [])
        if not isinstance(paths, list) or not all(isinstance(path, str) for path in cast(list[Any], paths)):
            raise ValueError(f"{MANIFEST}: paths must be a list of names")
        if type(deleted) is not list:
            raise ValueError(f"{MANIFEST}: deleted_indexes must be a list of numbers")
        return cast(list[str], paths), frozenset(index for index in deleted if isinstance(index, int))
    raise ValueError(f"{MANIFEST}: no line with the paths of the catalogs")


def _record(
    folder: Path, line: str, where: str, row: int, deleted: frozenset[int], used: set[str], problems: Problems
) -> Sensed | None:
    try:
        record = _json(line, where)
        if not isinstance(record, dict):
            raise ValueError("not a record")
        named = cast(dict[str, Any], record)
        if named.get("_index") in deleted if isinstance(named.get("_index"), int) else row in deleted:
            used.add(f"images/{named.get('cam/image_array')}")
            return None
        problems.seen(_RECORDS)
        return _made(folder, named, where, row, "_timestamp_ms", used)
    except ValueError as error:
        problems.add("records left out", where, f"left out: {error}")
        return None


def _old(folder: Path, used: set[str], problems: Problems) -> Iterator[Sensed]:
    names = sorted((path.name for path in folder.glob("record_*.json")), key=by_number)
    used.update(names)
    for row, name in enumerate(names):
        problems.seen(_RECORDS)
        try:
            text = "\n".join(line for _, line in lines_of(within(folder, name)))
            record = _json(text, name)
            if not isinstance(record, dict):
                raise ValueError("not a record")
            yield _made(folder, cast(dict[str, Any], record), plain(name), row, "milliseconds", used)
        except ValueError as error:
            problems.add("records left out", plain(name), f"left out: {error}")


def _made(folder: Path, record: dict[str, Any], where: str, row: int, clock: str, used: set[str]) -> Sensed:
    time_ms = None if _number(record, clock) is None else ns_of(str(record[clock]), 1_000_000)
    time_ns = round(row * 1e9 / RATE_HZ) if time_ms is None else time_ms
    name = record.get("cam/image_array")
    if not isinstance(name, str):
        raise ValueError("no cam/image_array")
    path = beside(folder, name)
    used.add(path.relative_to(folder.resolve()).as_posix())
    gyro = _number(record, "imu/gyr_z")
    driver = "pilot" if record.get("user/mode") not in ("user", None) and "pilot/throttle" in record else "user"
    return Sensed(
        time_ns, where, partial(read_picture, path),
        speed=next((speed for key in SPEEDS if (speed := _number(record, key)) is not None), None),
        yaw_rate=None if gyro is None else math.radians(gyro),
        throttle=_number(record, f"{driver}/throttle"), frame=row, source=_RECORDS,
    )  # fmt: skip


def _number(record: dict[str, Any], key: str) -> float | None:
    value = record.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e15:
        raise ValueError(f"{key} must be a finite number, got {str(value)[:40]!r}")
    return float(value)


def _json(text: str, where: str) -> object:
    try:
        return cast(object, json.loads(text))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{where}: not JSON: {error}") from None
