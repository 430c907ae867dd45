"""One frozen tree of all parameters; dotted names, TOML out and in."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterator
from dataclasses import Field, dataclass, fields, replace
from typing import Any

import tomlkit

from app.pilot import PilotParams
from ratslam_core import (
    ExperienceMapParams,
    GoalMemoryParams,
    LocalViewParams,
    OccupancyParams,
    PoseCellParams,
    RatSlamParams,
)
from ratslam_core.local_view import COLUMNS
from sim2d import OfficeParams, SimParams

Value = float | int | bool | str


@dataclass(frozen=True, slots=True)
class Config:
    """Everything that can be set."""

    pose_cells: PoseCellParams = PoseCellParams()
    local_view: LocalViewParams = LocalViewParams()
    experience_map: ExperienceMapParams = ExperienceMapParams()
    goal_memory: GoalMemoryParams = GoalMemoryParams()
    occupancy: OccupancyParams = OccupancyParams()
    robot: SimParams = SimParams()
    office: OfficeParams = OfficeParams()
    pilot: PilotParams = PilotParams()

    def __post_init__(self) -> None:
        if self.robot.image_width < COLUMNS:
            raise ValueError(f"image_width must be at least {COLUMNS}, a pixel for each column of a view")

    @property
    def warnings(self) -> tuple[str, ...]:
        """What can be set so and is likely not meant so."""
        told, true = self.local_view.field_of_view, self.robot.camera_fov_rad
        if abs(told - true) <= 1e-6:
            return ()
        return (
            f"local_view.field_of_view is {told:g} rad but robot.camera_fov_rad {true:g}: the brain takes turns for "
            f"{told / true:.2f} times what they are when it looks; set both alike",
        )

    @property
    def engine(self) -> RatSlamParams:
        return RatSlamParams(self.pose_cells, self.local_view, self.experience_map, self.goal_memory, self.occupancy)

    def with_engine(self, params: RatSlamParams) -> Config:
        """A copy whose engine has these parameters."""
        return replace(self, **{item.name: getattr(params, item.name) for item in fields(params)})

    def items(self) -> Iterator[tuple[str, Field[Any], Value]]:
        """Dotted name, declaration and value of every parameter."""
        for section in fields(self):
            params = getattr(self, section.name)
            for item in fields(params):
                if "meaning" in item.metadata:
                    yield f"{section.name}.{item.name}", item, getattr(params, item.name)

    def with_value(self, name: str, value: Value) -> Config:
        """A copy with one parameter changed; ValueError names an unknown one, or the range.

        The brain is told of another field of view: `local_view.field_of_view` follows `robot.camera_fov_rad`.
        """
        known = {dotted: old for dotted, _, old in self.items()}
        if name not in known:
            close = difflib.get_close_matches(name, known, n=3) or sorted(known)
            raise ValueError(f"unknown parameter {name!r}; expected one of: {', '.join(close)}")
        section, key = name.split(".")
        try:
            if isinstance(known[name], float) and type(value) is int:
                value = float(value)
            changed = replace(self, **{section: replace(getattr(self, section), **{key: value})})
        except OverflowError:
            raise ValueError(f"{name} must be within its range; the number given is far too large") from None
        except ValueError as error:
            raise ValueError(f"{section}.{error}") from None
        if name == "robot.camera_fov_rad":
            changed = changed.with_value("local_view.field_of_view", value)
        return changed


def to_toml(config: Config) -> str:
    """The whole tree with symbol, unit, range, meaning and source as comments."""
    document = tomlkit.document()
    document.add(tomlkit.comment("RatSLAM: every parameter. Take it back with --config FILE."))
    section, table = "", tomlkit.table()
    for name, item, value in config.items():
        group, key = name.split(".")
        if group != section:
            section, table = group, tomlkit.table()
            document.add(section, table)
        about = item.metadata
        unit = f" [{about['unit']}]" if about["unit"] else ""
        symbol = f"{about['symbol']}: " if about["symbol"] else ""
        limits = "" if about["low"] is None else f"; {about['low']:g} to {about['high']:g}"
        limits += f"; one of: {', '.join(about['choices'])}" if about["choices"] else ""
        restart = "" if about["live"] else "; takes effect at the next reset"
        table.add(tomlkit.comment(f"{symbol}{about['meaning']}{unit}{limits}; {about['source']}{restart}"))
        table.add(key, value)
    return tomlkit.dumps(document)


def to_markdown(config: Config) -> str:
    """A table of all parameters for the documentation."""
    lines = [
        "# Parameters",
        "",
        "Made by `ratslam config --table`. ↻: takes effect at the next reset. Sources: A = ACRA 2004, ",
    ]
    lines[-1] += "B = ACRA 2005, C = IROS 2005, D = ACRA 2006."
    section = ""
    for name, item, value in config.items():
        group, key = name.split(".")
        if group != section:
            section = group
            lines += ["", f"## {section}", "", "| name | symbol | default | range | unit | meaning | source |"]
            lines += ["|---|---|---|---|---|---|---|"]
        about = item.metadata
        limits = " or ".join(about["choices"]) if about["low"] is None else f"{about['low']:g} to {about['high']:g}"
        shown = f"{value:.6g}" if isinstance(value, float) else str(value).lower() if isinstance(value, bool) else value
        cells = (
            f"`{key}`{'' if about['live'] else ' ↻'}",
            about["symbol"],
            shown,
            limits,
            about["unit"],
            about["meaning"],
        )
        lines.append(f"| {' | '.join(str(cell) for cell in cells)} | {about['source']} |")
    return "\n".join(lines) + "\n"


def from_toml(text: str, base: Config | None = None) -> Config:
    """A config from TOML; what is left out keeps its default. ValueError lists the right keys when one is unknown."""
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"not valid TOML: {error}") from None
    config = base or Config()
    sections = [item.name for item in fields(config)]
    for section, table in sorted(
        tree.items(), key=lambda item: item[0] != "robot"
    ):  # what the brain is told of it stands
        if section not in sections or not isinstance(table, dict):
            raise ValueError(f"unknown section {section!r}; expected one of: {', '.join(sections)}")
        keys = [item.name for item in fields(getattr(config, section))]
        for key, value in table.items():
            if key not in keys:
                raise ValueError(f"unknown parameter '{section}.{key}'; expected one of: {', '.join(keys)}")
            config = config.with_value(f"{section}.{key}", value)
    return config


def parse_value(text: str) -> Value:
    """A value from the command line: a TOML literal, or a plain word as text."""
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    if not isinstance(value, (float, int, bool, str)):
        raise ValueError(f"{text!r} is not a number, true, false or a word")
    return value
