"""What a laser adds to the wheels, each with a switch: off is the plain twin. [ours]"""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind


@kind("scan rules/1")
@dataclass(frozen=True, slots=True)
class ScanRules:
    """Compared by `python -m benchmarks.recordings --without NAME variants`."""

    local_map: bool = True  # a scan is laid over several before it; off: over the one before
    confirmed: bool = True  # a look counts where the scans agree; off: every look counts, as the gate lets it
    mutual: bool = (
        True  # each scan laid over the other must say the same, and nowhere near may fit as well; off: one of them
    )
    weighed: bool = True  # a match weighs less where walls tell little of a direction; off: all weigh the same
    neighbours: bool = True  # a match far from where the robot believes to be needs a second one; off: one is enough
