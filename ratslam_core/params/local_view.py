"""The parameters of the local view cells and of their links. Sources are named in params/__init__.py."""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from ratslam_core.params.parameter import check_ranges, param

COLUMNS, ROWS = 12, 8  # of a view


@kind("parameters of local view/1")
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
        6.0,
        unit="grey levels",
        low=0.0,
        high=255.0,
        meaning="mean absolute difference up to which a view is recognised",
        source="D 7; value ours",
    )
    composite_threshold: float = param(
        7.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="as `match_threshold`, for image and sonars",
        source="ours",
    )
    edge_threshold: float = param(
        6.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="as `match_threshold`, for complex cells",
        source="A 3.3; value ours",
    )
    colour_threshold: float = param(
        5.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="as `match_threshold`, for hue and saturation",
        source="B 7; value ours",
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
    min_contrast: float = param(
        12.0, unit="grey levels", low=0.0, high=255.0, meaning="a view with less contrast shows nothing", source="ours"
    )
    min_edges: float = param(
        16.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="complex cells with a lower mean response see nothing",
        source="ours",
    )
    min_colour: float = param(
        0.6,
        low=0.0,
        high=1.0,
        meaning="a view with a smaller share of colour shows nothing to hue and saturation",
        source="ours",
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
        20.0,
        unit="grey levels",
        low=0.0,
        high=255.0,
        meaning="difference from the image before that driving cannot explain",
        source="ours",
    )
    composite_surprise: float = param(
        9.5, unit="levels", low=0.0, high=255.0, meaning="as `surprise`, for image and sonars", source="ours"
    )
    edge_surprise: float = param(
        20.0, unit="levels", low=0.0, high=255.0, meaning="as `surprise`, for complex cells", source="ours"
    )
    colour_surprise: float = param(
        20.0, unit="levels", low=0.0, high=255.0, meaning="as `surprise`, for hue and saturation", source="ours"
    )
    turn_slack: float = param(
        0.3,
        low=0.0,
        high=1.0,
        meaning="share of the turn by which the wheels may be wrong about it in a beat",
        source="ours",
    )
    range_surprise: float = param(
        2.0,
        low=0.0,
        high=10.0,
        meaning="how much a change of the sonars adds to the image's change; above 1 is a kidnap",
        source="ours",
    )
    lost_injection: float = param(
        0.5,
        low=0.0,
        high=5.0,
        meaning="what all links of a view inject together while the robot knows that it is lost",
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
    dark: float = param(
        40.0,
        unit="grey levels",
        low=1.0,
        high=1000.0,
        meaning="added to grey levels before their logarithm is taken, so that noise in the dark is not amplified",
        source="ours",
        live=False,
    )
    even_light: float = param(
        0.8,
        low=0.0,
        high=1.0,
        meaning="share of the mean of an image's column that image and sonars take for light",
        source="ours",
        live=False,
    )
    echo_weight: float = param(
        0.12,
        low=0.0,
        high=10.0,
        meaning="weight of the echoes' mean difference against that of the picture",
        source="ours",
        live=False,
    )
    echo_least_m: float = param(
        0.2, unit="m", low=0.01, high=1.0, meaning="nearer echoes count as this", source="ours", live=False
    )
    echo_most_m: float = param(
        4.0, unit="m", low=1.1, high=100.0, meaning="farther echoes count as none", source="ours", live=False
    )
    full_pattern: float = param(
        12.0,
        unit="levels",
        low=0.1,
        high=255.0,
        meaning="how much an image must change along its rows to be trusted altogether",
        source="ours",
    )
    plain_doubt: float = param(
        6.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="added to the difference of a view that does not change along its rows at all",
        source="ours",
    )
    silent_doubt: float = param(
        1.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="added to the difference of a view when nothing is within reach of the sonars",
        source="ours",
    )
    deaf_doubt: float = param(
        3.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="added to the difference of a view of a robot without sonars, which the picture alone must tell apart",
        source="ours",
    )
    min_pattern: float = param(
        2.0,
        unit="levels",
        low=0.0,
        high=255.0,
        meaning="a view that changes less along its rows shows nothing to image and sonars",
        source="ours",
    )
    edge_neighbourhood: int = param(
        9,
        unit="pixels",
        low=1,
        high=35,
        meaning="width of the neighbourhood by whose brightness complex cells divide an edge",
        source="A 3.3; value ours",
        live=False,
    )
    edge_dark: float = param(
        8.0,
        unit="grey levels",
        low=0.1,
        high=255.0,
        meaning="added to that brightness, so that noise in the dark is not amplified",
        source="ours",
        live=False,
    )
    edge_gain: float = param(
        600.0,
        unit="levels",
        low=1.0,
        high=1e5,
        meaning="response of a complex cell to an edge as strong as the brightness around it",
        source="ours",
        live=False,
    )
    full_saturation: float = param(
        0.5,
        low=0.01,
        high=1.0,
        meaning="saturation from which on a pixel falls into the last bin",
        source="ours",
        live=False,
    )
    certain_saturation: float = param(
        0.1,
        low=1e-3,
        high=1.0,
        meaning="saturation from which on the hue of a pixel is trusted",
        source="ours",
        live=False,
    )
    full_bin: float = param(
        1 / 6,
        low=0.01,
        high=1.0,
        meaning="share of the image that fills a bin of hue and saturation",
        source="ours",
        live=False,
    )
    enabled: bool = param(True, meaning="vision; off = path integration only", source="A figures 9, 10")

    def __post_init__(self) -> None:
        check_ranges(self)
