"""The parameters of the pose cells. Sources are named in params/__init__.py."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param

MOST_CELLS = 2**26  # of the pose cells, four bytes each: a brain has to fit into memory, and into its file


@kind("parameters of pose cells/5")
@dataclass(frozen=True, slots=True)
class PoseCellParams:
    """The continuous attractor network (A section 4)."""

    n_x: int = param(
        64, symbol="n_x'", unit="cells", low=8, high=1000, meaning="cells along x'", source="D 5.3", live=False
    )
    n_y: int = param(
        64, symbol="n_y'", unit="cells", low=8, high=1000, meaning="cells along y'", source="D 5.3", live=False
    )
    n_theta: int = param(
        36,
        symbol="n_θ'",
        unit="layers",
        low=8,
        high=360,
        meaning="layers of heading; 36 are 10 degrees each",
        source="A 4",
        live=False,
    )
    cell_m: float = param(
        0.25, unit="m", low=0.01, high=100.0, meaning="side of one cell", source="A 4, D 5.3", live=False
    )
    excite_sigma: float = param(
        0.5,
        symbol="σ_ε",
        unit="cells",
        low=0.2,
        high=3.0,
        meaning="width of the excitation Gaussian",
        source="A eq. 10; value ours",
    )
    inhibit: float = param(
        3e-4,
        symbol="φ",
        low=0.0,
        high=0.02,
        meaning="global inhibition taken from every cell",
        source="A eq. 11; value ours",
    )
    carry: bool = param(
        True,
        meaning="a packet goes as far as the wheels say: the motion that the attractor swallows, and that the spread of its "
        "headings takes away, is given back; off = each layer straight on",
        source="ours",
    )
    yaw_bias: float = param(
        0.0,
        symbol="b_θ'",
        unit="rad/s",
        low=-0.2,
        high=0.2,
        meaning="added to the yaw rate for the pose cells alone while the wheels turn: 0.0262 = 1.5 deg/s; 0 = as it is",
        source="B 5.2",
    )

    def __post_init__(self) -> None:
        check_ranges(self)
        cells = self.n_x * self.n_y * self.n_theta
        if cells > MOST_CELLS:
            raise ValueError(f"n_x, n_y and n_theta must make at most {MOST_CELLS} cells together, got {cells}")
