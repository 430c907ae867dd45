"""The parameters of the local view cells and of their links. Sources are named in params/__init__.py."""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param

COLUMNS, ROWS = 12, 8  # of a view


@kind("parameters of local view/3")
@dataclass(frozen=True, slots=True)
class LocalViewParams:
    """Recognising scenes (D section 7) and their Hebbian links to pose cells (A 4). They learn and inject once a beat."""

    front_end: str = param(
        "image and sonars",
        choices=(
            "template",
            "complex cells",
            "hue and saturation",
            "scene numbers",
            "image and sonars",
            "limited levels",
            "laser",
        ),
        meaning="what the features of a view are",
        source="D 7; A 3.3; B 7; B 5; ours",
        live=False,
    )
    match_threshold: float = param(
        1.0,
        low=0.0,
        high=100.0,
        meaning="mean absolute difference up to which a view is recognised, in multiples of the front end's own",
        source="D 7; value ours",
    )
    shift: int = param(
        2, unit="columns", low=0, high=5, meaning="horizontal shifts tried to either side", source="D 7; value ours"
    )
    facing: bool = param(
        True, meaning="the shift of a recognised view gives the robot's heading relative to that view", source="ours"
    )
    field_of_view: float = param(
        math.radians(50),
        unit="rad",
        low=0.1,
        high=6.3,
        meaning="width of the camera's view, to read headings from shifts",
        source="A 3, C IV.A",
    )
    learning_rate: float = param(0.15, symbol="η", low=0.0, high=1.0, meaning="Hebbian learning rate", source="C IV.C")
    adaptive: bool = param(
        False,
        meaning="the learning rate follows the strength of vision and the confidence of the estimate",
        source="A 6.3 (future work); ours",
    )
    learn_first: bool = param(
        False,
        meaning="a view learns before it injects; off = it injects only what it had learnt before this step",
        source="A 4; off is ours",
    )
    decay: float = param(
        0.0, symbol="δ", low=0.0, high=1.0, meaning="share of a link forgotten in each beat", source="A eq. 2"
    )
    most_links: int = param(
        600,
        low=0,
        high=1_000_000,
        meaning="links to pose cells that a view keeps, the strongest; 0 = all",
        source="ours",
    )
    saturation: float = param(
        0.02, symbol="s_max", low=0.0, high=1.0, meaning="most that one link injects", source="A eq. 4; value ours"
    )
    capped: bool = param(True, meaning="all links of a view inject at most `injection` together", source="ours")
    injection: float = param(
        0.14, low=0.0, high=5.0, meaning="most that all links of a view inject together", source="ours"
    )
    rest: float = param(
        10.0, unit="s", low=0.0, high=1e6, meaning="a view younger than this does not inject", source="ours"
    )
    surprise: float = param(
        1.0,
        low=0.0,
        high=100.0,
        meaning="difference from the image before that driving cannot explain, in multiples of the front end's own",
        source="ours",
    )
    false_positives: float = param(
        0.0,
        symbol="N_vis",
        low=0.0,
        high=1.0,
        meaning="share of the recognised views that are taken for another known one",
        source="D 5.1",
    )
    enabled: bool = param(True, meaning="vision; off = path integration only", source="A figures 9, 10")

    def __post_init__(self) -> None:
        check_ranges(self)
