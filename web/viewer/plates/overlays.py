"""Layers over the floors of map and pose cells: where the sonars met something, and how long it takes to the goal."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from web.messages import OccupancyPicture
from web.viewer.fits import DEPTH, WIDTH, MapFit
from web.viewer.primitives.images import Pixels
from web.viewer.primitives.palette import Palette, Rgb

PX_PER_UNIT = 48  # of the map plate
SURE = 0.45  # how far the probability must be from one half for the full colour
COVERED_M, SEEN = 1.0, 0.35  # floor no nearer to an experience is only seen, and so much as bright


def occupancy_colours(
    probability: NDArray[np.float32], ground: Pixels, palette: Palette, covered: NDArray[np.bool_] | None = None
) -> Pixels:
    """`ground` (h, w, 3), brighter where the floor is free, the more where it is `covered`, and dark where something stands;
    probability: (h, w)."""
    sure = np.clip((np.asarray(probability, np.float32) - 0.5) / SURE, -1, 1)
    if covered is not None:
        sure = np.where((sure < 0) & ~covered, SEEN * sure, sure)
    sure = sure[..., None]
    to = np.where(sure < 0, _colour(palette.free), _colour(palette.occupied))
    return (ground + (to - ground) * np.abs(sure) * 0.9).astype(np.uint8)


def map_floor(picture: OccupancyPicture, fit: MapFit, palette: Palette, been_xy: NDArray[np.floating]) -> Pixels:
    """The whole floor of the map plate with the occupancy, placed as the map is; the first row is at the back.

    been_xy: (n, 2) m, where the robot has been.
    """
    size = round(WIDTH * PX_PER_UNIT), round(DEPTH * PX_PER_UNIT)
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]) * picture.cell_m + picture.origin_xy_m
    placed = fit.to_plate(corners)
    pixels = _pixels(placed)
    onto = np.column_stack([pixels[1] - pixels[0], pixels[2] - pixels[0], pixels[0]])
    laid = cv2.warpAffine(
        picture.probability, onto, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0.5
    )
    ground = np.broadcast_to(np.array(palette.floor, np.uint8), (size[1], size[0], 3))
    covered = _near(_pixels(fit.to_plate(been_xy)), (size[1], size[0]), COVERED_M * fit.scale * PX_PER_UNIT)
    return occupancy_colours(np.asarray(laid, np.float32), ground, palette, covered)


def _pixels(placed: NDArray[np.float64]) -> NDArray[np.float64]:
    return PX_PER_UNIT * np.column_stack([placed[:, 0] + WIDTH / 2, DEPTH / 2 - placed[:, 1]])


def _near(points: NDArray[np.float64], shape: tuple[int, int], within: float) -> NDArray[np.bool_]:
    """Which pixels have one of the points within so many of them."""
    column, row = np.rint(points).astype(np.int64).T
    inside = (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    far = np.ones(shape, np.uint8)
    far[row[inside], column[inside]] = 0
    return np.asarray(cv2.distanceTransform(far, cv2.DIST_L2, cv2.DIST_MASK_5)) <= within


def cells_occupied(ground: Pixels, probability: NDArray[np.float32], palette: Palette) -> Pixels:
    """The pose cells' floor with the occupancy in their frame; row 0 of (n_y, n_x) is at the front edge."""
    return occupancy_colours(_enlarged(probability, ground, cv2.INTER_LINEAR), ground, palette)


def cells_timed(ground: Pixels, seconds: NDArray[np.float32], palette: Palette) -> Pixels:
    """The pose cells' floor with the goal memory's times, (n_y, n_x): bright near the goal, bare where no way is known."""
    known = np.isfinite(seconds)
    longest = float(seconds[known].max(initial=0.0))
    colours = palette.times(np.where(known, seconds, 0).ravel().astype(np.float32), longest).reshape(*seconds.shape, 3)
    large = np.stack([_enlarged(colours[..., k], ground, cv2.INTER_NEAREST) for k in range(3)], 2)
    weight = _enlarged(known.astype(np.float32), ground, cv2.INTER_NEAREST)[..., None] * 0.85
    return (ground + (large - ground.astype(np.float32)) * weight).astype(np.uint8)


def cells_ringed(
    ground: Pixels,
    shape: tuple[int, int, int],
    centre: tuple[float, float],
    radius: float,
    colour: Rgb,
) -> Pixels:
    """The pose cells' floor with a disc around a place, all in cells. Where the disc leaves, it goes on at the other side."""
    _, n_y, n_x = shape
    height: int = ground.shape[0]
    width: int = ground.shape[1]
    x = (np.arange(width) + 0.5) / width * n_x - 0.5
    y = (height - np.arange(height) - 0.5) / height * n_y - 0.5
    dx, dy = (_around(x - centre[0], n_x))[None], (_around(y - centre[1], n_y))[:, None]
    apart = np.hypot(dx, dy)
    line = 1.5 * n_x / width
    weight = np.where(apart <= radius, 0.3, 0.0)
    weight = np.where(np.abs(apart - radius) < line, 0.95, weight)[..., None]
    return (ground + (_colour(colour) - ground) * weight).astype(np.uint8)


def _colour(colour: Rgb) -> NDArray[np.float32]:
    return np.array(colour, np.float32)


def _enlarged(values: NDArray[Any], ground: Pixels, how: int) -> NDArray[np.float32]:
    large = cv2.resize(np.asarray(values, np.float32), (ground.shape[1], ground.shape[0]), interpolation=how)
    return np.asarray(large, np.float32)[::-1]


def _around(apart: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    return apart - size * np.round(apart / size)
