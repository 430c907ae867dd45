"""Pictures of floor plans as worlds: light pixels are floor, dark ones are wall, those in between are outside."""

from __future__ import annotations

import math
import struct
import warnings
from io import BytesIO

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

from sim2d.importers.dress import Dresser
from sim2d.importers.map_yaml import MapYaml, Tell
from sim2d.importers.plan import plan_world
from sim2d.importers.trace import choose_floor, ring_area, simplify, trace
from sim2d.world.world import Wall, World
from sim2d.world.world_file import WorldError

PICTURES = (".pgm", ".png", ".bmp", ".jpg", ".jpeg", ".ppm", ".pbm", ".webp", ".tif", ".tiff", ".gif")
_FORMATS = ("PPM", "PNG", "BMP", "JPEG", "WEBP", "TIFF", "GIF")  # PPM reads .pgm and .pbm, too
MOST_PIXELS = 16_000_000
MOST_SIDE = 12_000
SPECK_PX = 9  # obstacles with a smaller area, in pixels, are noise
_SLIVER_PX = 3  # floor narrower than this is taken for a gap between echoes ...
_SLIVER_M = 0.3  # ... if it is also too narrow for any robot


def picture_world(
    name: str,
    data: bytes,
    about: MapYaml,
    seed: int,
    radius_m: float,
    speck_px: int = SPECK_PX,
    tell: Tell = lambda _: None,
) -> World:
    """The world that a picture shows. about: scale, origin and thresholds. Raises WorldError.

    What is transparent shows the paper beneath, which is floor, as in any viewer.
    """
    grey, veiled = read_picture(name, data, 0 if about.negate else 255)
    free = free_pixels(grey, veiled, about)[::-1]
    if veiled.any() and about.mode == "trinary":
        if free.all():
            raise WorldError(
                f"{name}: no pixel is wall: what is transparent counts as white paper, and nothing on it is dark; are its "
                "lines light, for a dark ground?"
            )
        tell(f"{name}: {veiled.mean():.0%} of it is transparent, which counts as white paper")
    if not free.any():
        raise WorldError(f"{name}: {_no_floor(grey, about)}")
    scale = about.resolution
    floor = choose_floor(name, without_slivers(free, scale), scale, radius_m)
    rings = sorted(trace(floor.mask), key=ring_area, reverse=True)
    rings = [simplify(ring) for ring in rings if ring_area(ring) > 0 or -ring_area(ring) >= speck_px]
    dresser, walls = Dresser(seed), list[Wall]()
    for ring in rings:
        thin = len(ring) == 2  # simplified to a line
        points = ring if thin else np.concatenate([ring, ring[:1]])
        walls += dresser.line(_placed(points, about), "both" if thin else "left", outer=ring is rings[0])
    starts = np.column_stack([_placed(floor.starts[:, :2], about), floor.starts[:, 2] + about.origin[2]])
    return plan_world(name, tuple(walls), starts, f"a picture of {free.shape[1]} x {free.shape[0]} pixels", radius_m)


def free_pixels(grey: NDArray[np.uint8], veiled: NDArray[np.bool_], about: MapYaml) -> NDArray[np.bool_]:
    """Which pixels are floor, by the rules of map_server. veiled: not fully opaque; unknown in mode `scale`."""
    if about.mode == "raw":  # the pixel is the occupancy in per cent; above 100 it is unknown
        return (grey <= 100) & (grey / 100.0 < about.free)
    occupied = (grey if about.negate else 255 - grey.astype(np.float64)) / 255.0
    free = occupied < about.free
    return free & ~veiled if about.mode == "scale" else free


def _no_floor(grey: NDArray[np.uint8], about: MapYaml) -> str:
    clear = grey if about.mode == "raw" or about.negate else 255 - grey
    row, column = np.unravel_index(np.argmin(clear), clear.shape)
    rule = "below" if about.mode == "raw" else f"{'dark' if about.negate else 'light'}, with an occupancy below"
    return (
        f"no pixel is floor: the nearest to it, in column {column} of row {row}, has grey {grey[row, column]}; floor is "
        f"{rule} {about.free:g}"
    )


def without_slivers(free: NDArray[np.bool_], scale_m: float) -> NDArray[np.bool_]:
    """Remove floor that is at most two pixels wide: rays of a scanner through a window, gaps in a pitted wall."""
    if (_SLIVER_PX - 1) * scale_m > _SLIVER_M:
        return free
    kernel = np.ones((_SLIVER_PX, _SLIVER_PX), np.uint8)
    padded = np.pad(free, _SLIVER_PX).astype(np.uint8)
    opened = cv2.morphologyEx(padded, cv2.MORPH_OPEN, kernel)
    return opened[_SLIVER_PX:-_SLIVER_PX, _SLIVER_PX:-_SLIVER_PX].astype(np.bool_)


def _placed(pixels: NDArray[np.generic], about: MapYaml) -> NDArray[np.float64]:
    """From pixels (k, 2), counted from the lower left corner, to metres, rounded to the millimetre."""
    x, y, yaw = about.origin
    c, s = math.cos(yaw), math.sin(yaw)
    metres = pixels.astype(np.float64) * about.resolution
    right, up = metres[:, 0], metres[:, 1]
    return np.round(np.column_stack([x + c * right - s * up, y + s * right + c * up]), 3)


def read_picture(name: str, data: bytes, paper: int = 255) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Grey levels (rows, columns), top row first, each the mean of the three colours as they look on `paper`, a grey level;
    and where a pixel is not fully opaque. It is turned as whoever took it held the camera (EXIF).

    Raises WorldError if the data are no picture, broken, of more than 8 bits, or too large. Their size is checked before they
    are unpacked.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our own limit is far below Pillow's
            picture = Image.open(BytesIO(data), formats=_FORMATS)
        width, height = picture.size
        if max(width, height) > MOST_SIDE or width * height > MOST_PIXELS:
            raise WorldError(
                f"{name}: {width} x {height} pixels; at most {MOST_PIXELS / 1e6:g} million, {MOST_SIDE} a side"
            )
        if picture.mode.startswith(("I", "F")):
            raise WorldError(f"{name}: more than 8 bits a pixel (mode {picture.mode}); save it with 8, 0 to 255")
        rgba = np.asarray(_opaque_or_not(ImageOps.exif_transpose(picture)))
    except UnidentifiedImageError:
        raise WorldError(
            f"{name}: not a picture that can be read; expected PGM, PNG, BMP, JPEG, WebP, TIFF or GIF"
        ) from None
    except WorldError:
        raise
    except Image.DecompressionBombError:
        raise WorldError(f"{name}: hundreds of millions of pixels; at most {MOST_PIXELS / 1e6:g} million") from None
    except (OSError, ValueError, SyntaxError, TypeError, LookupError, EOFError, struct.error) as error:
        raise WorldError(f"{name}: the picture is broken: {error}") from None
    grey, veiled = rgba[:, :, :3].astype(np.uint16).sum(axis=2) / 3.0, rgba[:, :, 3] < 255
    if veiled.any():
        share = rgba[:, :, 3] / 255.0
        grey = share * grey + (1.0 - share) * paper
    return np.rint(grey).astype(np.uint8), veiled


def _opaque_or_not(picture: Image.Image) -> Image.Image:
    """As RGBA, of whatever colours."""
    if "A" in picture.mode or "a" in picture.mode or "transparency" in picture.info or picture.mode in ("P", "L", "1"):
        return picture.convert("RGBA")
    return picture.convert("RGB").convert("RGBA")
