"""Front ends: seven ways from what is sensed (or a scene number) to the bytes that are stored and compared."""

from __future__ import annotations

from ratslam_core.local_view.front_ends.front_end import FrontEnd
from ratslam_core.local_view.front_ends.image_and_sonars import ImageAndSonars, LimitedLevels
from ratslam_core.local_view.front_ends.laser import Laser
from ratslam_core.local_view.front_ends.papers import ComplexCells, HueSaturation, SceneNumbers, Template

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
