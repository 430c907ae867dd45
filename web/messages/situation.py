"""A situation, which a link or a file carries: the run up to a moment, and from where it is looked at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from disk.words import one_line
from web.messages.commands import Needs

Number = Annotated[float, Field(ge=-1e4, le=1e4, allow_inf_nan=False)]
Vector = tuple[Number, Number, Number]
Plate = Literal["all", "office", "pose", "map"]


class CameraAt(BaseModel):
    """A camera that was turned by hand, in the stage's frame, which is about 28 wide; the angle in radians."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    position: Vector
    look_at: Vector
    fov_rad: Annotated[float, Field(gt=0, lt=3.1, allow_inf_nan=False)]


class Look(BaseModel):
    """What a page shows: the plate, the open tab of the panel, and the camera unless it stands at its view."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    plate: Plate = "all"
    tab: Annotated[str, Field(max_length=20), AfterValidator(one_line)] | None = None
    camera: CameraAt | None = None


class Drawn(BaseModel):
    """The drawing of the stage that stands on a page where viser draws nothing."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    view: Plate
    aspect: Annotated[float, Field(gt=0, le=20, allow_inf_nan=False)]


class StageClick(BaseModel):
    """A click on the stage: where on what the page shows, from its middle to the right and upwards, in halves of its height."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    type: Literal["click", "hover"]  # hover: only points there
    at: tuple[Number, Number]
    shift: bool = False
    drawn: Drawn | None = None  # None: viser's picture


SituationState = Literal["playing", "same", "other", "stopped"]


@dataclass(frozen=True, slots=True)
class SituationView:
    """How far a situation that was opened has come, and whether it came out as its link says."""

    state: SituationState
    tick: int
    end_tick: int
    words: str  # what is to be said about it; empty while it plays
    state_hash: str  # the link's
    look: Look


@dataclass(frozen=True, slots=True)
class ReadSituation:
    """The answer's `result` is what leads to the moment that is shown, of the engine's own class."""

    needs: ClassVar[Needs] = "link"


@dataclass(frozen=True, slots=True, eq=False)
class OpenSituation:
    """Begin a run that plays a situation up to its moment. situation: of the engine's own class."""

    situation: object
