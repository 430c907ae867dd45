"""What is asked of the run of a lesson: a measure, of one of its rounds, or the difference of two."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict

from app.lessons.units import MEASURED, shown

_IN_BRACES = re.compile(r"\{([^{}]*)\}")

Values = Mapping[str, float]  # what was measured in a round, by name


def _known(reference: str) -> str:
    name = reference.split(" of ", 1)[0]
    if name not in MEASURED:
        raise ValueError(f"nothing is measured by the name {name!r}; expected one of: {', '.join(sorted(MEASURED))}")
    return reference


Reference = Annotated[str, AfterValidator(_known)]  # "NAME", of the last round, or "NAME of LABEL"


class Finding(BaseModel):
    """A measure; with `minus`, less another; with `over`, so many times as large as another."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    measure: Reference
    minus: Reference | None = None
    over: Reference | None = None

    @property
    def text(self) -> str:
        minus = "" if self.minus is None else f" - {self.minus}"
        return self.measure + minus + ("" if self.over is None else f" / {self.over}")

    @property
    def labelled(self) -> list[tuple[str, str]]:
        """Measure and label of each part that names a round, or one of two brains."""
        parts = (self.measure, self.minus, self.over)
        split = [part.partition(" of ") for part in parts if part is not None and " of " in part]
        return [(name, label) for name, _, label in split]

    def of(self, rounds: Sequence[tuple[str, Values]]) -> float:
        """Its value. rounds: label and values of each, or of each of two brains; what names none is of the last."""
        value = _value(self.measure, rounds)
        if self.minus is not None:
            less = _value(self.minus, rounds)
            value = 0.0 if value == less else value - less  # what neither reached is no difference
        return value if self.over is None else value / max(_value(self.over, rounds), 1e-9)

    @classmethod
    def all_in(cls, text: str) -> list[Finding]:
        """Those in braces."""
        return [cls(measure=reference) for reference in _IN_BRACES.findall(text)]


def told(text: str, rounds: Sequence[tuple[str, Values]]) -> str:
    """The text with what was found in the place of each {NAME} or {NAME of LABEL}."""

    def found(match: re.Match[str]) -> str:
        reference = match.group(1)
        return shown(reference.split(" of ", 1)[0], _value(reference, rounds))

    return _IN_BRACES.sub(found, text)


def _value(reference: str, rounds: Sequence[tuple[str, Values]]) -> float:
    name, _, label = reference.partition(" of ")
    values = next((values for known, values in rounds if known == label), None) if label else rounds[-1][1]
    if values is None:
        raise ValueError(f"{reference!r}: there is no round {label!r}")
    return values[name]
