"""The first line of a run's file: what the run began from, and which program on which machine made it."""

from __future__ import annotations

import json
import platform
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import ConfigDict, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from app.config import Config, Value
from app.session import Session
from app.trials.code_version import code_version

FORMAT = "ratslam run/1"


@dataclass(frozen=True, slots=True)
class Beginning:
    """What a run began from. brain: whether it began with a brain, which lies beside the file; trial: of an experiment."""

    world: str  # the text of its file
    world_name: str
    seed: int
    config: Config
    brain: bool = False
    trial: str = ""


def beginning_of(session: Session, *, brain: bool = False, trial: str = "") -> Beginning:
    """The beginning of a session that has not run yet."""
    return Beginning(session.world_text, session.world.name, session.seed, session.config, brain, trial)


@checked(frozen=True, slots=True, config=ConfigDict(extra="forbid", strict=True))
class Header:
    """As in the file. values: all parameters, by dotted name."""

    format: str
    version: str  # code_version.py
    python: str
    numpy: str
    platform: str
    made_at: float  # seconds since 1970
    world_name: str
    world: str
    seed: int
    values: dict[str, Value]
    brain: bool
    trial: str

    @property
    def config(self) -> Config:
        """ValueError: this version of the program has other parameters."""
        return Config().with_values(self.values)

    @property
    def same_program(self) -> bool:
        """Whether it was made by a program that decides as this one does."""
        return self.version == code_version()


_HEADER = TypeAdapter(Header)


def header_of(beginning: Beginning) -> Header:
    return Header(
        FORMAT, code_version(), platform.python_version(), np.__version__, f"{platform.system()} {platform.machine()}",
        time.time(), beginning.world_name, beginning.world, beginning.seed,
        {name: value for name, _, value in beginning.config.items()},
        beginning.brain, beginning.trial,
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
            f"its header is wrong at {'.'.join(map(str, first['loc'])) or 'run'}: {first['msg']}"
        ) from None
    if header.format != FORMAT:
        raise ValueError(f"its format is {header.format!r}; this program reads {FORMAT!r}")
    return header
