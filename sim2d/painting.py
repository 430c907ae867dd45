"""From the walls that each column meets to an image: textured, shaded by distance and side, with noise."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.atlas import LEVELS, MIDDLE
from sim2d.column_hits import MAX_HITS

FADE_M = 14.0  # brightness falls as 1 / (1 + depth / FADE_M): far corners are darker
_MAX_ROWS = 1024


class Strips(NamedTuple):
    """How the walls of a camera look: `Atlas` and, of each wall, where it begins and ends, of each side, its shade."""

    texels: NDArray[np.float32]
    first: NDArray[np.int64]
    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    bottoms: NDArray[np.float64]
    tops: NDArray[np.float64]
    shades: NDArray[np.float64]
    reflection: NDArray[np.float64]  # -1 where it is no glass


@njit(cache=True, nogil=True)
def paint_columns(
    strips: Strips,
    eye: float,
    focal: float,
    background: NDArray[np.float32],
    glow: NDArray[np.float64],
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
    panes: NDArray[np.int64],
    mirror_strips: NDArray[np.int64],
    mirror_hits: NDArray[np.float64],
    canvas: NDArray[np.float32],
) -> None:
    """Fill canvas (w, h, 3) from the hits of `column_hits`, far to near; edges are blended by the share they cover.

    glow: (w, k + 1) brightness of each hit, and of floor and ceiling. panes, mirror_...: from `mirror.mirrored`.
    """
    texels, first, columns, rows = strips.texels, strips.first, strips.columns, strips.rows
    bottoms, tops, shades, reflection = strips.bottoms, strips.tops, strips.shades, strips.reflection
    height = canvas.shape[1]
    stretch = np.empty(3 * _MAX_ROWS, np.float32)
    ends = np.empty(MAX_HITS, np.int64)
    reflected = np.empty((height, 3), np.float32)
    for c in range(canvas.shape[0]):
        image = canvas[c]
        around = np.float32(glow[c, glow.shape[1] - 1])
        image[:] = background
        if around != np.float32(1.0):
            image *= around
        # Of two walls that stand on the floor the nearer one hides all of the other below its own top.
        hidden = height
        for k in range(counts[c]):
            wall = walls[c, k] >> 1
            ends[k] = min(hidden, math.ceil(0.5 * height - (bottoms[wall] - eye) * focal * hits[c, k, 0]))
            if bottoms[wall] == 0.0 and reflection[wall] < 0.0:
                hidden = min(hidden, max(0, math.ceil(0.5 * height - (tops[wall] - eye) * focal * hits[c, k, 0])))
        for k in range(counts[c] - 1, -1, -1):
            strip, inverse, u0, u1, end = walls[c, k], hits[c, k, 0], hits[c, k, 1], hits[c, k, 2], ends[k]
            share, glass_top, target = reflection[strip >> 1], 0.0, image
            if share >= 0.0:  # glass: what it mirrors, or its own colour, goes over what is behind
                target = reflected
                target[:] = background
                glass_top = 0.5 * height - (tops[strip >> 1] - eye) * focal * inverse
                if panes[c] == k and mirror_strips[c] >= 0:
                    strip, end = mirror_strips[c], height
                    inverse, u0, u1 = mirror_hits[c, 0], mirror_hits[c, 1], mirror_hits[c, 2]
                    target *= around
            scale = focal * inverse  # pixels a metre
            top = 0.5 * height - (tops[strip >> 1] - eye) * scale
            bottom = 0.5 * height - (bottoms[strip >> 1] - eye) * scale
            begin, end = max(0, math.floor(top)), min(end, math.ceil(bottom))
            if begin < end:
                per_row = rows[strip] / (bottom - top)  # texels a pixel
                level = 0
                while level < LEVELS - 1 and per_row > 1.5:
                    level += 1
                    per_row *= 0.5
                n_rows = int(rows[strip]) >> level
                low = max(0, math.floor((begin - top) * per_row - 0.5))
                high = min(n_rows, math.ceil((end - top) * per_row + 0.5) + 1)
                shade = shades[strip] / (1.0 + 1.0 / (inverse * FADE_M)) * glow[c, k]
                start = first[strip, level] + 3 * low
                count = 3 * (high - low)
                _mean_along(texels, start, 3 * n_rows, int(columns[strip]), u0, u1, count, shade, stretch)
                _paint_rows(target, stretch, begin, end, top, bottom, per_row, low, n_rows - 1)
            if share >= 0.0:
                part = np.float32(share)
                for r in range(max(0, math.floor(glass_top)), ends[k]):
                    for channel in range(3):
                        image[r, channel] += part * (reflected[r, channel] - image[r, channel])


@njit(cache=True, nogil=True)
def _paint_rows(
    image: NDArray[np.float32],
    stretch: NDArray[np.float32],
    begin: int,
    end: int,
    top: float,
    bottom: float,
    per_row: float,
    low: int,
    last: int,
) -> None:
    """Rows begin to end of one column from a stretch of texels that starts at texel row `low`; linear in height."""
    for r in range(begin, end):
        v = min(max((r + 0.5 - top) * per_row - 0.5, 0.0), float(last))
        j = int(v)
        f = np.float32(v - j)
        j0 = 3 * (j - low)
        j1 = j0 + 3 if j < last else j0
        red = stretch[j0] + f * (stretch[j1] - stretch[j0])
        green = stretch[j0 + 1] + f * (stretch[j1 + 1] - stretch[j0 + 1])
        blue = stretch[j0 + 2] + f * (stretch[j1 + 2] - stretch[j0 + 2])
        if r < top or r + 1 > bottom:
            cover = np.float32(min(r + 1.0, bottom) - max(float(r), top))
            image[r, 0] += cover * (red - image[r, 0])
            image[r, 1] += cover * (green - image[r, 1])
            image[r, 2] += cover * (blue - image[r, 2])
        else:
            image[r, 0], image[r, 1], image[r, 2] = red, green, blue


@njit(cache=True, nogil=True)
def _mean_along(
    texels: NDArray[np.float32],
    start: int,
    stride: int,
    n_columns: int,
    u0: float,
    u1: float,
    count: int,
    shade: float,
    stretch: NDArray[np.float32],
) -> None:
    """Mean of `count` values of a strip over fractions u0 to u1 of its length, at least one texel, into stretch."""
    a, b = u0 * n_columns, u1 * n_columns
    if b - a < 1.0:
        a = min(max(0.5 * (a + b) - 0.5, 0.0), n_columns - 1.0)
        b = a + 1.0
    ia, ib = min(int(a), n_columns - 1), min(int(b), n_columns - 1)
    gain, base = shade / (b - a), np.float32(MIDDLE * shade)
    a1, b1 = np.float32(gain * (a - ia)), np.float32(gain * (b - ib))
    a0, b0 = np.float32(gain) - a1, np.float32(gain) - b1
    ia, ib = start + ia * stride, start + ib * stride
    left, left_next = texels[ia : ia + count], texels[ia + stride : ia + stride + count]
    right, right_next = texels[ib : ib + count], texels[ib + stride : ib + stride + count]
    for j in range(count):  # slices, so that the compiler sees plain vectors
        stretch[j] = right[j] * b0 + right_next[j] * b1 - left[j] * a0 - left_next[j] * a1 + base


@njit(cache=True, nogil=True)
def expose(
    canvas: NDArray[np.float32],
    light: float,
    noise: float,
    bank: NDArray[np.float32],
    start: int,
    out: NDArray[np.uint8],
) -> None:
    """Canvas (w, h, 3) to image (h, w, 3): times light, plus noise from the bank, rounded into 0-255."""
    width, height = canvas.shape[0], canvas.shape[1]
    gain, sigma, half = np.float32(light), np.float32(noise), np.float32(0.5)
    n = start
    for r in range(height):
        for c in range(width):
            for channel in range(3):
                value = canvas[c, r, channel] * gain + bank[n] * sigma + half
                out[r, c, channel] = np.uint8(min(max(value, np.float32(0.0)), np.float32(255.0)))
                n += 1
