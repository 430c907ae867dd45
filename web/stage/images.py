"""Everything flat on the stage, drawn through Pillow: text, pills, sheets, floors with their shadows, the sky.

Arrays are (height, width, 3 or 4) uint8 with the first row at the top; `upright` turns them for viser's scene.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter, ImageFont

from web.stage.palette import Rgb

Pixels = NDArray[np.uint8]
_FONTS = Path(__file__).parent / "fonts"
_SIDE = 40  # pixels of padding inside a pill, at 100 px letters


def upright(image: Pixels) -> Pixels:
    """The image as `scene.add_image` must be given it: this camera shows it upside down."""
    return np.ascontiguousarray(image[::-1])


@lru_cache(maxsize=16)
def font(size_px: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(_FONTS / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"), size_px)


@lru_cache(maxsize=256)
def text(words: str, colour: Rgb, size_px: int = 48, bold: bool = False) -> Pixels:
    """`words` on nothing, RGBA; the height depends on the size alone, so that lines of equal size align."""
    face = font(size_px, bold)
    width = max(1, round(face.getlength(words)) + 2)
    image = Image.new("RGBA", (width, round(size_px * 1.3)), (*colour, 0))
    ImageDraw.Draw(image).text((1, size_px * 1.02), words, font=face, fill=(*colour, 255), anchor="ls")
    return np.asarray(image)


@lru_cache(maxsize=256)
def pill(words: str, fill: Rgb, ink: Rgb, rim: Rgb | None = None) -> Pixels:
    """`words` on a rounded bar, RGBA, 140 px high."""
    face = font(84, True)
    width, height = max(140, round(face.getlength(words)) + 2 * _SIDE), 140
    image = Image.new("RGBA", (width * 2, height * 2), (*(rim or fill), 0))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle((0, 0, width * 2 - 1, height * 2 - 1), height, fill=(*(rim or fill), 255))
    if rim is not None:
        draw.rounded_rectangle((10, 10, width * 2 - 11, height * 2 - 11), height - 10, fill=(*fill, 255))
    image = image.resize((width, height), Image.Resampling.LANCZOS)
    ImageDraw.Draw(image).text((width / 2, height / 2 + 2), words, font=face, fill=(*ink, 255), anchor="mm")
    return np.asarray(image)


def sky(top: Rgb, bottom: Rgb) -> Pixels:
    """The background: a gradient with a little noise against banding."""
    ramp = np.linspace(0, 1, 360)[:, None, None] * (np.array(bottom) - top) + np.array(top)
    noise = np.random.default_rng(0).uniform(-0.6, 0.6, (360, 64, 1))
    return np.clip(np.rint(ramp + noise), 0, 255).astype(np.uint8)


def gridded_floor(size_m: tuple[float, float], px_per_m: float, floor: Rgb, grid: Rgb, step_m: float = 1.0) -> Pixels:
    """A floor with a line each `step_m`, from its lower left corner."""
    width, height = (max(2, round(s * px_per_m)) for s in size_m)
    image = Image.new("RGB", (width, height), floor)
    draw = ImageDraw.Draw(image)
    line = max(1, round(px_per_m * 0.025))
    for k in range(1, int(size_m[0] / step_m - 1e-6) + 1):
        draw.line((k * step_m * px_per_m, 0, k * step_m * px_per_m, height), fill=grid, width=line)
    for k in range(1, int(size_m[1] / step_m - 1e-6) + 1):
        draw.line((0, height - k * step_m * px_per_m, width, height - k * step_m * px_per_m), fill=grid, width=line)
    return np.asarray(image)


def contact_shadow(
    floor: Pixels, segments_px: NDArray[np.float64], polygons_px: list[NDArray[np.float64]], reach_px: float, share: float
) -> Pixels:
    """The floor, darker near segments (n, 4) and inside polygons (k, 2): the depth cue."""
    height, width = floor.shape[:2]
    mask = Image.new("L", (width, height), 0)
    draw = ImageDraw.Draw(mask)
    for x1, y1, x2, y2 in segments_px:
        draw.line((x1, y1, x2, y2), fill=255, width=max(2, round(reach_px * 0.7)))
    for corners in polygons_px:
        draw.polygon([(float(x), float(y)) for x, y in corners], fill=255)
    soft = mask.filter(ImageFilter.GaussianBlur(reach_px))
    near = mask.filter(ImageFilter.GaussianBlur(reach_px / 3))
    weight = np.asarray(ImageChops.lighter(soft, near), np.float64)[..., None] / 255 * share
    return (floor * (1 - weight)).astype(np.uint8)


def colour_bar(ramp: NDArray[np.uint8], height_px: int = 22) -> Pixels:
    """The colour scale, from near to far."""
    return np.repeat(ramp[None], height_px, 0)


def bleed(image: Pixels, margin: int = 4) -> Pixels:
    """RGBA with `margin` clear pixels around, so that filtered edges stay soft."""
    height, width = image.shape[:2]
    out = np.zeros((height + 2 * margin, width + 2 * margin, 4), np.uint8)
    out[..., :3] = image[0, 0, :3]
    out[margin:-margin, margin:-margin] = image
    return out


def nearest(image: Pixels, size_hw: tuple[int, int]) -> Pixels:
    """Grey or colour, enlarged without smoothing, as RGB."""
    rows = (np.arange(size_hw[0]) * image.shape[0]) // size_hw[0]
    columns = (np.arange(size_hw[1]) * image.shape[1]) // size_hw[1]
    large = image[rows[:, None], columns]
    return np.repeat(large[..., None], 3, -1) if large.ndim == 2 else large


def paste(canvas: Pixels, image: Pixels, left: int, top: int) -> None:
    """Lays RGB or RGBA onto an RGB canvas, in place, cut off at its edges."""
    height, width = min(image.shape[0], canvas.shape[0] - top), min(image.shape[1], canvas.shape[1] - left)
    part, target = image[:height, :width], canvas[top : top + height, left : left + width]
    if part.shape[2] == 3:
        target[:] = part
        return
    alpha = part[..., 3:].astype(np.uint16)
    target[:] = ((part[..., :3] * alpha + target * (255 - alpha)) // 255).astype(np.uint8)


def write(canvas: Pixels, words: str, colour: Rgb, left: int, top: int, size_px: int = 24, bold: bool = False) -> None:
    paste(canvas, text(words, colour, size_px, bold), left, top)


