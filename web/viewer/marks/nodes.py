"""The map's experiences as dots, some hundred in each scene node. Only nodes in which a dot has moved or changed its colour are
sent again, so a large map costs what moves in it, and a new experience costs no more in it than in a small one."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

A_NODE = 256
FAR = -50.0


class Nodes:
    def __init__(self, scene: viser.SceneApi, name: str, size: float) -> None:
        self._scene, self._name, self._size = scene, name, size
        self.clouds: list[viser.PointCloudHandle] = []

    def place(self, places: NDArray[np.floating]) -> None:
        """(n, 3) where the dots are; there are no others."""
        for k in range(max(-(-len(places) // A_NODE), len(self.clouds))):
            if k == len(self.clouds):
                self._add()
            points = np.full((A_NODE, 3), FAR, np.float32)
            some = places[k * A_NODE : (k + 1) * A_NODE]
            points[: len(some)] = some
            self.clouds[k].points = points

    def paint(self, colours: NDArray[np.uint8]) -> None:
        """(n, 3); of more dots than there are, the first count."""
        for k, cloud in enumerate(self.clouds):
            painted = np.zeros((A_NODE, 3), np.uint8)
            some = colours[k * A_NODE : (k + 1) * A_NODE]
            painted[: len(some)] = some
            cloud.colors = painted

    def _add(self) -> None:
        self.clouds.append(
            self._scene.add_point_cloud(
                f"{self._name}_{len(self.clouds)}",
                np.full((A_NODE, 3), FAR, np.float32),
                np.zeros((A_NODE, 3), np.uint8),
                point_size=self._size,
                point_shape="circle",
                point_shading="flat",
            )
        )
