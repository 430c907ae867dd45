"""Where the robot may be instead of where it believes itself to be: pale arrows in rings, each with how likely it is."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages.told import share_words
from web.viewer.primitives import meshes
from web.viewer.primitives.labels import GHOST, LabelRoom, Pill, add_mesh
from web.viewer.primitives.palette import Palette, mix

MOST = 4
Z, BELOW, LABEL_Z, LABEL = 0.19, 0.75, 0.5, 0.36
RING, RING_WIDTH = 0.42, 0.06


class Hypotheses:
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
