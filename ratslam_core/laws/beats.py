"""What is true of the beats between two ticks."""

# Laws read private attributes and do not trust annotations.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

from ratslam_core.beats import EARLY, Beats
from ratslam_core.laws.measures import FAR_M, number, true

ROUNDING = 1e-6


def beats(beats: Beats) -> None:
    """ValueError names the first law that does not hold."""
    true(isinstance(beats, Beats), f"the beats are a {type(beats).__name__}")
    true(isinstance(beats._begun, bool), "beats have begun or not")
    number("the part of a beat that is over", beats._over, -EARLY - ROUNDING, 1.0)
    number("the way since the last beat", beats._distance_m, -FAR_M, FAR_M)
    number("the turn since the last beat", beats._turn_rad, -FAR_M, FAR_M)
    number("the time since the last beat", beats._time_s, 0.0, FAR_M)
