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

FRONT_ENDS: dict[str, type[FrontEnd]] = {
    "template": Template,
    "complex cells": ComplexCells,
    "hue and saturation": HueSaturation,
    "scene numbers": SceneNumbers,
    "image and sonars": ImageAndSonars,
    "limited levels": LimitedLevels,
    "laser": Laser,
}

__all__ = ["FRONT_ENDS", "FrontEnd"]
