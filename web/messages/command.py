"""What all commands are: pydantic models, strict and closed; and what many of them hold."""

from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from disk.words import one_line

Finite = Annotated[float, Field(allow_inf_nan=False)]
Name = Annotated[str, Field(min_length=1, max_length=40), AfterValidator(one_line)]
Label = Annotated[str, Field(max_length=64), AfterValidator(one_line)]

EngineName = Literal["paper", "paper-2005", "paper-2006", "ours"]  # whose rules; "paper": those of an experiment's own


class CommandModel(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)
