"""Unpacks pictures. Their size is checked before, and a picture that is not whole is refused."""

from __future__ import annotations

import os
import re
import stat
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

PICTURES = (".jpg", ".jpeg", ".png", ".bmp", ".pgm", ".ppm", ".webp")
MOST_PIXELS, MOST_SIDE, MOST_BYTES = 20_000_000, 12_000, 64_000_000
_FORMATS = ("JPEG", "PNG", "BMP", "PPM", "WEBP", "TIFF")
_DEEP = ("I;16", "I;16B", "I;16L", "I;16N")
_VIDEO = re.compile(r"h\.?26[45]|hevc|avc|av1|vp[89]|theora|mpeg", re.IGNORECASE)


def unpacked(data: bytes, told: str = "") -> NDArray[np.uint8]:
    """A JPEG, PNG, ... as RGB, (h, w, 3); of 16 bits grey the upper 8. ValueError: it is none, broken, or too large.

    told: what whoever packed it says that it is.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # our own limit is far below Pillow's
            picture = Image.open(BytesIO(data), formats=_FORMATS)
            require_size(*picture.size)
            if picture.mode in _DEEP:
                return np.repeat((np.asarray(picture, np.uint16) >> 8).astype(np.uint8)[:, :, None], 3, axis=2)
            if picture.mode.startswith(("I", "F")):
                raise ValueError(f"a picture of more than 16 bits a pixel (mode {picture.mode}); 8 and 16 are read")
            return np.asarray(picture.convert("RGB"))
    except UnidentifiedImageError:
        raise ValueError(_no_picture(data, told)) from None
    except Image.DecompressionBombError:
        raise ValueError(f"hundreds of millions of pixels; at most {MOST_PIXELS / 1e6:g} million") from None
    except (OSError, SyntaxError, IndexError, TypeError, EOFError) as error:
        raise ValueError(f"the picture is broken: {error}") from None


def _no_picture(data: bytes, told: str) -> str:
    wanted = "expected JPEG, PNG, BMP, PPM, TIFF or WebP"
    said = f", said to be {told[:40]!r}" if told else ""
    if _VIDEO.search(told) or data.startswith((b"\0\0\0\1", b"\0\0\1")):
        return f"a piece of a video{said or ' (H.264 or the like)'}, not a picture that stands alone; {wanted}"
    return f"not a picture that can be read{said}; {wanted}"


def require_size(width: int, height: int) -> None:
    if not (0 < width <= MOST_SIDE and 0 < height <= MOST_SIDE and width * height <= MOST_PIXELS):
        raise ValueError(
            f"a picture of {width} x {height} pixels; at most {MOST_PIXELS / 1e6:g} million, {MOST_SIDE} a side"
        )


def read_picture(path: Path) -> NDArray[np.uint8]:
    """The picture in a file, RGB. ValueError: it cannot be read."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # a pipe would never answer
        with os.fdopen(handle, "rb") as file:
            about = os.fstat(handle)
            if not stat.S_ISREG(about.st_mode):
                raise ValueError("not a file")
            if about.st_size > MOST_BYTES:
                raise ValueError(f"{about.st_size} bytes; a picture has at most {MOST_BYTES}")
            return unpacked(file.read())
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror or error}") from None


def within(folder: Path, name: str) -> Path:
    """The path of a file that a recording names, in its folder. ValueError: it would lead out of it."""
    if not name or "\0" in name or len(name) > 1000:
        raise ValueError(f"{name[:80]!r} is no file's name")
    try:
        path, home = (folder / name.replace("\\", "/")).resolve(), folder.resolve()
    except (OSError, RuntimeError):
        raise ValueError(f"{name[:80]!r} cannot be followed") from None
    if not path.is_relative_to(home):
        raise ValueError(f"{name[:80]!r} leads out of the recording's folder")
    return path


def beside(folder: Path, name: str) -> Path:
    """The file of this name in a folder or in its `images`; of a path of another machine, that of its last part. ValueError:
    it would lead out of the folder."""
    bare = name.replace("\\", "/").rsplit("/", 1)[-1]
    for each in (name, f"images/{name}", bare, f"images/{bare}"):
        try:
            if (path := within(folder, each)).exists():
                return path
        except ValueError:
            continue
    return within(folder, name)
