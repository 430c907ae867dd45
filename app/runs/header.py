"""The parts of a run's file: its first line, what it began from and which program on which machine made it; the pulse, four
bytes that tell one tick from another (where the robot is, what it sees, where it believes to be); an edited world as what
differs from the text before, so that an hour of editing stays small."""

from __future__ import annotations

import json
import platform
import struct
import time
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from app.code_version import code_version
from app.config import Config, Value
from disk.limits import EDITED_BYTES, ORDERS
from disk.state_reading import words_of
from disk.words import one_line, plain

if TYPE_CHECKING:
    from app.recordings.playing import Player
    from app.session import Session


SIZE = 4
_NUMBERS = struct.Struct("<12d")


def pulse_of(session: Session) -> bytes:
    """The pulse of the tick that the session has just run. It costs some microseconds; a `state_hash` ten thousand times that.

    Of the picture it holds how much it differs from the most similar view: a sum over the picture alone would cost more
    than all the rest.
    """
    truth, frame, estimate = session.truth, session.frame, session.estimate
    x, y, heading_rad = (truth.x, truth.y, truth.heading_rad) if truth else (0.0, 0.0, 0.0)  # a recording may have none
    pose, packet, seen = estimate.pose_map_robot, estimate.packet, estimate.recognition
    numbers = _NUMBERS.pack(
        x, y, heading_rad, frame.odometry_speed, frame.odometry_yaw_rate, pose.x, pose.y,
        pose.heading_rad, packet.mass, estimate.experience, seen.view, seen.difference,
    )  # fmt: skip
    return zlib.crc32(numbers).to_bytes(SIZE, "little")


def edit_of(before: str, after: str) -> dict[str, Any]:
    """The lines `from` to `to` of `before` become the lines `put`; `check` is the checksum of `after`."""
    old, new = before.splitlines(keepends=True), after.splitlines(keepends=True)
    most = min(len(old), len(new))
    first = next((k for k in range(most) if old[k] != new[k]), most)
    last = next((k for k in range(most - first) if old[-1 - k] != new[-1 - k]), most - first)
    return {"from": first, "to": len(old) - last, "put": "".join(new[first : len(new) - last]), "check": _check(after)}


def edited(before: str, edit: dict[str, Any]) -> str:
    """The text after an edit. ValueError: the edit does not belong to this text."""
    lines = before.splitlines(keepends=True)
    try:
        first, last, put = edit["from"], edit["to"], edit["put"]
        if not 0 <= first <= last <= len(lines):
            raise ValueError(f"it changes lines {first} to {last} of {len(lines)}")
        after = "".join([*lines[:first], put, *lines[last:]])
        if edit["check"] != _check(after):
            raise ValueError("the text after it is another than the one that was written")
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"an edit of the world cannot be made again: {error}") from None
    return after


def require_room(orders: int, edited_bytes: int) -> None:
    """ValueError: no run has so many orders, or so many edits of so large a world. Who writes one and who reads it ask here."""
    if orders > ORDERS:
        raise ValueError(f"a run has at most {ORDERS:,} orders")
    if edited_bytes > EDITED_BYTES:
        raise ValueError(f"the worlds of a run, one for each edit, have at most {EDITED_BYTES >> 20} MiB together")


def _check(text: str) -> int:
    return zlib.crc32(text.encode())


FORMAT = "ratslam run/1"
_Words = Annotated[str, Field(max_length=200), AfterValidator(one_line)]
_Moment = Annotated[float, Field(ge=0, le=1e11)]  # up to the year 5138
_RATE = "robot.sensor_rate_hz"


@dataclass(frozen=True, slots=True)
class Beginning:
    """What a run began from. brain: whether it began with a brain, which lies beside the file; trial: of an experiment."""

    world: str  # the text of its file
    world_name: str
    seed: int
    config: Config
    brain: bool = False
    trial: str = ""
    recording: Path | None = None  # that is played; there is no world then
    dt: float | None = None  # s between two of its moments, in the mean


def beginning_of(session: Session, *, brain: bool = False, trial: str = "") -> Beginning:
    """The beginning of a session that has not run yet."""
    return Beginning(session.source.world_texts[0], session.world.name, session.seed, session.config, brain, trial)


def recorded_beginning(session: Session, player: Player) -> Beginning | None:
    """The same where a recording plays; None: it could not be opened again."""
    about, path = player.recording.about, player.path
    dt = about.seconds / max(about.moments - 1, 1)
    name = plain(about.name, 100)
    return path and Beginning("", name, session.seed, session.config, recording=path.absolute(), dt=min(dt, 1e6))


@checked(frozen=True, slots=True, config=ConfigDict(extra="forbid", strict=True))
class KeptRecording:
    """path: where it lay; digest: its fingerprint; dt: s between two of its moments, in the mean."""

    path: Annotated[str, Field(max_length=4096)]
    digest: Annotated[str, Field(max_length=64), AfterValidator(one_line)]
    dt: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]


@checked(frozen=True, slots=True, config=ConfigDict(extra="forbid", strict=True))
class Header:
    """As in the file. values: all parameters, by dotted name."""

    format: _Words
    version: _Words  # code_version.py
    python: _Words
    numpy: _Words
    platform: _Words
    made_at: _Moment  # seconds since 1970
    world_name: _Words
    world: str
    seed: Annotated[int, Field(ge=0)]
    values: dict[str, Value]
    brain: bool
    trial: _Words
    recording: KeptRecording | None = None

    @property
    def config(self) -> Config:
        """ValueError: this version of the program has other parameters."""
        try:
            return Config().with_values(self.values)
        except ValueError as error:
            raise ValueError(words_of(error)) from None

    @property
    def same_program(self) -> bool:
        """Whether it was made by a program that decides as this one does."""
        return self.version == code_version()


_HEADER = TypeAdapter(Header)


def header_of(beginning: Beginning) -> Header:
    """OSError: its recording cannot be read."""
    from app.recordings.opening import fingerprint

    path = beginning.recording
    recording = path and KeptRecording(str(path), fingerprint(path), beginning.dt or 0.0)
    return Header(
        FORMAT, code_version(), platform.python_version(), np.__version__, f"{platform.system()} {platform.machine()}",
        time.time(), beginning.world_name, beginning.world, beginning.seed,
        {name: value for name, _, value in beginning.config.items()},
        beginning.brain, beginning.trial, recording,
    )  # fmt: skip


def written(header: Header) -> dict[str, Any]:
    return {"run": _HEADER.dump_python(header)}


def read_header(line: dict[str, Any]) -> Header:
    """ValueError says what is wrong with the line."""
    try:
        header = _HEADER.validate_json(json.dumps(line.get("run")))  # strict, but from a dictionary
    except ValidationError as error:
        first = error.errors()[0]
        raise ValueError(
            f"its header is wrong at {'.'.join(map(str, first['loc']))[:80] or 'run'}: {first['msg']}"
        ) from None
    if header.format != FORMAT:
        raise ValueError(f"its format is {header.format!r}; this program reads {FORMAT!r}")
    rate = header.values.get(_RATE, 10.0)
    if isinstance(rate, str) or not 0 < rate <= 1e4:
        raise ValueError(f"{_RATE} must be above 0 and at most 10000, got {str(rate)[:40]!r}")
    return header
