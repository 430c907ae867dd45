"""The parameters of the exact correction of the map. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param


@kind("parameters of solver/2")
@dataclass(frozen=True, slots=True)
class SolverParams:
    """The fixed point of the sweeps, computed directly. When, and what it learns, is set by `experience_map`."""

    enabled: bool = param(
        True, meaning="exact corrections beside the sweeps; off = sweeps alone", source="ours", live=False
    )
    work_a_step: float = param(
        1e5,
        low=1.0,
        high=1e9,
        meaning="work of exact corrections per beat, on average; 100,000 take about half a millisecond",
        source="ours",
    )
    work_an_experience: float = param(
        90.0, low=0.0, high=1e6, meaning="work that each experience adds to an exact correction", source="ours"
    )
    largest: int = param(
        4000,
        unit="experiences",
        low=1,
        high=20_000,
        meaning="a map with a larger densely linked core is left to the sweeps; 4,000 take 2 s and 250 MB",
        source="ours",
    )
    entangled_work: float = param(
        1e9,
        low=0.0,
        high=1e12,
        meaning="work that an attempt at such a map counts as, so that the next one comes late",
        source="ours",
    )
    rounds: int = param(
        2, low=1, high=20, meaning="how often headings are solved, so that their wrapping settles", source="ours"
    )
    rad_per_m: float = param(
        0.7,
        unit="rad/m",
        low=0.01,
        high=10.0,
        meaning="error in heading that counts as much as an error of one metre",
        source="ours",
    )
    bias_sigma: float = param(
        0.01,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        meaning="how large a bias of the yaw rate may well be; what a few short loops seem to show beyond it is not believed",
        source="ours",
    )
    odometry_gives: float = param(
        5.0, unit="σ", low=0.1, high=100.0, meaning="disagreement at which odometry counts half", source="ours"
    )
    look_gives: float = param(
        1.0, unit="σ", low=0.1, high=100.0, meaning="disagreement from which on a look pulls no harder", source="ours"
    )

    closure_sigma: float = param(
        0.15, unit="m", low=0.0, high=5.0, meaning="least error that a closure is taken to have", source="ours"
    )
    closure_bar: float = param(
        9.0, unit="σ²", low=0.1, high=1e4, meaning="a closure that is farther off is given up", source="ours"
    )
    closure_trial: float = param(
        36.0,
        unit="σ²",
        low=0.1,
        high=1e4,
        meaning="all closures are put on trial when the map leaves one of them farther off than this",
        source="ours",
    )
    closure_growth: float = param(
        1.4, low=1.01, high=10.0, meaning="how much more strictly each round judges than the one before", source="ours"
    )

    def __post_init__(self) -> None:
        check_ranges(self)
