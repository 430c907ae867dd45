"""The commands that change the office: doors, lamps, boxes, the robot's sensors in it, and edits of the world itself."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from web.messages.command import CommandModel, Finite, Name

_Size = Annotated[float, Field(ge=0.05, le=20.0)]


class SetDoor(CommandModel):
    """Open or shut a door of the office. It moves from the next tick on, and waits for anyone who stands in it."""

    type: Literal["set_door"]
    name: Name
    open: bool


class SetLamp(CommandModel):
    type: Literal["set_lamp"]
    name: Name
    on: bool


class PutBox(CommandModel):
    """Put a box down (office frame, metres). Refused where it would cover the robot. A reset removes it."""

    type: Literal["put_box"]
    name: Name
    x: Finite
    y: Finite
    width: _Size = 0.5
    depth: _Size = 0.5
    height: _Size = 0.6
    angle_rad: Finite = 0.0


class RemoveBox(CommandModel):
    type: Literal["remove_box"]
    name: Name


class UsePreset(CommandModel):
    """Set the robot's sensors and encoders to a preset: "Pioneer 2DXE 2004" or "ideal"."""

    type: Literal["use_preset"]
    name: Name


OfficeList = Literal[
    "walls", "starts", "places", "doors", "lamps", "boxes", "people", "slow_zones", "script", "daylight"
]  # fmt: skip


class EditStep(CommandModel):
    """One item in one list of the world file: added at the end, changed, or deleted. `item` is written as in that file.

    `daylight` counts as a list of at most one item.
    """

    do: Literal["add", "change", "delete"]
    list: OfficeList
    number: Annotated[int, Field(ge=0, le=100_000)] | None = None  # of the item to change or delete, from 0
    item: dict[str, Any] | None = None  # the new item; a wall without a colour gets looks of its own


class EditWorld(CommandModel):
    """Change the office under the running robot: all steps or none. Refused when the world would not be valid, when the
    robot would be covered, or when the office is no longer the edition that the editor saw. Undone as one."""

    type: Literal["edit_world"]
    steps: Annotated[list[EditStep], Field(min_length=1, max_length=200)]
    edition: int | None = None


class UndoEdit(CommandModel):
    """Undo the last change of the office."""

    type: Literal["undo_edit"]


class RedoEdit(CommandModel):
    """Redo the change that was undone last."""

    type: Literal["redo_edit"]


OfficeOrder = SetDoor | SetLamp | PutBox | RemoveBox | UsePreset
EditOrder = EditWorld | UndoEdit | RedoEdit
