"""The map's links as lines, some hundred in each scene node. Only nodes in which a line has moved are sent again."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Rgb

A_NODE = 192
PX = 1.0  # thickness at any distance; with a thickness in plate units, viser would draw each line twice


class Links:
    def __init__(self, scene: viser.SceneApi, name: str, colour: Rgb) -> None:
        self._scene, self._name, self._colour = scene, name, colour
        self.nodes: list[viser.LineSegmentsHandle] = []

    def show(self, places: NDArray[np.floating], links: NDArray[np.integer]) -> None:
        """places: (n, 3) of the experiences; links: (m, 2) rows of it. There and back are one line; old lines come first."""
        pairs = np.unique(np.sort(links.reshape(-1, 2), 1)[:, ::-1], axis=0)
        lines = places[pairs].astype(np.float32)
        for k in range(0, max(len(lines), len(self.nodes) * A_NODE), A_NODE):
            self._node(k // A_NODE).points = meshes.some(lines[k : k + A_NODE], A_NODE)

    def _node(self, k: int) -> viser.LineSegmentsHandle:
        if k == len(self.nodes):
            line = self._scene.add_line_segments(
                f"{self._name}_{k}", meshes.NOWHERE, self._colour, thickness=PX, thickness_units="screen"
            )
            self.nodes.append(line)
        return self.nodes[k]
