"""The steps of a lesson: those of trials (app/trials/steps.py), and two that a trial has no use for."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from app.trials.steps import Metres, Seconds, Step, Where


class Packet(BaseModel):
    """A packet of activity is put into the pose cells by hand, so far from the winner (cells, layers). No sensor asks for it."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    do: Literal["packet"]
    away: tuple[int, int]  # cells along x' and y'
    layers: int = 0
    share: Annotated[float, Field(ge=0.01, le=0.95)] = 0.4  # of all activity afterwards


class Click(BaseModel):
    """Somebody clicks the map at what stands for this place, and the robot goes there, or gives up after so long."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    do: Literal["click"]
    place: Where
    timeout_s: Seconds = 120.0
    near_m: Metres = 1.0


LessonStep = Annotated[Step | Packet | Click, Field(discriminator="do")]
