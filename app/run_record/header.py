"""The first line of a run's file: what the run began from, and which program on which machine made it."""

from __future__ import annotations

import json
import platform
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from app.code_version import code_version
from app.config import Config, Value
from disk.state_reading import words_of
from disk.words import one_line, plain

if TYPE_CHECKING:
    from app.recordings.playing import Player
    from app.session import Session
    from ratslam_core import RatSlam


FORMAT = "ratslam run/1"
_Words = Annotated[str, Field(max_length=200), AfterValidator(one_line)]
_Moment = Annotated[float, Field(ge=0, le=1e11)]  # up to the year 5138
_RATE = "robot.sensor_rate_hz"


@dataclass(frozen=True, slots=True)
class Beginning:
    """What a run began from. brain: a copy of the one that it began with, or its file; None: a new one. trial: of an
    experiment."""

    world: str  # the text of its file
    world_name: str
    seed: int
    config: Config
    brain: RatSlam | Path | None = None
    trial: str = ""
    recording: Path | None = None  # that is played; there is no world then
    dt: float | None = None  # s between two of its moments, in the mean


def beginning_of(session: Session, *, brain: RatSlam | Path | None = None, trial: str = "") -> Beginning:
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
        beginning.brain is not None, beginning.trial, recording,
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
