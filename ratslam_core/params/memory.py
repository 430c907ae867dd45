"""The parameters that keep the memory bounded. Sources are named in params/__init__.py."""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of memory/1")
@dataclass(frozen=True, slots=True)
class MemoryParams:
    """When a place is known well enough, so that nothing more is learnt of it."""

    familiar: bool = param(
        True,
        meaning="ground that is recognised often gets no more views and experiences; off = every new sight is kept",
        source="ours",
        live=False,
    )
    enough: float = param(
        0.5,
        low=0.0,
        high=1.0,
        meaning="a place is familiar when the shares of recognised sights of the experiences there add up to this",
        source="ours",
    )
    sights: int = param(20, low=1, high=10_000, meaning="over how many sights that share is averaged", source="ours")
    near_m: float = param(
        0.4, unit="m", low=0.01, high=10.0, meaning="experiences this near are of the same place", source="ours"
    )
    near_rad: float = param(
        math.radians(17),
        unit="rad",
        low=0.01,
        high=3.2,
        meaning="if their headings differ by no more than this",
        source="ours",
    )
    sure_m: float = param(
        0.3,
        unit="m",
        low=0.0,
        high=10.0,
        meaning="only a robot whose place is known to this precision calls it familiar",
        source="ours",
    )
    views: int = param(
        5,
        low=1,
        high=256,
        meaning="a place of so many views gets another only in the room of that which was longest not recognised",
        source="ours",
    )
    links: int = param(
        4,
        low=1,
        high=10_000,
        meaning="two experiences that both have this many links get none between them",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
