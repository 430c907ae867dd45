"""The parameters of noticing a kidnap and of relocalising after it. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of kidnap/5")
@dataclass(frozen=True, slots=True)
class KidnapParams:
    """When a jump of image and sonars counts as a kidnap. The papers' robots did not notice that they were carried."""

    enabled: bool = param(
        True, meaning="notice a kidnap; off = a jump of the image is only another view", source="ours", live=False
    )
    range_surprise: float = param(
        2.0,
        low=0.0,
        high=10.0,
        meaning="how much a change of the sonars adds to the image's change; above 1 is a kidnap",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
