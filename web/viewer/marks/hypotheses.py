"""Hypotheses: places where the robot may be instead of at the pose estimate."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import Hypothesis
from web.messages.robot_status import share_words
from web.viewer.fits import CellFit
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import GHOST, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette, mix

MOST = 4
Z, BELOW, LABEL_Z, LABEL = 0.19, 0.75, 0.5, 0.36
RING, RING_WIDTH = 0.42, 0.06


class Hypotheses:
    """On the map: pale arrows in rings, each with how likely it is."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str, room: LabelRoom) -> None:
        self._palette = palette
        self.frames = [scene.add_frame(f"{name}_{k}", show_axes=False, visible=False) for k in range(MOST)]
        for k in range(MOST):
            add_mesh(scene, f"{name}_{k}/body", meshes.heading_arrow(1.1, 0.0), palette.lit(palette.casing))
            ring = meshes.ring(RING, RING_WIDTH, 0.02)
            add_mesh(scene, f"{name}_{k}/ring", ring, palette.lit(palette.robot))
        fill = mix(palette.robot, palette.floor, 0.1)
        self._labels = [
            Pill(scene, f"{name}_{k}_label", LABEL, fill, palette, room=room, rank=GHOST) for k in range(MOST)
        ]

    def show(self, places: NDArray[np.float64], headings: Sequence[float], shares: Sequence[float]) -> None:
        """places: (n, 2) on the plate; headings: rad; shares: how likely each is, 0 to 1."""
        for k, (frame, label) in enumerate(zip(self.frames, self._labels, strict=True)):
            frame.visible = k < len(places)
            if not frame.visible:
                label.hide()
                continue
            (x, y), half = places[k].tolist(), headings[k] / 2
            frame.position, frame.wxyz = (x, y, Z), (math.cos(half), 0.0, 0.0, math.sin(half))
            label.show(share_words(shares[k]), self._palette.sheet, (x, y - BELOW, LABEL_Z))


SIDES = 24
LEAST, MORE = 0.25, 0.35  # radius of one that is not likely, and how much more of one that is certain
FLOOR_Z, ABOVE = 0.02, 0.3
CIRCLE = np.array([(math.cos(k * math.tau / SIDES), math.sin(k * math.tau / SIDES), 0.0) for k in range(SIDES + 1)])


class CellHypotheses:
    """Among the pose cells: rings on the floor, larger the likelier each is. The likeliest has its share beside it; the map has
    those of all."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str) -> None:
        self._palette = palette
        self._rings = scene.add_line_segments(name, meshes.NOWHERE, palette.drawn(palette.robot), thickness=0.05)
        self._label = Pill(scene, f"{name}_label", LABEL, mix(palette.robot, palette.floor, 0.1), palette)

    def show(self, hypotheses: Sequence[Hypothesis], fit: CellFit) -> None:
        held = [(one.cells, one.share) for one in hypotheses if one.cells is not None][:MOST]
        places = fit.path(np.array([cells for cells, _ in held]).reshape(-1, 3))
        rings = [
            (x, y, FLOOR_Z) + (LEAST + MORE * math.sqrt(share)) * CIRCLE
            for (x, y, _), (_, share) in zip(places.tolist(), held, strict=True)
        ]
        sides = np.array([np.stack([ring[:-1], ring[1:]], 1) for ring in rings], np.float32).reshape(-1, 2, 3)
        self._rings.points = meshes.some(sides if held else meshes.NOWHERE, MOST * SIDES)
        if held:
            x, y, z = places[0].tolist()
            self._label.show(share_words(held[0][1]), self._palette.sheet, (x, y, z + ABOVE))
        else:
            self._label.hide()
