"""The parameters of noticing a kidnap and of relocalising after it. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of kidnap/4")
@dataclass(frozen=True, slots=True)
class KidnapParams:
    """When a jump of image and sonars counts as a kidnap. The papers' robots did not notice that they were carried."""

    enabled: bool = param(
        True, meaning="notice a kidnap; off = a jump of the image is only another view", source="ours", live=False
    )
    time_power: float = param(
        0.3,
        low=0.0,
        high=1.0,
        meaning="if more than a beat lies between two images, driving explains more by this power of the time",
        source="ours",
    )
    sonar_near_m: float = param(
        0.2, unit="m", low=0.01, high=1.0, meaning="shorter ranges count as this", source="ours"
    )
    sonar_reach_m: float = param(
        4.0,
        unit="m",
        low=1.1,
        high=20.0,
        meaning="longer ranges count as this, since distant echoes come and go",
        source="ours",
    )
    sonar_most: float = param(
        0.35,
        unit="ln",
        low=0.01,
        high=3.0,
        meaning="a larger change of one sonar, as the logarithm of the ratio of its ranges, counts as this",
        source="ours",
    )
    settled: int = param(
        1200,
        unit="beats",
        low=1,
        high=10**6,
        meaning="tenths of a second without a contradiction after which the robot is no longer lost, either",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
