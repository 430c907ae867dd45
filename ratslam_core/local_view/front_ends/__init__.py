"""Front ends: four ways from an image (or a scene number) to the bytes that are stored and compared."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ratslam_core.local_view.front_ends.complex_cells import ComplexCells
from ratslam_core.local_view.front_ends.hue_saturation import HueSaturation
from ratslam_core.local_view.front_ends.scene_numbers import SceneNumbers
from ratslam_core.local_view.front_ends.template import Template
from ratslam_core.local_view.matcher import Features
from ratslam_core.params import LocalViewParams


class FrontEnd(Protocol):
    """Features are uint8, shape (columns * rows,). Their mean absolute difference says how unlike two views are."""

    columns: int
    rows: int  # bytes of each column
    shifts: bool  # features are columns of the image: turning the robot shifts them, and the shift tells its heading
    scale: float  # levels for a mean difference of one byte; in levels all front ends are about equally strict
    vague: float  # least difference in levels, since even an equal view leaves the place uncertain

    def look(self, image: NDArray[np.uint8] | None, scene: int | None, /) -> Features:
        """The features of what is seen now; ValueError says what is wrong with it."""
        ...

    def bland(self, features: Features, params: LocalViewParams, /) -> bool:
        """Whether they show nothing that could be recognised."""
        ...

    def threshold(self, params: LocalViewParams, /) -> float:
        """The difference up to which a view is recognised."""
        ...

    def surprise(self, params: LocalViewParams, /) -> float:
        """The difference between two successive images above which driving cannot explain it; inf = cannot be told."""
        ...

    def picture(self, features: Features, /) -> NDArray[np.uint8]:
        """The features as a picture for people: (h, w) grey or (h, w, 3) RGB."""
        ...

    def words(self, features: Features, /) -> str:
        """The features in words, for people who cannot see the picture."""
        ...


def named_front_end(params: LocalViewParams) -> FrontEnd:
    """The front end that the parameters choose."""
    match params.front_end:
        case "template":
            return Template()
        case "complex cells":
            return ComplexCells(params)
        case "hue and saturation":
            return HueSaturation(params)
        case "scene numbers":
            return SceneNumbers()
        case _:
            raise ValueError(f"front_end must be one that is known, got {params.front_end!r}")
