"""The parameters of the law of evidence. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of evidence/2")
@dataclass(frozen=True, slots=True)
class EvidenceParams:
    """How much evidence a place needs before the robot believes it, and before its maps are merged."""

    unit_m: float = param(
        1.0, unit="m", low=0.01, high=100.0, meaning="a way this long is one unit of evidence", source="ours"
    )
    unit_rad: float = param(1.0, unit="rad", low=0.01, high=100.0, meaning="and so is a turn this wide", source="ours")
    believe: float = param(
        0.7,
        unit="nats",
        low=-10.0,
        high=100.0,
        meaning="log odds above which the robot believes a hypothesis",
        source="ours",
    )
    merge: float = param(
        6.9, unit="nats", low=0.0, high=100.0, meaning="log odds above which submaps are merged", source="ours"
    )
    leak: float = param(
        0.2,
        low=0.0,
        high=1.0,
        meaning="share of the evidence for a hypothesis that a unit of way takes away",
        source="ours",
    )
    least_units: float = param(
        1.5,
        unit="units",
        low=0.0,
        high=100.0,
        meaning="of evidence that a hypothesis needs to be believed",
        source="ours",
    )

    unnoticed: float = param(
        11.0,
        unit="nats",
        low=0.0,
        high=100.0,
        meaning="log odds against having been carried unnoticed",
        source="ours",
    )
    most: float = param(
        14.0,
        unit="nats",
        low=0.0,
        high=100.0,
        meaning="what looks can say at most for a place, since an exact copy of it may exist",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
