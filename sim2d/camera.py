"""The robot's camera: buffers and textures around the kernels of `column_hits` and `painting`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim2d.atlas import build_atlas
from sim2d.column_hits import MAX_HITS, column_hits
from sim2d.painting import FADE_M, expose, paint_columns
from sim2d.params import SimParams
from sim2d.world import World

_NOISE_BANK = 1 << 17


class Camera:
    """Draws what is seen from a pose. Owns buffers; nothing of it depends on earlier images."""

    def __init__(self, world: World, params: SimParams) -> None:
        walls = world.walls
        self._segments = world.segments()
        self._bottoms = np.array([w.bottom for w in walls])
        self._tops = np.array([w.height for w in walls])
        self._full = np.array([w.stands and w.height >= self._tops.max() for w in walls])
        self._shades = _shades(self._segments)
        self._atlas = build_atlas(world)
        self._width, self._height = params.image_width, params.image_height
        self._focal = 0.5 * self._width / math.tan(0.5 * params.camera_fov_rad)
        self._eye = params.camera_height_m
        self._background = _background(world, self._height, self._focal, self._eye)
        self._noise = np.zeros(_NOISE_BANK + 3 * self._width * self._height, np.float32)
        self._counts = np.zeros(self._width, np.int64)
        self._walls = np.zeros((self._width, MAX_HITS), np.int64)
        self._hits = np.zeros((self._width, MAX_HITS, 3))
        self._canvas = np.zeros((self._width, self._height, 3), np.float32)

    def new_noise(self, rng: np.random.Generator) -> None:
        """Draw the noise of all images to come: 9216 deviates an image would take longer than the image."""
        self._noise = rng.standard_normal(self._noise.size, dtype=np.float32)

    def image(
        self, x: float, y: float, heading_rad: float, light: float, noise: float, rng: np.random.Generator
    ) -> NDArray[np.uint8]:
        """(height, width, 3) RGB. One draw from `rng`; `noise` in grey levels; `light` 1 = as painted."""
        atlas = self._atlas
        column_hits(self._segments, self._full, x, y, heading_rad, self._focal, self._counts, self._walls, self._hits)
        paint_columns(
            atlas.texels, atlas.first, atlas.columns, atlas.rows, self._bottoms, self._tops, self._shades, self._eye,
            self._focal, self._background, self._counts, self._walls, self._hits, self._canvas,
        )  # fmt: skip
        out = np.empty((self._height, self._width, 3), np.uint8)
        expose(self._canvas, light, noise, self._noise, int(rng.integers(_NOISE_BANK)), out)
        return out

    def depths(self, x: float, y: float, heading_rad: float) -> NDArray[np.float64]:
        """(width,): metres along the camera's axis to the nearest wall of each column, inf where there is none."""
        column_hits(self._segments, self._full, x, y, heading_rad, self._focal, self._counts, self._walls, self._hits)
        inverse = np.where(self._counts > 0, self._hits[:, 0, 0], 0.0)
        return np.divide(1.0, inverse, out=np.full(self._width, np.inf), where=inverse > 0)


def _shades(segments: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2 n,): brightness of each wall's left and right side, so that walls that meet differ."""
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]
    towards = (-dy * 0.5 + dx * 0.85) / np.hypot(dx, dy)  # of the left side's normal
    return np.stack([1.0 + 0.09 * towards, 1.0 - 0.09 * towards], axis=1).ravel()


def _background(world: World, height: int, focal: float, eye: float) -> NDArray[np.float32]:
    """(height, 3): floor and ceiling, row by row, darker with distance."""
    ceiling = max(w.height for w in world.walls) - eye
    down = np.arange(height) + 0.5 - 0.5 * height
    flat = np.where(np.abs(down) < 0.25, 0.25, down)
    depth = np.where(flat > 0, eye, -ceiling) * focal / flat
    colour = np.where(flat[:, None] > 0, world.floor_colour, world.ceiling_colour)
    return (colour / (1.0 + depth / FADE_M)[:, None]).astype(np.float32)
