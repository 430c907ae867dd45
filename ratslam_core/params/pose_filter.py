"""The parameters of where the robot is between two experiences. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of pose filter/1")
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
    gate: bool = param(
        True,
        meaning="hold back a look that would move the robot farther than it can be off; off = every look is believed at once",
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
    gate_sights: int = param(
        900,
        unit="sights",
        low=1,
        high=100_000,
        meaning="sights held back, one a beat, that must agree on where the robot is before it believes them",
        source="ours",
    )
    gate_drift: float = param(
        0.1,
        unit="m/m",
        low=0.0,
        high=10.0,
        meaning="so far may odometry lead astray where no loop has closed; within it `join_sights` are enough, 0 = never",
        source="ours",
    )
    gate_surprise: int = param(
        18,
        unit="sights",
        low=1,
        high=1000,
        meaning="such a sight counts as this many where the place that the robot believes in is known and looks different",
        source="ours",
    )
    gate_unlike: float = param(
        1.5,
        low=1.0,
        high=100.0,
        meaning="it looks different when no view near there is as like as this many times the threshold",
        source="ours",
    )
    agrees_m: float = param(
        0.5,
        unit="m",
        low=0.01,
        high=10.0,
        meaning="largest distance between sights that confirm each other",
        source="ours",
    )
    agrees_rad: float = param(
        0.4,
        unit="rad",
        low=0.01,
        high=3.2,
        meaning="largest difference in heading between sights that confirm each other",
        source="ours",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
