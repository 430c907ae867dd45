"""Which paint shows as a wanted colour: viser lights meshes, and then applies a film curve to everything but images.

The curve is three.js' ACESFilmicToneMapping (S. Hill's fit of the Academy's RRT and ODT), inverted here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
EXPOSURE = 1 / 0.6
GLOSS = 0.0066  # the share of the light that any mesh reflects, whatever its paint (measured)
BRIGHTEST = 0.94  # of what a screen can show; white itself would need infinite light
_INTO = np.array([(0.59719, 0.35458, 0.04823), (0.07600, 0.90834, 0.01566), (0.02840, 0.13383, 0.83777)])
_OUT_OF = np.array([(1.60475, -0.53108, -0.07367), (-0.10208, 1.10813, -0.00605), (-0.00327, -0.07276, 1.07602)])


def to_linear(colour: ArrayLike) -> Array:
    """sRGB bytes (..., 3) to light, 0-1."""
    share = np.asarray(colour, np.float64) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def to_srgb(light: Array) -> NDArray[np.uint8]:
    """Light (..., 3) to sRGB bytes."""
    share = np.clip(light, 0, 1)
    bent = np.where(share <= 0.0031308, share * 12.92, 1.055 * share ** (1 / 2.4) - 0.055)
    return np.rint(bent * 255).astype(np.uint8)


def film(light: Array) -> Array:
    """What the renderer shows for light (..., 3) that reaches it."""
    v = np.asarray(light) * EXPOSURE @ _INTO.T
    bent = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    return np.clip(bent @ _OUT_OF.T, 0, 1)


def before_film(shown: Array) -> Array:
    """The light (..., 3) that shows as `shown`; colours out of reach are moved to the nearest one in reach."""
    y = np.clip(np.minimum(shown, BRIGHTEST) @ np.linalg.inv(_OUT_OF).T, 0, 0.99)
    a, b, c = 1 - 0.983729 * y, 0.0245786 - 0.4329510 * y, -0.000090537 - 0.238081 * y
    v = (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return np.clip(v @ np.linalg.inv(_INTO).T / EXPOSURE, 0, None)


def paint(colour: ArrayLike) -> NDArray[np.uint8]:
    """sRGB paint that shows as `colour` (..., 3) on a line: lines are not lit."""
    return to_srgb(before_film(to_linear(colour)))


def vertex_paint(colour: ArrayLike) -> NDArray[np.uint8]:
    """The same for lines with a colour at each end, whose bytes are taken as linear light."""
    return np.rint(np.clip(before_film(to_linear(colour)), 0, 1) * 255).astype(np.uint8)


def lit_paint(colour: ArrayLike, light: ArrayLike) -> NDArray[np.uint8]:
    """sRGB paint that shows as `colour` (..., 3) on a mesh that `light` falls on."""
    return to_srgb(before_film(to_linear(colour)) / np.asarray(light) - GLOSS)


def linear_paint(colour: ArrayLike, light: ArrayLike) -> NDArray[np.uint8]:
    """The same for batched meshes, whose bytes are taken as linear light."""
    share = before_film(to_linear(colour)) / np.asarray(light) - GLOSS
    return np.rint(np.clip(share, 0, 1) * 255).astype(np.uint8)
