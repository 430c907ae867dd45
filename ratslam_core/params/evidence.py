"""The parameters of the law of evidence. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of evidence/3")
@dataclass(frozen=True, slots=True)
class EvidenceParams:
    """How much evidence a place needs before the robot believes it, and before its maps are merged."""

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
    unnoticed: float = param(
        11.0,
        unit="nats",
        low=0.0,
        high=100.0,
        meaning="log odds against having been carried unnoticed",
        source="ours",
    )
    gate_rad: float = param(
        3.2,
        unit="rad",
        low=0.05,
        high=3.2,
        meaning="a look that would turn the robot farther than this puts it in doubt; 3.2 = none does, however far it turns",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
