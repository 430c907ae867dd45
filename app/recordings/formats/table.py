"""A table beside pictures or a video, or of a folder: which column means what, and its rows."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.recordings.formats.cells import columns_without_header, is_picture, ns_of_date, samples, style_of
from app.recordings.formats.files import lines_of
from app.recordings.formats.lying import rank_of
from app.recordings.formats.sensed import Picture, Problems, Rates, Sensed, ns_of
from app.recordings.recording import Pose
from disk.words import plain

_IMU = {f"{kind}_{axis}": tuple(f"{name}_{axis}" for name in names) for kind, names in (
    ("gyro", ("gyro", "gyr", "w_rs_s", "angular_velocity", "imu_gyr")),
    ("acc", ("acc", "accel", "a", "a_rs_s", "linear_acceleration", "acceleration", "imu_acl")),
) for axis in "xyz"}  # fmt: skip
# What a column is for, by its name without unit. Units: m, s, rad, unless the name ends with another.
NAMES: dict[str, tuple[str, ...]] = {
    "time": ("time", "timestamp", "t", "stamp", "time_stamp", "sec", "secs", "seconds", "elapsed", "datetime", "date_time"),
    "image": ("image", "file", "filename", "image_file", "imagefile", "image_path", "picture", "path", "frame_file",
              "center", "centre", "img", "image_name", "center_image", "rgb"),
    "speed": ("speed", "v", "vx", "linear_x", "velocity", "linear_velocity", "linear", "forward_speed"),
    "yaw_rate": ("yaw_rate", "yawrate", "omega", "wz", "angular_z", "angular_velocity", "turn_rate"),
    "throttle": ("throttle",),
    "x": ("x", "truth_x", "true_x", "gt_x", "pos_x", "tx", "p_rs_r_x", "position_x"),
    "y": ("y", "truth_y", "true_y", "gt_y", "pos_y", "ty", "p_rs_r_y", "position_y"),
    "heading": ("heading", "theta", "yaw", "truth_heading", "true_heading", "gt_heading", "truth_yaw", "truth_theta"),
    "odom_x": ("odom_x", "odometry_x"),
    "odom_y": ("odom_y", "odometry_y"),
    "odom_heading": ("odom_heading", "odom_theta", "odom_yaw", "odometry_heading"),
    **{f"q{axis}": (f"q{axis}", f"q_{axis}", f"quat_{axis}", f"q_rs_{axis}", f"orientation_{axis}") for axis in "xyzw"},
    **_IMU,
    **{f"pose_{row}{column}": (f"pose_{row}{column}",) for row in range(3) for column in range(4)},
}  # fmt: skip
_MEANING = {name: meaning for meaning, names in NAMES.items() for name in names}
UNITS = {
    "time": {"ns": 1e-9, "nsec": 1e-9, "us": 1e-6, "usec": 1e-6, "ms": 1e-3, "msec": 1e-3, "s": 1.0, "sec": 1.0},
    "angle": {"deg": math.pi / 180, "deg_s": math.pi / 180, "deg_s_1": math.pi / 180, "dps": math.pi / 180,
              "rad": 1.0, "rad_s": 1.0, "rad_s_1": 1.0},
    "length": {"m": 1.0, "m_s": 1.0, "m_s_1": 1.0, "mps": 1.0, "mm": 1e-3, "cm": 1e-2, "km_h": 1 / 3.6, "kmh": 1 / 3.6,
               "kph": 1 / 3.6, "mph": 0.44704, "mi_h": 0.44704, "knots": 1852 / 3600},
    "acceleration": {"m_s_2": 1.0, "m_s2": 1.0, "g": 9.80665, "mg": 0.00980665},
}  # fmt: skip
_OF_KIND = {
    "time": ("time",),
    "length": ("speed", "x", "y", "odom_x", "odom_y"),
    "angle": ("yaw_rate", "heading", "odom_heading", "gyro_x", "gyro_y", "gyro_z"),
    "acceleration": ("acc_x", "acc_y", "acc_z"),
}
_KIND = {meaning: kind for kind, meanings in _OF_KIND.items() for meaning in meanings}
_DRIVEN = {"center", "left", "right", "steering", "throttle", "speed"}  # the columns of Udacity's simulator, in mph
_GROUPS = (
    ("x", "y", "heading"), ("x", "y", "qx", "qy", "qz", "qw"), tuple(name for name in NAMES if name.startswith("pose_")),
    ("odom_x", "odom_y", "odom_heading"), ("gyro_x", "gyro_y", "gyro_z", "acc_x", "acc_y", "acc_z"), ("gyro_z",),
)  # fmt: skip
_POSES = _GROUPS[:3]
_TOLD = {  # what a moment can be told, and the columns that tell it
    "speed": {"speed", *_GROUPS[3]}, "yaw rate": {"yaw_rate", *_GROUPS[3], *_GROUPS[4]}, "throttle": {"throttle"},
    "truth": {name for group in _GROUPS[:3] for name in group},
}  # fmt: skip
_ALONE = ("time", "image", "speed", "yaw_rate", "throttle")
LARGEST = 1e9  # of a measured value; more is no robot's
GRAVITY = 7.0, 13.0  # m/s²: so long is the mean of an accelerometer's readings where its up is known
_MEASURED = 20_000  # rows from which that mean is taken


@dataclass(frozen=True, slots=True)
class Column:
    at: int  # its number in a row, from 0
    name: str  # as the file has it
    factor: float  # of its unit


def _columns(names: tuple[str, ...], pictures: list[int]) -> dict[str, Column]:
    """Meaning -> column. pictures: numbers of the columns that hold names of pictures, whatever they are called."""
    found: dict[str, Column] = {}
    words = [re.sub(r"[^a-z0-9]+", "_", name.strip().lower()).strip("_") for name in names]
    for at, name in enumerate(names):
        for meaning, factor in _readings(words[at]):
            if meaning != "image" or not pictures or at == pictures[0]:
                found.setdefault(meaning, Column(at, plain(name.strip(), 40), factor))
            break
    if pictures and "image" not in found:
        found["image"] = Column(pictures[0], plain(names[pictures[0]].strip() or f"column {pictures[0] + 1}", 40), 1.0)
    if set(words) >= _DRIVEN and "speed" in found:
        found["speed"] = Column(found["speed"].at, found["speed"].name, UNITS["length"]["mph"])
    return found


def _readings(words: str) -> Iterator[tuple[str, float]]:
    """Meaning and factor of a column's name, with or without a unit at its end, or a message's name before it."""
    words = re.sub(r"^(field_)?(pose_|twist_)*(?=(position|orientation|linear|angular)_)|^field_", "", words)
    if words in _MEANING:
        yield _MEANING[words], 1.0
    for kind, units in UNITS.items():
        for unit, factor in sorted(units.items(), key=lambda item: -len(item[0])):
            meaning = _MEANING.get(words.removesuffix("_" + unit)) if words.endswith("_" + unit) else None
            if meaning is not None and _KIND.get(meaning) == kind:
                yield meaning, factor


def _needed(columns: dict[str, Column], name: str) -> dict[str, Column]:
    """Those that tell something, alone or together. A log of odometry has the robot's own poses, not the truth."""
    if "odom" in name.lower() and "odom_x" not in columns:
        for meaning in ("x", "y", "heading"):
            if meaning in columns and ("heading" in columns or "qz" in columns):
                columns[f"odom_{meaning}"] = columns.pop(meaning)
    whole = {meaning for group in _GROUPS if all(name in columns for name in group) for meaning in group}
    return {meaning: column for meaning, column in columns.items() if meaning in whole or meaning in _ALONE}


class Table:
    """The rows of a text file, read one by one."""

    def __init__(self, path: Path, name: str = "") -> None:
        """name: by which it is told of. ValueError: no column of it is known."""
        self.path, self.name = path, plain(name or path.name, 80)
        style = style_of(path)
        if style is None:
            raise ValueError(f"{self.name}: there is no row in it")
        self._style = style
        names = style.header or columns_without_header(style)
        pictures = [at for at in range(len(names)) if (some := list(samples(style, at))) and all(map(is_picture, some))]
        pictures.sort(key=lambda at: rank_of(f"{names[at]}/{next(samples(style, at))}"))
        self.columns = _needed(_columns(names, pictures), self.path.stem)
        if not self.columns:
            told = ", ".join(plain(each.strip(), 30) for each in style.header[:8]) or "it has no header"
            raise ValueError(f"{self.name}: none of its columns is known ({told})")
        used = {column.at for column in self.columns.values()}
        self.left = [
            plain(each.strip(), 30) or f"column {at + 1}" for at, each in enumerate(names) if at not in used and each
        ]
        self._time_factor: float | None = None
        self._up, self._forward_z = (0.0, 0.0, 1.0), False
        self.count, self.first_ns, self.last_ns = 0, 0, 0

    @property
    def tells(self) -> set[str]:
        """Of speed, yaw rate, throttle and truth, those that it has."""
        return {kind for kind, columns in _TOLD.items() if columns & set(self.columns)}

    def leave(self, kinds: set[str]) -> None:
        """Do not use what tells of these: another table does."""
        for kind in kinds:
            for meaning in _TOLD[kind] & set(self.columns):
                self.left.append(self.columns.pop(meaning).name)

    def survey(self) -> None:
        """Count its rows, and find out between which times they lie, which way is up for its gyro, and whether its poses
        are those of a camera, which looks along its z."""
        acc, tilts, times = [np.zeros(3)], list[float](), list[int]()
        quiet = Problems()
        for _, cells in self.rows(quiet):
            self.count += 1
            try:
                if (time_ns := self.time_ns(cells)) is not None:
                    times[1:] = [time_ns]
                if self.count <= _MEASURED:
                    if (read := self._all(cells, ("acc_x", "acc_y", "acc_z"))) is not None:
                        acc.append(np.array(read))
                    if (turn := self._all(cells, ("qx", "qy", "qz", "qw"))) is not None:
                        tilts.append(1 - 2 * (turn[0] ** 2 + turn[1] ** 2))
            except ValueError:
                continue
        if times:
            self.first_ns, self.last_ns = times[0], times[-1]
        mean = np.mean(acc[1:], axis=0) if len(acc) > 1 else acc[0]
        length = float(np.linalg.norm(mean))
        if GRAVITY[0] <= length <= GRAVITY[1]:
            x, y, z = (float(part) for part in mean / length)
            self._up = x, y, z
        elif "acc_x" in self.columns:
            for name in ("gyro_x", "gyro_y", "gyro_z", "acc_x", "acc_y", "acc_z"):
                self.left.append(self.columns.pop(name).name)
        self._forward_z = bool(tilts) and abs(sum(tilts) / len(tilts)) < 0.7

    def rows(self, problems: Problems) -> Iterator[tuple[int, list[str]]]:
        """Number of the line and cells. A line that cannot be cut into cells is a problem and left out."""
        with closing(lines_of(self.path)) as lines:
            for number, line in lines:
                if number < self._style.first or not line.strip() or line.lstrip()[0] in "#%":
                    continue
                problems.seen(self.source)
                try:
                    cells = self._style.cells(line)
                    if len(cells) > len(self._style.header) > 0:
                        raise ValueError(f"{len(cells)} cells, but the header has {len(self._style.header)}")
                    yield number, cells
                except (csv.Error, StopIteration, ValueError) as error:
                    problems.add("lines left out", self.where(number), f"left out: {error}")

    @property
    def source(self) -> str:
        """What its rows are counted under."""
        return f"lines of {self.name}"

    def where(self, number: int) -> str:
        return f"{self.name}: line {number}"

    def text(self, cells: list[str], meaning: str) -> str:
        """A cell; empty if there is none."""
        column = self.columns.get(meaning)
        return cells[column.at].strip() if column is not None and column.at < len(cells) else ""

    def value(self, cells: list[str], meaning: str) -> float | None:
        """A number in SI units; None for an empty cell. ValueError: it is none, or far too large."""
        text = self.text(cells, meaning)
        if not text:
            return None
        column = self.columns[meaning]
        number = _number(self._style.plain(text), text, column.name)
        if not abs(number * column.factor) <= LARGEST:
            raise ValueError(f"{column.name}: {text[:40]!r} is far too large; at most {LARGEST:g} in m, s and rad")
        return number * column.factor

    def time_ns(self, cells: list[str]) -> int | None:
        """The time of a row. Without a unit in its name, a large first time is taken as ms, us or ns since 1970."""
        text = self.text(cells, "time")
        if not text:
            return None
        if (date := ns_of_date(text)) is not None:
            return date
        column, number = self.columns["time"], self._style.plain(text)
        value = _number(number, text, column.name)
        if self._time_factor is None:
            self._time_factor = column.factor if column.factor != 1.0 else _guessed(value)
        return ns_of(number, round(self._time_factor * 1e9))

    def sensed(self, cells: list[str], time_ns: int, where: str, rates: Rates, image: Picture | None) -> Sensed:
        """What a row tells. ValueError: one of its values is wrong."""
        speed, yaw_rate = self.value(cells, "speed"), self.value(cells, "yaw_rate")
        if yaw_rate is None:
            yaw_rate = self._turning(cells)
        odometry = self._all(cells, ("odom_x", "odom_y", "odom_heading"))
        if (
            odometry is not None
            and (moved := rates.since(time_ns, (odometry[0], odometry[1], odometry[2]))) is not None
        ):
            speed, yaw_rate = moved[0] if speed is None else speed, moved[1] if yaw_rate is None else yaw_rate
        return Sensed(
            time_ns, where, image, speed=speed, yaw_rate=yaw_rate, throttle=self.value(cells, "throttle"),
            truth=self._truth(cells), source=self.source,
        )  # fmt: skip

    def _all(self, cells: list[str], meanings: tuple[str, ...]) -> tuple[float, ...] | None:
        """None: a column or a cell is missing."""
        if any(meaning not in self.columns for meaning in meanings):
            return None
        values = [self.value(cells, meaning) for meaning in meanings]
        return None if None in values else tuple(value for value in values if value is not None)

    def _turning(self, cells: list[str]) -> float | None:
        """About the vertical, of a gyro."""
        read = self._all(cells, ("gyro_x", "gyro_y", "gyro_z"))
        if read is None or "acc_x" not in self.columns:
            return self.value(cells, "gyro_z")
        return sum(rate * up for rate, up in zip(read, self._up, strict=True))

    def _truth(self, cells: list[str]) -> Pose | None:
        if (pose := self._all(cells, _POSES[0])) is not None:
            return pose[0], pose[1], pose[2]
        if (pose := self._all(cells, _POSES[1])) is not None:
            x, y, z, w = pose[2:]
            if not 0.5 < math.hypot(x, y, z, w) < 2:
                raise ValueError("its quaternion turns nothing")
            if self._forward_z:  # a camera looks along its z
                return pose[0], pose[1], math.atan2(2 * (y * z - w * x), 2 * (x * z + w * y))
            return pose[0], pose[1], math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        if (pose := self._all(cells, _POSES[2])) is not None:  # in the first camera's axes: right, down, forwards
            return pose[11], -pose[3], math.atan2(-pose[2], pose[10])
        return None

    @property
    def uses(self) -> tuple[str, ...]:
        """Sentences: which column is used for what."""
        words = {"x": "truth's x", "y": "truth's y", "heading": "truth's heading", "yaw_rate": "yaw rate"}
        lines = [
            f"{words.get(meaning, meaning.replace('_', ' '))}: column {column.name!r} of {self.name}"
            for meaning, column in self.columns.items()
            if meaning in _ALONE or meaning in words or meaning.startswith("odom")
        ]
        if "gyro_z" in self.columns and "yaw_rate" not in self.columns:
            about = (
                "the vertical that its accelerometer tells"
                if "acc_x" in self.columns
                else "its z, taken for the vertical"
            )
            lines.append(f"yaw rate: the gyro of {self.name} about {about}")
        if "qw" in self.columns and "heading" not in self.columns:
            axis = "z, as a camera looks" if self._forward_z else "x"
            lines.append(f"truth's heading: that of its {axis}, from the quaternions of {self.name}")
        if "pose_00" in self.columns:
            lines.append(f"truth: the poses of {self.name}, in the first camera's axes")
        return tuple(lines)


def _number(number: str, text: str, name: str) -> float:
    try:
        value = float(number) if len(number) < 100 else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{name}: {text[:40]!r} is not a finite number")
    return value


def _guessed(first: float) -> float:
    """The unit of times since 1970, from the first one; below 1e11 they are seconds."""
    return next((factor for above, factor in ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3)) if abs(first) >= above), 1.0)
