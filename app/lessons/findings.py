"""What can be measured in the run of a lesson, by name (performance.py measures it), and what is asked of it: a measure, of
one of its rounds, or the difference of two."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict


@dataclass(frozen=True, slots=True)
class Measured:
    """words: what it is; told: a number of it, as in str.format; never: said when it did not happen (infinite)."""

    words: str
    told: str = "{:.0f}"
    never: str = "never"


MEASURED: dict[str, Measured] = {
    "seconds": Measured("how long what is shown took, simulated", "{:.0f} s"),
    "met_s": Measured("time until what is waited for happened, simulated", "{:.1f} s"),
    "path_m": Measured("how far the robot drove in it", "{:.1f} m"),
    "error_m": Measured("map error at the end, after alignment", "{:.2f} m"),
    "error_before_m": Measured("map error before it", "{:.2f} m"),
    "error_open_m": Measured(
        "map error shortly before the last closed loop; without one, before what is shown", "{:.2f} m"
    ),
    "odometry_m": Measured("error of odometry alone at the end", "{:.2f} m"),
    "off_m": Measured("how far the robot is from where it believes itself to be, at the end", "{:.2f} m"),
    "off_most_m": Measured("the same, at worst", "{:.2f} m"),
    "astray_m": Measured(
        "how far the robot is from where its map, laid over the office as before it, says", "{:.1f} m"
    ),
    "cells_moved": Measured("how far the winning packet moved, in cells", "{:.1f} cells"),
    "layers_turned": Measured("how many layers the winning packet moved, counter-clockwise", "{:+.0f} layers"),
    "packets_most": Measured("packets with a tenth of the activity, at most"),
    "packets_end": Measured("packets with a tenth of the activity, at the end"),
    "rival_s": Measured("for how long a second packet held a fifth", "{:.1f} s"),
    "snaps": Measured("snaps of the winning packet"),
    "closures": Measured("closed loops"),
    "false_looks": Measured("looks that were made false"),
    "bent_m": Measured(
        "how far experiences moved in the map, in the mean, from before the last closed loop", "{:.2f} m"
    ),
    "found_s": Measured("time from the last kidnap until the robot knew where it was", "{:.1f} s"),
    "found_m": Measured("way driven until then", "{:.1f} m"),
    "reached": Measured("goals that were reached"),
    "goals": Measured("goals that were given"),
    "goal_s": Measured("time to the last goal", "{:.0f} s"),
    "goal_m": Measured("way to the last goal", "{:.1f} m"),
    "detour": Measured("that way over the straight line", "{:.1f}"),
    "lower_way": Measured("share of that way in the lower half of the world", "{:.0%}"),
    "views": Measured("views known at the end"),
    "views_before": Measured("views known before it"),
    "views_new": Measured("views recruited in it"),
    "experiences": Measured("experiences at the end"),
    "experiences_new": Measured("experiences made in it"),
    "experiences_here": Measured("experiences that were made within half a metre of where the robot ends"),
    "multiple": Measured("places with several representations in the pose cells"),
    "collisions": Measured("states of the pose cells that stand for several places"),
    "residual_m": Measured("by how much map and links disagree at the end", "{:.3f} m"),
    "turn_kept": Measured("share of the robot's turns that the packet's path keeps", "{:.0%}"),
    "links_dropped": Measured("links deleted in it"),
}


def shown(name: str, value: float) -> str:
    """A value in words."""
    about = MEASURED[name]
    if math.isnan(value):
        return "unknown"
    return about.told.format(value) if math.isfinite(value) else about.never


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
