"""Reads a picture as grey levels. Its size is checked before it is unpacked."""

from __future__ import annotations

import struct
import warnings
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

from sim2d.world.world_file import WorldError

PICTURES = (".pgm", ".png", ".bmp", ".jpg", ".jpeg", ".ppm", ".pbm", ".webp", ".tif", ".tiff", ".gif")
MOST_PIXELS = 16_000_000
MOST_SIDE = 12_000
_FORMATS = ("PPM", "PNG", "BMP", "JPEG", "WEBP", "TIFF", "GIF")  # PPM reads .pgm and .pbm, too


def read_picture(name: str, data: bytes, paper: int = 255) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Grey levels (rows, columns), top row first, each the mean of the three colours as they look on `paper`, a grey level;
    and where a pixel is not fully opaque. It is turned as whoever took it held the camera (EXIF).

    Raises WorldError if the data are no picture, broken, of more than 8 bits, or too large.
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
