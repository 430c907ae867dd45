"""What all commands are: pydantic models, strict and closed."""

from pydantic import BaseModel, ConfigDict


class CommandModel(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)
