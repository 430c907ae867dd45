"""All parameters in one frozen tree, addressed by dotted names such as `pose_cells.inhibit`."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import Field, dataclass, fields, replace
from typing import Any

from app.pilot import PilotParams
from disk import kind
from ratslam_core.local_view.matcher import COLUMNS
from ratslam_core.params import (
    ExperienceMapParams,
    GoalMemoryParams,
    KidnapParams,
    LocalViewParams,
    OccupancyParams,
    PoseCellParams,
    PoseFilterParams,
    RatSlamParams,
    SolverParams,
)
from sim2d import OfficeParams, SimParams

Value = float | int | bool | str


@kind("config/1")
@dataclass(frozen=True, slots=True)
class Config:
    """Everything that can be set."""

    pose_cells: PoseCellParams = PoseCellParams()
    local_view: LocalViewParams = LocalViewParams()
    experience_map: ExperienceMapParams = ExperienceMapParams()
    goal_memory: GoalMemoryParams = GoalMemoryParams()
    occupancy: OccupancyParams = OccupancyParams()
    kidnap: KidnapParams = KidnapParams()
    pose_filter: PoseFilterParams = PoseFilterParams()
    solver: SolverParams = SolverParams()
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
        """A copy with one parameter changed. ValueError names an unknown parameter, or the range of a known one.

        Setting `robot.camera_fov_rad` also sets `local_view.field_of_view`, so that the brain knows its camera.
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
