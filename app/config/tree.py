"""All parameters in one frozen tree, addressed by dotted names such as `pose_cells.inhibit`."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import Field, dataclass, fields, replace
from typing import Any

from app.pilot.params import PilotParams
from disk import kind
from ratslam_core.params import (
    COLUMNS,
    EvidenceParams,
    ExperienceMapParams,
    GoalMemoryParams,
    KidnapParams,
    LocalViewParams,
    OccupancyParams,
    PoseCellParams,
    RatSlamParams,
)
from sim2d import OfficeParams, SimParams

Value = float | int | bool | str
MOST_NAMED, MOST_SAID = 12, 80  # names in a sentence, and characters of one that somebody gave


@kind("config/2")
@dataclass(frozen=True, slots=True)
class Config:
    """Everything that can be set."""

    pose_cells: PoseCellParams = PoseCellParams()
    local_view: LocalViewParams = LocalViewParams()
    experience_map: ExperienceMapParams = ExperienceMapParams()
    goal_memory: GoalMemoryParams = GoalMemoryParams()
    occupancy: OccupancyParams = OccupancyParams()
    kidnap: KidnapParams = KidnapParams()
    evidence: EvidenceParams = EvidenceParams()
    robot: SimParams = SimParams()
    office: OfficeParams = OfficeParams()
    pilot: PilotParams = PilotParams()

    def __post_init__(self) -> None:
        if self.robot.image_width < COLUMNS:
            raise ValueError(f"image_width must be at least {COLUMNS}, a pixel for each column of a view")

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about settings that are allowed but probably not intended."""
        told, true = self.local_view.field_of_view, self.robot.camera_fov_rad
        if abs(told - true) <= 1e-6:
            return ()
        return (
            f"local_view.field_of_view is {told:g} rad but robot.camera_fov_rad is {true:g} rad: the brain reads a "
            f"turn from the image as {told / true:.2f} times what it is; set both to the same value",
        )

    @property
    def engine(self) -> RatSlamParams:
        return RatSlamParams(**{item.name: getattr(self, item.name) for item in fields(RatSlamParams)})

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
        """A copy with one parameter changed; the rest as in `with_values`."""
        return self.with_values({name: value})

    def with_values(self, values: Mapping[str, Value]) -> Config:
        """A copy with these parameters changed, all at once, so that two that limit each other need no order.

        Setting `robot.camera_fov_rad` also sets `local_view.field_of_view`, unless that is given, too, so that the
        brain knows its camera. ValueError names an unknown parameter, or the range of a known one.
        """
        known = {dotted: old for dotted, _, old in self.items()}
        changes: dict[str, dict[str, Value]] = {"robot": {}}  # first: it is to be named if the field of view is wrong
        for name, value in values.items():
            if name not in known:
                raise ValueError(f"unknown parameter {name[:MOST_SAID]!r}; {_what_would_be_right(name, known)}")
            section, key = name.split(".")
            changes.setdefault(section, {})[key] = _fitting(name, known[name], value)
        if "camera_fov_rad" in changes["robot"]:
            changes.setdefault("local_view", {}).setdefault("field_of_view", changes["robot"]["camera_fov_rad"])
        changed = self
        for section, change in changes.items():
            try:
                changed = replace(changed, **{section: replace(getattr(changed, section), **change)})
            except ValueError as error:
                raise ValueError(f"{section}.{error}") from None
        return changed


def _what_would_be_right(name: str, known: Iterable[str]) -> str:
    """The names that are like this one; else those of the section, or of that name in any section."""
    within = [each for each in known if {*name.split(".")} & {*each.split(".")}]
    like = difflib.get_close_matches(name[:MOST_SAID], known, n=3) or within
    if not like:
        return "it has a section and a name, as pose_cells.inhibit; `ratslam config` prints all of them"
    return f"expected one of: {', '.join(like[:MOST_NAMED])}" + ", ..." * (len(like) > MOST_NAMED)


def _fitting(name: str, old: Value, value: Value) -> Value:
    """A whole number as a float if the parameter is one. ValueError if it is larger than any float."""
    if type(value) is not int:
        return value
    try:
        number = float(value)
    except OverflowError:
        raise ValueError(f"{name} must be within its range; the number given is far too large") from None
    return number if isinstance(old, float) else value
