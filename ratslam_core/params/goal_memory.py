"""The parameters of the goal memory. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of goal memory/3")
@dataclass(frozen=True, slots=True)
class GoalMemoryParams:
    """Times between places, learnt on the pose cells (C III)."""

    enabled: bool = param(True, meaning="learn times between pose cells; off = no goal memory", source="C III")
    time_weight: float = param(
        1.0, symbol="α", low=0.0, high=10.0, meaning="weight of the time between two iterations", source="C IV.C"
    )
    activity_weight: float = param(
        0.25,
        symbol="β",
        unit="s",
        low=0.0,
        high=10.0,
        meaning="time added between weakly active cells",
        source="C IV.C",
    )
    distance_weight: float = param(
        0.1,
        symbol="γ",
        unit="s/cell",
        low=0.0,
        high=10.0,
        meaning="time added for the distance between cells",
        source="C IV.C",
    )
    rate: float = param(
        0.2,
        low=0.01,
        high=1.0,
        meaning="weight of the newest time in a link's moving average",
        source="C III.A; ours",
    )
    share: float = param(
        0.5, low=0.0, high=0.95, meaning="cells below this share of the strongest are not linked", source="ours"
    )
    stride_m: float = param(
        0.5,
        unit="m",
        low=0.0,
        high=5.0,
        meaning="distance the packet moves before its cells are linked; 0 = linked in every iteration",
        source="ours",
    )
    over_jumps: bool = param(
        False,
        meaning="cells are linked across a jump of the packet, too; off = not, since the robot did not drive there",
        source="C; off is ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
