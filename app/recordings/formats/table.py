"""A CSV file beside pictures or a video: which column means what, and its rows."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from app.recordings.formats.lines import lines_of
from app.recordings.formats.problems import Problems, plain
from app.recordings.formats.sensed import Picture, Rates, Sensed, ns_of

# What a column is for, by its name without unit. Units: m, s, rad, unless the name ends with another.
NAMES: dict[str, tuple[str, ...]] = {
    "time": ("time", "timestamp", "t", "stamp", "time_stamp", "sec", "secs", "seconds", "elapsed"),
    "image": ("image", "file", "filename", "image_file", "imagefile", "image_path", "picture", "path", "frame_file"),
    "speed": ("speed", "v", "vx", "linear_x", "velocity", "linear_velocity", "linear", "forward_speed"),
    "yaw_rate": ("yaw_rate", "yawrate", "omega", "wz", "angular_z", "gyro_z", "gyr_z", "angular_velocity", "turn_rate"),
    "throttle": ("throttle",),
    "x": ("x", "truth_x", "true_x", "gt_x", "pos_x"),
    "y": ("y", "truth_y", "true_y", "gt_y", "pos_y"),
    "heading": ("heading", "theta", "yaw", "truth_heading", "true_heading", "gt_heading", "truth_yaw", "truth_theta"),
    "odom_x": ("odom_x", "odometry_x"),
    "odom_y": ("odom_y", "odometry_y"),
    "odom_heading": ("odom_heading", "odom_theta", "odom_yaw", "odometry_heading"),
}
_MEANING = {name: meaning for meaning, names in NAMES.items() for name in names}
UNITS = {
    "time": {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0},
    "angle": {"deg": math.pi / 180, "deg_s": math.pi / 180, "rad": 1.0, "rad_s": 1.0},
    "length": {"m": 1.0, "m_s": 1.0, "mm": 1e-3, "cm": 1e-2, "km_h": 1 / 3.6, "kmh": 1 / 3.6, "mps": 1.0},
}
_KIND = {"time": "time", "yaw_rate": "angle", "heading": "angle", "odom_heading": "angle", "image": "", "throttle": ""}
LARGEST = 1e9  # of a measured value; more is no robot's


@dataclass(frozen=True, slots=True)
class Column:
    at: int  # its number in a row, from 0
    name: str  # as the file has it
    factor: float  # of its unit


def header_of(path: Path) -> dict[str, Column]:
    """Meaning -> column, of those that are known; empty if the first line is no header of such a table."""
    for _, line in lines_of(path):
        return _columns(next(csv.reader([line], delimiter=_delimiter(line)), list[str]()))
    return {}


def _delimiter(line: str) -> str:
    return max(",;\t", key=line.count)


def _columns(names: list[str]) -> dict[str, Column]:
    found: dict[str, Column] = {}
    for at, name in enumerate(names):
        words = re.sub(r"[^a-z0-9]+", "_", name.strip().lower()).strip("_")
        for meaning, factor in _readings(words):
            found.setdefault(meaning, Column(at, plain(name.strip(), 40), factor))
            break
    return found


def _readings(words: str) -> Iterator[tuple[str, float]]:
    """Meaning and factor of a column's name, with or without a unit at its end."""
    if words in _MEANING:
        yield _MEANING[words], 1.0
    for units in UNITS.values():
        for unit, factor in units.items():
            meaning = _MEANING.get(words.removesuffix("_" + unit)) if words.endswith("_" + unit) else None
            if meaning is not None and units is UNITS.get(_KIND.get(meaning, "length")):
                yield meaning, factor


class Table:
    """The rows of a CSV file, read one by one."""

    def __init__(self, path: Path) -> None:
        """ValueError: its first line names no column that is known."""
        self.path, self.columns = path, header_of(path)
        if not self.columns:
            known = ", ".join(names[0] for names in NAMES.values())
            raise ValueError(f"{path.name}: line 1: names no column that is known; known are {known}, ...")
        self._time_factor: float | None = None

    def rows(self, problems: Problems) -> Iterator[tuple[int, list[str]]]:
        """Number of the line and cells. A line that cannot be cut into cells is a problem and left out."""
        delimiter = ","
        for number, line in lines_of(self.path):
            if number == 1:
                delimiter = _delimiter(line)
            elif line.strip():
                try:
                    yield number, next(csv.reader([line], delimiter=delimiter))
                except (csv.Error, StopIteration) as error:
                    problems.add("lines left out", self.where(number), f"left out: {error}")

    def where(self, number: int) -> str:
        return f"{self.path.name}: line {number}"

    def text(self, cells: list[str], meaning: str) -> str:
        """A cell; empty if there is none."""
        column = self.columns.get(meaning)
        return cells[column.at].strip() if column is not None and column.at < len(cells) else ""

    def value(self, cells: list[str], meaning: str) -> float | None:
        """A number in SI units; None for an empty cell. ValueError: it is none, or far too large."""
        text = self.text(cells, meaning)
        if not text:
            return None
        number, column = _number(text, self.columns[meaning].name), self.columns[meaning]
        if not abs(number * column.factor) <= LARGEST:
            raise ValueError(f"{column.name}: {text[:40]!r} is far too large; at most {LARGEST:g} in m, s and rad")
        return number * column.factor

    def time_ns(self, cells: list[str]) -> int | None:
        """The time of a row. Without a unit in its name, a large first time is taken as ms, us or ns since 1970."""
        text = self.text(cells, "time")
        if not text:
            return None
        column = self.columns["time"]
        number = _number(text, column.name)
        if self._time_factor is None:
            self._time_factor = column.factor if column.factor != 1.0 else _guessed(number)
        return ns_of(text, round(self._time_factor * 1e9))

    def sensed(self, cells: list[str], time_ns: int, where: str, rates: Rates, image: Picture | None) -> Sensed:
        """What a row tells. ValueError: one of its values is wrong."""
        speed, yaw_rate = self.value(cells, "speed"), self.value(cells, "yaw_rate")
        odometry = [self.value(cells, name) for name in ("odom_x", "odom_y", "odom_heading")]
        truth = [self.value(cells, name) for name in ("x", "y", "heading")]
        moved = (
            None if None in odometry else rates.since(time_ns, (odometry[0] or 0, odometry[1] or 0, odometry[2] or 0))
        )
        if moved is not None:
            speed, yaw_rate = moved[0] if speed is None else speed, moved[1] if yaw_rate is None else yaw_rate
        return Sensed(
            time_ns, where, image, None, speed, yaw_rate, self.value(cells, "throttle"),
            None if None in truth else (truth[0] or 0.0, truth[1] or 0.0, truth[2] or 0.0),
        )  # fmt: skip

    @property
    def uses(self) -> tuple[str, ...]:
        """Sentences: which column is used for what."""
        words = {"x": "truth's x", "y": "truth's y", "heading": "truth's heading", "yaw_rate": "yaw rate"}
        return tuple(
            f"{words.get(meaning, meaning.replace('_', ' '))}: column {column.name!r} of {plain(self.path.name)}"
            for meaning, column in self.columns.items()
        )


def _number(text: str, name: str) -> float:
    try:
        number = float(text) if len(text) < 100 else math.nan
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name}: {text[:40]!r} is not a finite number")
    return number


def _guessed(first: float) -> float:
    """The unit of times since 1970, from the first one; below 1e11 they are seconds."""
    return next((factor for above, factor in ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3)) if abs(first) >= above), 1.0)
