"""The parameters of noticing a kidnap, and of being found again. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of kidnap/1")
@dataclass(frozen=True, slots=True)
class KidnapParams:
    """Image and sonars that jump though the wheels did not. The papers' robots did not know that they were carried away."""

    enabled: bool = param(
        True, meaning="notice a kidnap; off = a jump of the image is only another view", source="ours", live=False
    )
    least_image: float = param(
        0.5,
        low=0.0,
        high=1.0,
        meaning="share of its threshold that the image must change by, however much the sonars do",
        source="ours",
    )
    sonar_reach_m: float = param(
        3.0, unit="m", low=0.1, high=20.0, meaning="echoes from beyond come and go: they count as this", source="ours"
    )
    sonar_most_m: float = param(
        1.0, unit="m", low=0.01, high=20.0, meaning="a larger change of half of the sonars is no surer", source="ours"
    )
    sonar_still_m: float = param(
        0.17, unit="m", low=0.0, high=5.0, meaning="a smaller change of half of them speaks against it", source="ours"
    )
    found_again: int = param(
        8, unit="sights", low=1, high=1000, meaning="of known places that agree end being lost", source="ours"
    )
    settled: int = param(
        1200, unit="steps", low=1, high=10**6, meaning="without a contradiction end being lost, too", source="ours"
    )

    def __post_init__(self) -> None:
        check_ranges(self)
