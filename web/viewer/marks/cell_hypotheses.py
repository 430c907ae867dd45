"""The states of the pose cells that stand for where the robot may be instead: rings on the floor, larger the likelier each is."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import viser

from web.messages import Hypothesis
from web.messages.told import share_words
from web.viewer.fits import CellFit
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import Pill
from web.viewer.primitives.palette import Palette, mix

MOST, SIDES = 4, 24
LEAST, MORE = 0.25, 0.35  # radius of one that is not likely, and how much more of one that is certain
Z, ABOVE, LABEL = 0.02, 0.3, 0.36
CIRCLE = np.array([(math.cos(k * math.tau / SIDES), math.sin(k * math.tau / SIDES), 0.0) for k in range(SIDES + 1)])


class CellHypotheses:
    """The likeliest has its share beside it; the map has those of all."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str) -> None:
        self._palette = palette
        self._rings = scene.add_line_segments(name, meshes.NOWHERE, palette.drawn(palette.robot), thickness=0.05)
        self._label = Pill(scene, f"{name}_label", LABEL, mix(palette.robot, palette.floor, 0.1), palette)

    def show(self, hypotheses: Sequence[Hypothesis], fit: CellFit) -> None:
        held = [(one.cells, one.share) for one in hypotheses if one.cells is not None][:MOST]
        places = fit.path(np.array([cells for cells, _ in held]).reshape(-1, 3))
        rings = [
            (x, y, Z) + (LEAST + MORE * math.sqrt(share)) * CIRCLE
            for (x, y, _), (_, share) in zip(places.tolist(), held, strict=True)
        ]
        sides = np.array([np.stack([ring[:-1], ring[1:]], 1) for ring in rings], np.float32).reshape(-1, 2, 3)
        self._rings.points = meshes.some(sides if held else meshes.NOWHERE, MOST * SIDES)
        if held:
            x, y, z = places[0].tolist()
            self._label.show(share_words(held[0][1]), self._palette.sheet, (x, y, z + ABOVE))
        else:
            self._label.hide()
