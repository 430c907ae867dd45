"""The parameters of the goal memory. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of goal memory/1")
@dataclass(frozen=True, slots=True)
class GoalMemoryParams:
    """Times between places, learnt on the pose cells (C III)."""

    time_weight: float = param(
        1.0, symbol="α", low=0.0, high=10.0, meaning="weight of the time between two iterations", source="C IV.C"
    )
    activity_weight: float = param(
        0.25, symbol="β", unit="s", low=0.0, high=10.0, meaning="added between weakly active cells", source="C IV.C"
    )
    distance_weight: float = param(
        0.1, symbol="γ", unit="s/cell", low=0.0, high=10.0, meaning="added for the distance of cells", source="C IV.C"
    )
    rate: float = param(
        0.2,
        low=0.01,
        high=1.0,
        meaning="what the newest time counts in a link's moving average",
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
        meaning="the packet moves so far before its cells are linked; 0 = linked in every iteration",
        source="ours",
    )
    over_jumps: bool = param(
        False,
        meaning="cells are linked over a jump of the packet, too; off = it has not driven there",
        source="C; off is ours",
    )
    arrived: float = param(
        1.0, unit="cells", low=0.1, high=10.0, meaning="so near the goal the robot is there", source="C III.B"
    )
    wider: int = param(
        3, low=1, high=10, meaning="times `reach` is looked for a way when there is none nearer", source="ours"
    )
    centre: int = param(
        3, unit="cells", low=1, high=10, meaning="around the strongest one that say where the packet is", source="ours"
    )
    reach: int = param(
        3,
        unit="cells",
        low=1,
        high=10,
        meaning="how far around the packet the way is looked for",
        source="C III.B; ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
