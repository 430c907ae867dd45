"""All people of the office as one batch: handles for each of fifty people would need six hundred messages a second."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from web.viewer.fits.office_fit import METRE_HIGH, OfficeFit
from web.viewer.primitives import meshes
from web.viewer.primitives.palette import Palette

HEAD = (0.62, 0.8, 1.0)  # shares of a person's height: shoulders, chin, top
AWAY = (0.0, 0.0, -50.0)  # far below the plates


class Crowd:
    """The batch has a place for each person; the places of people who have left are far below the plates."""

    def __init__(self, scene: viser.SceneApi, palette: Palette, name: str) -> None:
        self._scene, self._palette, self._name = scene, palette, name
        self._handle: viser.BatchedMeshHandle | None = None
        self._places = 0
        self._shown: tuple[bytes, ...] = ()

    def show(self, people: NDArray[np.floating], rgb: NDArray[np.uint8], fit: OfficeFit) -> None:
        """people: (n, 5) x, y, heading, radius, height, as in `LivingLayer`. Only what has changed is sent."""
        if len(people) > self._places:
            self._make(len(people))
        if self._handle is None:
            return
        n, rows = len(people), np.asarray(people, np.float64).reshape(-1, 5)
        at, sizes, turns = (
            np.tile(np.array(AWAY, np.float32), (self._places, 1)),
            np.ones((self._places, 3)),
            np.zeros(self._places),
        )
        at[:n, :2], at[:n, 2] = fit.to_plate(rows[:, :2]), 0.0
        sizes[:n, :2] = np.maximum(rows[:, 3:4] * fit.scale, 0.07)
        sizes[:n, 2] = rows[:, 4] * METRE_HIGH * max(fit.relief, 0.5)
        turns[:n] = 0.5 * rows[:, 2]
        colours = np.zeros((self._places, 3), np.uint8)
        if n:
            colours[:n] = self._palette.batched(rgb)
        names = ("batched_positions", "batched_scales", "batched_wxyzs", "batched_colors")
        wxyz = np.column_stack([np.cos(turns), 0 * turns, 0 * turns, np.sin(turns)])
        arrays = (at, sizes.astype(np.float32), wxyz.astype(np.float32), colours)
        now = tuple(array.tobytes() for array in arrays)
        for name, array, is_now, was in zip(names, arrays, now, self._shown or now, strict=True):
            if is_now != was or not self._shown:
                setattr(self._handle, name, array)
        self._shown = now
        if self._handle.visible != bool(n):
            self._handle.visible = bool(n)

    def _make(self, places: int) -> None:
        self._places, self._shown = places, ()
        self._handle = self._scene.add_batched_meshes_simple(
            self._name,
            *_figure(),
            batched_wxyzs=np.tile(np.array((1, 0, 0, 0), np.float32), (places, 1)),
            batched_positions=np.tile(np.array(AWAY, np.float32), (places, 1)),
            batched_scales=np.ones((places, 3), np.float32),
            batched_colors=np.zeros((places, 3), np.uint8),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )


def _figure() -> meshes.Mesh:
    """A person of radius 1 and height 1 who looks along +x."""
    circle = meshes.circle(1.0, corners=20)
    return meshes.joined(
        meshes.extruded(circle * (0.7, 1.0), 0.0, HEAD[0]),
        meshes.extruded(circle * 0.5, HEAD[0] + 0.02, HEAD[2]),
        meshes.extruded(
            meshes.rounded_rectangle(0.2, 0.3, 0.08, 4, centre=(0.55, 0.0)), HEAD[1] - 0.06, HEAD[1] + 0.06
        ),
    )
