"""Turns the walls that each column meets into an image: textures, shading by distance and direction, reflections, noise."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.camera.atlas import LEVELS, MIDDLE
from sim2d.camera.sight import MAX_HITS
from sim2d.geometry.wall_index import WallIndex, crossing, first_wall

_OFF_M = 1e-6  # so far from a pane begins the ray that it reflects
_MAX_ROWS = 1024
ONE, TWO, THREE = np.uint64(1), np.uint64(2), np.uint64(3)  # an unsigned index needs no check for negative values


class Strips(NamedTuple):
    """The looks of a camera's walls: the arrays of `Atlas`, bottom and top of each wall (m), the shade of each side."""

    texels: NDArray[np.float32]
    first: NDArray[np.int64]
    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    bottoms: NDArray[np.float64]
    tops: NDArray[np.float64]
    shades: NDArray[np.float64]
    reflection: NDArray[np.float64]  # -1 where it is no glass


@njit(cache=True, nogil=True)
def mirrored(
    index: WallIndex,
    segments: NDArray[np.float64],
    elements: NDArray[np.int64],
    glass: NDArray[np.bool_],
    x: float,
    y: float,
    heading: float,
    rays: NDArray[np.float64],
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
    at: NDArray[np.int64],
    strips: NDArray[np.int64],
    found: NDArray[np.float64],
) -> None:
    """Reflections in glass: for each column, which of its hits is its nearest pane (`at`, -1: none), and what is seen in it.

    A column's ray is reflected at the pane and followed to the first thing it meets. elements: numbers of the actors' sides
    that are present. strips: (w,) the strip that the reflected ray meets, -1: none. found: (w, 3) as one row of hits; its
    inverse distance is that of the whole way.
    """
    cos, sin = math.cos(heading), math.sin(heading)
    for c in range(counts.size):
        at[c], strips[c] = -1, -1
        for k in range(counts[c]):
            pane = walls[c, k] >> 1
            if not glass[pane]:
                continue
            ux, uy = rays[c, 0, 0] * cos - rays[c, 0, 1] * sin, rays[c, 0, 0] * sin + rays[c, 0, 1] * cos
            ex, ey = segments[pane, 2] - segments[pane, 0], segments[pane, 3] - segments[pane, 1]
            scale = 2.0 * (ux * ex + uy * ey) / (ex * ex + ey * ey)
            vx, vy = scale * ex - ux, scale * ey - uy  # reflected at the pane, of the same length
            t = 1.0 / hits[c, k, 0]
            px, py = x + t * ux + _OFF_M * vx, y + t * uy + _OFF_M * vy
            best, shortest, along = first_wall(index, px, py, vx, vy, 1e6)
            for i in elements:
                d, s = crossing(segments, i, px, py, vx, vy)
                if d < shortest:
                    best, shortest, along = i, d, s
            at[c] = k
            if best >= 0:
                ax, ay = segments[best, 0] - px, segments[best, 1] - py
                bx, by = segments[best, 2] - px, segments[best, 3] - py
                strips[c] = 2 * best + (0 if ax * by - ay * bx > 0.0 else 1)
                found[c, 0], found[c, 1], found[c, 2] = 1.0 / (t + shortest), along, along
            break


@njit(cache=True, nogil=True)
def paint_columns(
    strips: Strips,
    eye: float,
    focal: float,
    fade: float,
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
    """Fill canvas (w, 3 h) from the hits of `column_hits`, far to near. A pixel that a wall covers in part is blended.

    A column holds red, green and blue of each pixel, from the top down. fade: depth (m) at which brightness has fallen to
    a half. glow: (w, k + 1) brightness of each hit, then of floor and ceiling. panes, mirror_strips, mirror_hits: from
    `mirrored`.
    """
    texels, first, columns, rows = strips.texels, strips.first, strips.columns, strips.rows
    bottoms, tops, shades, reflection = strips.bottoms, strips.tops, strips.shades, strips.reflection
    height = canvas.shape[1] // 3
    stretch = np.empty(3 * _MAX_ROWS, np.float32)
    ends = np.empty(MAX_HITS, np.int64)
    reflected = np.empty(3 * height, np.float32)
    for c in range(canvas.shape[0]):
        image = canvas[c]
        around = np.float32(glow[c, glow.shape[1] - 1])
        for n in range(image.size):
            image[n] = background[n] * around
        _hide(strips, eye, focal, height, counts[c], walls[c], hits[c], ends)
        for k in range(counts[c] - 1, -1, -1):
            strip, inverse, u0, u1, end = walls[c, k], hits[c, k, 0], hits[c, k, 1], hits[c, k, 2], ends[k]
            share, glass_top, target = reflection[strip >> 1], 0.0, image
            if share >= 0.0:  # glass: its reflection, or its own colour, is blended over what is behind it
                target = reflected
                by = np.float32(1.0)
                glass_top = 0.5 * height - (tops[strip >> 1] - eye) * focal * inverse
                if panes[c] == k and mirror_strips[c] >= 0:
                    strip, end = mirror_strips[c], height
                    inverse, u0, u1 = mirror_hits[c, 0], mirror_hits[c, 1], mirror_hits[c, 2]
                    by = around
                for n in range(target.size):
                    target[n] = background[n] * by
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
                shade = shades[strip] / (1.0 + 1.0 / (inverse * fade)) * glow[c, k]
                start = first[strip, level] + 3 * low
                count = 3 * (high - low)
                _mean_along(texels, start, 3 * n_rows, int(columns[strip]), u0, u1, count, shade, stretch)
                _paint_rows(target, stretch, begin, end, top, bottom, per_row, low, n_rows - 1)
            if share >= 0.0:
                part = np.float32(share)
                for n in range(3 * max(0, math.floor(glass_top)), 3 * ends[k]):
                    image[n] += part * (reflected[n] - image[n])


@njit(cache=True, nogil=True)
def _hide(
    strips: Strips,
    eye: float,
    focal: float,
    height: int,
    count: int,
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
    ends: NDArray[np.int64],
) -> None:
    """The row at which each wall of a column ends: a wall that stands on the floor hides, of those behind it,
    everything below its own top."""
    hidden = height
    for k in range(count):
        wall = walls[k] >> 1
        ends[k] = min(hidden, math.ceil(0.5 * height - (strips.bottoms[wall] - eye) * focal * hits[k, 0]))
        if strips.bottoms[wall] == 0.0 and strips.reflection[wall] < 0.0:
            hidden = min(hidden, max(0, math.ceil(0.5 * height - (strips.tops[wall] - eye) * focal * hits[k, 0])))


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
    """Fill `stretch` with `count` values of a strip: the mean over fractions u0 to u1 of its length."""
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
    for j in range(count):  # over slices, so that the compiler can vectorise
        stretch[j] = right[j] * b0 + right_next[j] * b1 - left[j] * a0 - left_next[j] * a1 + base


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
    """Paint rows begin to end of one column from texels that start at texel row `low`; linear in height."""
    whole, beyond = begin + (begin < top), end - (end > bottom)  # the rows that the wall covers from edge to edge
    if whole > begin:
        _blend(image[3 * begin :], stretch, begin, top, bottom, per_row, low, last)
    if beyond < end and end - 1 > begin - (whole == begin):
        _blend(image[3 * (end - 1) :], stretch, end - 1, top, bottom, per_row, low, last)
    out = image[3 * whole : 3 * max(whole, beyond)]
    at = np.uint64(0)
    for r in range(whole, beyond):
        v = min(max((r + 0.5 - top) * per_row - 0.5, 0.0), float(last))
        j = int(v)
        f = np.float32(v - j)
        j0 = np.uint64(3 * (j - low))
        j1 = j0 + THREE if j < last else j0
        out[at] = stretch[j0] + f * (stretch[j1] - stretch[j0])
        out[at + ONE] = stretch[j0 + ONE] + f * (stretch[j1 + ONE] - stretch[j0 + ONE])
        out[at + TWO] = stretch[j0 + TWO] + f * (stretch[j1 + TWO] - stretch[j0 + TWO])
        at += THREE


@njit(cache=True, nogil=True)
def _blend(
    pixel: NDArray[np.float32],
    stretch: NDArray[np.float32],
    r: int,
    top: float,
    bottom: float,
    per_row: float,
    low: int,
    last: int,
) -> None:
    """Paint row r, in which the wall begins or ends, blended with what is behind by the share that the wall covers."""
    v = min(max((r + 0.5 - top) * per_row - 0.5, 0.0), float(last))
    j = int(v)
    f = np.float32(v - j)
    j0 = 3 * (j - low)
    j1 = j0 + 3 if j < last else j0
    cover = np.float32(min(r + 1.0, bottom) - max(float(r), top))
    for channel in range(3):
        colour = stretch[j0 + channel] + f * (stretch[j1 + channel] - stretch[j0 + channel])
        pixel[channel] += cover * (colour - pixel[channel])


@njit(cache=True, nogil=True)
def expose(
    canvas: NDArray[np.float32],
    light: float,
    noise: float,
    bank: NDArray[np.float32],
    start: int,
    out: NDArray[np.uint8],
) -> None:
    """From canvas (w, 3 h) to image (h, w, 3): times light, plus noise from the bank, rounded into 0-255."""
    width, height = canvas.shape[0], canvas.shape[1] // 3
    gain, sigma, half = np.float32(light), np.float32(noise), np.float32(0.5)
    row = np.empty(3 * width, np.float32)
    flat = out.reshape(height, 3 * width)
    for r in range(height):
        for c in range(width):  # transposed first, so that the compiler can vectorise below
            for channel in range(3):
                row[3 * c + channel] = canvas[c, 3 * r + channel]
        first = start + 3 * width * r
        errors, line = bank[first : first + 3 * width], flat[r]
        for k in range(3 * width):
            value = row[k] * gain + errors[k] * sigma + half
            line[k] = np.uint8(min(max(value, np.float32(0.0)), np.float32(255.0)))
