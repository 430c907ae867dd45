"""Everything flat in the scene, drawn with Pillow: text, pills, sheets, floors with their shadows, the sky.

Arrays are (height, width, 3 or 4) uint8 with the first row at the top; `upright` turns them for viser's scene.
"""

from __future__ import annotations

import io
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter, ImageFont

from web.viewer.primitives.palette import Rgb

Pixels = NDArray[np.uint8]
_FONTS = Path(__file__).parent / "fonts"


def upright(image: Pixels) -> Pixels:
    """The image as `scene.add_image` needs it, since our camera shows images upside down."""
    return np.ascontiguousarray(image[::-1])


def png(image: Pixels) -> bytes:
    """The image as a file."""
    file = io.BytesIO()
    Image.fromarray(image).save(file, "png")
    return file.getvalue()


@lru_cache(maxsize=16)
def font(size_px: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(_FONTS / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"), size_px)


@lru_cache(maxsize=256)
def text(words: str, colour: Rgb, size_px: int = 48, bold: bool = False) -> Pixels:
    """`words` on a transparent ground, RGBA. The height depends on the size alone, so that lines of equal size align."""
    face = font(size_px, bold)
    width = max(1, round(face.getlength(words)) + 2)
    image = Image.new("RGBA", (width, round(size_px * 1.3)), (*colour, 0))
    ImageDraw.Draw(image).text((1, size_px * 1.02), words, font=face, fill=(*colour, 255), anchor="ls")
    return np.asarray(image)


@lru_cache(maxsize=256)
def plaque(words: str, ink: Rgb, fill: Rgb, size_px: int = 48) -> Pixels:
    """`words` on a rounded ground, RGBA."""
    face = font(size_px, True)
    height = round(size_px * 1.55)
    width = round(face.getlength(words)) + height
    image = Image.new("RGBA", (width, height), (*fill, 0))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle((0, 0, width - 1, height - 1), height / 2, fill=(*fill, 255), outline=(*ink, 255), width=2)
    draw.text((width / 2, height / 2), words, font=face, fill=(*ink, 255), anchor="mm")
    return np.asarray(image)


def sky(top: Rgb, bottom: Rgb) -> Pixels:
    """The background: a gradient."""
    ramp = np.linspace(0, 1, 720)[:, None, None] * (np.array(bottom) - top) + np.array(top)
    return np.rint(np.repeat(ramp, 8, 1)).astype(np.uint8)


def gridded_floor(size_m: tuple[float, float], px_per_m: float, floor: Rgb, grid: Rgb, step_m: float = 1.0) -> Pixels:
    """A floor with a line every `step_m`, from its lower left corner."""
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
    floor: Pixels,
    segments_px: NDArray[np.float64],
    polygons_px: list[NDArray[np.float64]],
    reach_px: float,
    share: float,
) -> Pixels:
    """The floor, darker near segments (n, 4) and inside polygons (k, 2), as a cue for depth."""
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
    """The bar of the colour scale, from near to far."""
    return np.repeat(ramp[None], height_px, 0)


def tint(canvas: Pixels, corners: NDArray[np.float64], colour: Rgb, share: float) -> Pixels:
    """The canvas with a colour laid over a polygon (n, 2) of pixels."""
    mask = Image.new("L", canvas.shape[1::-1], 0)
    ImageDraw.Draw(mask).polygon([(float(x), float(y)) for x, y in corners], fill=255)
    weight = np.asarray(mask, np.float64)[..., None] / 255 * share
    return (canvas * (1 - weight) + np.array(colour) * weight).astype(np.uint8)


def paste(canvas: Pixels, image: Pixels, left: int, top: int) -> None:
    """Lays RGB or RGBA onto an RGB canvas, in place, cut off at its edges."""
    height, width = min(image.shape[0], canvas.shape[0] - top), min(image.shape[1], canvas.shape[1] - left)
    part, target = image[:height, :width], canvas[top : top + height, left : left + width]
    if part.shape[2] == 3:
        target[:] = part
        return
    alpha = part[..., 3:].astype(np.uint16)
    target[:] = ((part[..., :3] * alpha + target * (255 - alpha)) // 255).astype(np.uint8)
