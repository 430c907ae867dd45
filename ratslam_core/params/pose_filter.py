"""The parameters of where the robot is between two experiences. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of pose filter/2")
@dataclass(frozen=True, slots=True)
class PoseFilterParams:
    """How a look is weighed against odometry, and when a look that disagrees is believed."""

    enabled: bool = param(
        True,
        meaning="weigh a look against odometry; off = the latest look is the robot's place",
        source="ours",
        live=False,
    )
    snap_m: float = param(
        1.0, unit="m", low=0.05, high=100.0, meaning="a look farther off than this is believed at once", source="ours"
    )
    snap_rad: float = param(
        0.8,
        unit="rad",
        low=0.05,
        high=3.2,
        meaning="a look turned by more than this is believed at once",
        source="ours",
    )
    least_sigma_m: float = param(
        0.06,
        unit="m",
        low=1e-4,
        high=1.0,
        meaning="the error of the estimate is never taken as smaller, so that it can follow the map",
        source="ours",
    )
    gate_sigma: float = param(
        5.0,
        unit="σ",
        low=0.0,
        high=1000.0,
        meaning="a look may move the robot by this many times its uncertainty, and by `snap_m` in any case",
        source="ours",
    )
    gate_rad: float = param(
        3.2,
        unit="rad",
        low=0.05,
        high=3.2,
        meaning="a look that would turn the robot farther than this is held back, too; 3.2 = none is, however far it turns",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
