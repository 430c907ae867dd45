"""The robot's camera: which walls each column of the image meets, and what they look like there.

A wall's inverse depth, and its position along itself over depth, are linear across the image. So walls are put in camera
coordinates once and every column finds its hits by interpolation: 2.5-D, no ray per pixel. Low walls (desks, partitions)
do not hide high ones, therefore a column keeps its nearest hits up to the first wall of full height and paints them
from far to near.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.atlas import LEVELS, MIDDLE, build_atlas
from sim2d.params import SimParams
from sim2d.world import World

MAX_HITS = 8
NEAR_M = 0.02
FADE_M = 14.0  # brightness falls as 1 / (1 + depth / FADE_M): far corners are darker
_NOISE_BANK = 1 << 17


class Camera:
    """Draws what is seen from a pose. Owns buffers; nothing of it depends on earlier images."""

    def __init__(self, world: World, params: SimParams, rng: np.random.Generator) -> None:
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
        # Drawing 9216 normal deviates takes longer than the whole image: draw many once, start anywhere in them.
        self._noise = rng.standard_normal(_NOISE_BANK + 3 * self._width * self._height).astype(np.float32)
        self._counts = np.zeros(self._width, np.int64)
        self._walls = np.zeros((self._width, MAX_HITS), np.int64)
        self._hits = np.zeros((self._width, MAX_HITS, 3))
        self._canvas = np.zeros((self._width, self._height, 3), np.float32)

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


@njit(cache=True, nogil=True)
def column_hits(
    segments: NDArray[np.float64],
    full: NDArray[np.bool_],
    x: float,
    y: float,
    heading: float,
    focal: float,
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
) -> None:
    """For each column the walls on its middle ray, near to far, none behind the first full one.

    counts: (w,) how many. walls: (w, k) their strips (2 i + side). hits: (w, k, 3) inverse depth 1/m, and the stretch
    of the wall that the column covers, from its left to its right edge, as fractions of the wall's length.
    """
    width = counts.size
    cos, sin = math.cos(heading), math.sin(heading)
    counts[:] = 0
    for i in range(segments.shape[0]):
        ax, ay = segments[i, 0] - x, segments[i, 1] - y
        bx, by = segments[i, 2] - x, segments[i, 3] - y
        za, zb = ax * cos + ay * sin, bx * cos + by * sin  # depth
        if za < NEAR_M and zb < NEAR_M:
            continue
        la, lb = -ax * sin + ay * cos, -bx * sin + by * cos  # to the left
        side = 0 if ax * by - ay * bx > 0.0 else 1
        ua, ub = 0.0, 1.0
        if za < NEAR_M:
            ua = (NEAR_M - za) / (zb - za)
            la, za = la + ua * (lb - la), NEAR_M
        elif zb < NEAR_M:
            ub = (NEAR_M - za) / (zb - za)
            lb, zb = la + ub * (lb - la), NEAR_M
        sa, sb = 0.5 * width - focal * la / za, 0.5 * width - focal * lb / zb
        wa, wb = 1.0 / za, 1.0 / zb
        pa, pb = ua * wa, ub * wb  # position over depth
        if sa > sb:
            sa, sb, wa, wb, pa, pb = sb, sa, wb, wa, pb, pa
        begin = max(0, math.ceil(sa - 0.5))
        end = min(width, math.ceil(sb - 0.5))
        if begin >= end:
            continue
        dw, dp = (wb - wa) / (sb - sa), (pb - pa) / (sb - sa)
        for c in range(begin, end):
            inverse = wa + (c + 0.5 - sa) * dw
            n = counts[c]
            if n > 0 and hits[c, n - 1, 0] >= inverse and (n == MAX_HITS or full[walls[c, n - 1] >> 1]):
                continue
            left, right = max(c - sa, 0.0), min(c + 1.0, sb) - sa
            u0 = (pa + left * dp) / (wa + left * dw)
            u1 = (pa + right * dp) / (wa + right * dw)
            k = min(n, MAX_HITS - 1)
            while k > 0 and hits[c, k - 1, 0] < inverse:
                walls[c, k] = walls[c, k - 1]
                hits[c, k] = hits[c, k - 1]
                k -= 1
            walls[c, k] = 2 * i + side
            hits[c, k, 0], hits[c, k, 1], hits[c, k, 2] = inverse, min(u0, u1), max(u0, u1)
            counts[c] = k + 1 if full[i] else min(n + 1, MAX_HITS)


@njit(cache=True, nogil=True)
def paint_columns(
    texels: NDArray[np.float32],
    first: NDArray[np.int64],
    columns: NDArray[np.int64],
    rows: NDArray[np.int64],
    bottoms: NDArray[np.float64],
    tops: NDArray[np.float64],
    shades: NDArray[np.float64],
    eye: float,
    focal: float,
    background: NDArray[np.float32],
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
    canvas: NDArray[np.float32],
) -> None:
    """Fill canvas (w, h, 3) from the hits of `column_hits`, far to near; edges are blended by the share they cover."""
    height = canvas.shape[1]
    stretch = np.empty(3 * 512, np.float32)
    for c in range(canvas.shape[0]):
        canvas[c] = background
        for k in range(counts[c] - 1, -1, -1):
            strip, inverse = walls[c, k], hits[c, k, 0]
            wall = strip >> 1
            scale = focal * inverse  # pixels a metre
            top = 0.5 * height - (tops[wall] - eye) * scale
            bottom = 0.5 * height - (bottoms[wall] - eye) * scale
            begin, end = max(0, math.floor(top)), min(height, math.ceil(bottom))
            if begin >= end:
                continue
            per_row = rows[strip] / (bottom - top)  # texels a pixel
            level = 0
            while level < LEVELS - 1 and per_row > 1.5:
                level += 1
                per_row *= 0.5
            n_rows = rows[strip] >> level
            low = max(0, math.floor((begin - top) * per_row - 0.5))
            high = min(n_rows, math.ceil((end - top) * per_row + 0.5) + 1)
            shade = shades[strip] / (1.0 + 1.0 / (inverse * FADE_M))
            _mean_along(
                texels,
                first[strip, level],
                columns[strip],
                n_rows,
                hits[c, k, 1],
                hits[c, k, 2],
                low,
                high,
                shade,
                stretch,
            )
            for r in range(begin, end):
                v = (r + 0.5 - top) * per_row - 0.5
                v = min(max(v, 0.0), n_rows - 1.0)
                j = int(v)
                f = np.float32(v - j)
                j0 = 3 * (j - low)
                j1 = min(j0 + 3, 3 * (n_rows - 1 - low))
                cover = np.float32(min(r + 1.0, bottom) - max(float(r), top))
                for channel in range(3):
                    value = stretch[j0 + channel] * (np.float32(1.0) - f) + stretch[j1 + channel] * f
                    behind = canvas[c, r, channel]
                    canvas[c, r, channel] = behind + cover * (value - behind)


@njit(cache=True, nogil=True)
def _mean_along(
    texels: NDArray[np.float32],
    start: int,
    n_columns: int,
    n_rows: int,
    u0: float,
    u1: float,
    low: int,
    high: int,
    shade: float,
    stretch: NDArray[np.float32],
) -> None:
    """Mean of a strip from fraction u0 to u1 of its length, rows low to high, into stretch; at least one texel wide."""
    a, b = u0 * n_columns, u1 * n_columns
    if b - a < 1.0:
        a = min(max(0.5 * (a + b) - 0.5, 0.0), n_columns - 1.0)
        b = a + 1.0
    ia, ib = min(int(a), n_columns - 1), min(int(b), n_columns - 1)
    fa, fb = np.float32(a - ia), np.float32(b - ib)
    one = np.float32(1.0)
    gain = np.float32(shade / (b - a))
    base = np.float32(MIDDLE * shade)
    stride = 3 * n_rows
    a0, b0 = start + ia * stride + 3 * low, start + ib * stride + 3 * low
    for j in range(3 * (high - low)):
        from_a = texels[a0 + j] * (one - fa) + texels[a0 + stride + j] * fa
        from_b = texels[b0 + j] * (one - fb) + texels[b0 + stride + j] * fb
        stretch[j] = (from_b - from_a) * gain + base


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
