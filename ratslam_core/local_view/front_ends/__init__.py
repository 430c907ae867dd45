"""Front ends: seven ways from what is sensed (or a scene number) to the bytes that are stored and compared."""

from __future__ import annotations

from ratslam_core.local_view.front_ends.complex_cells import ComplexCells
from ratslam_core.local_view.front_ends.front_end import FrontEnd
from ratslam_core.local_view.front_ends.hue_saturation import HueSaturation
from ratslam_core.local_view.front_ends.image_and_sonars import ImageAndSonars
from ratslam_core.local_view.front_ends.laser import Laser
from ratslam_core.local_view.front_ends.limited_levels import LimitedLevels
from ratslam_core.local_view.front_ends.scene_numbers import SceneNumbers
from ratslam_core.local_view.front_ends.template import Template
from ratslam_core.params import LocalViewParams

__all__ = ["FrontEnd", "named_front_end"]


def named_front_end(params: LocalViewParams) -> FrontEnd:
    """The front end that the parameters choose."""
    match params.front_end:
        case "image and sonars":
            return ImageAndSonars(params)
        case "limited levels":
            return LimitedLevels(params)
        case "laser":
            return Laser()
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
