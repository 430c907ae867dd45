"""Raw pictures as cameras and drivers of ROS send them, by the names of sensor_msgs/image_encodings and usb_cam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.pictures import require_size

Pixels = NDArray[Any]  # of 8 or 16 bits


@dataclass(frozen=True, slots=True)
class _Layout:
    """How pixels lie in memory, and what OpenCV makes RGB of them with."""

    channels: int
    code: int | None  # None: they are RGB
    depth: int = 8  # bits of each channel
    rows: tuple[int, int] = (
        1,
        1,
    )  # of memory for so many rows of the picture: planes of colour come after the grey one


def _layouts() -> dict[str, _Layout]:
    found = {
        "rgb": _Layout(3, None), "bgr": _Layout(3, cv2.COLOR_BGR2RGB), "rgba": _Layout(4, cv2.COLOR_RGBA2RGB),
        "bgra": _Layout(4, cv2.COLOR_BGRA2RGB), "mono": _Layout(1, cv2.COLOR_GRAY2RGB),
    }  # fmt: skip
    for pattern in ("rggb", "bggr", "gbrg", "grbg"):
        found[f"bayer_{pattern}"] = _Layout(1, getattr(cv2, f"COLOR_Bayer{pattern.upper()}2RGB"))
    layouts = {
        f"{name}{depth}": _Layout(it.channels, it.code, depth) for name, it in found.items() for depth in (8, 16)
    }
    for depth in (8, 16):
        of_type = {1: "mono", 3: "bgr", 4: "bgra"}  # as cv_bridge takes pictures that say their type alone
        layouts |= {f"{depth}uc{n}": layouts[f"{name}{depth}"] for n, name in of_type.items()}
    uyvy, yuyv = _Layout(2, cv2.COLOR_YUV2RGB_UYVY), _Layout(2, cv2.COLOR_YUV2RGB_YUYV)
    layouts |= dict.fromkeys(("yuv422", "uyvy", "uyvy8", "yuv422_uyvy"), uyvy)
    layouts |= dict.fromkeys(("yuv422_yuy2", "yuy2", "yuyv", "yuyv8", "yuv422_yuyv"), yuyv)
    layouts |= {"yvyu": _Layout(2, cv2.COLOR_YUV2RGB_YVYU), "yuv444": _Layout(3, cv2.COLOR_YUV2RGB)}
    for names, code in (
        (("nv12",), cv2.COLOR_YUV2RGB_NV12), (("nv21",), cv2.COLOR_YUV2RGB_NV21), (("yv12",), cv2.COLOR_YUV2RGB_YV12),
        (("i420", "iyuv", "yuv420", "yu12"), cv2.COLOR_YUV2RGB_I420),
    ):  # fmt: skip
        layouts |= dict.fromkeys(names, _Layout(1, code, rows=(3, 2)))
    return layouts | {"nv24": _Layout(1, cv2.COLOR_YUV2RGB, rows=(3, 1))}


_LAYOUTS = _layouts()


def decoded(
    encoding: str, width: int, height: int, step: int, data: NDArray[np.uint8], bigendian: bool = False
) -> NDArray[np.uint8]:
    """RGB, (h, w, 3). step: bytes a row; of 16 bits the upper 8 count. ValueError: not such a picture, or not all of it."""
    layout = _LAYOUTS.get(str(encoding).strip().lower())
    if layout is None:
        raise ValueError(f"a picture of encoding {str(encoding)[:30]!r}; {', '.join(_LAYOUTS)} are read")
    require_size(width, height)
    size, rows = layout.depth // 8, height * layout.rows[0] // layout.rows[1]
    row = width * layout.channels * size
    if rows == 1:
        step = row
    elif layout.rows != (1, 1):
        step = width  # their planes follow one another without a gap, whatever is said
    if step < row or len(data) < step * (rows - 1) + row:
        raise ValueError(f"{len(data)} bytes are too few for {width} x {height} pixels of {encoding}")
    whole = np.zeros(step * rows, np.uint8)  # the last row may end with its last pixel
    whole[: min(len(data), len(whole))] = data[: len(whole)]
    flat = np.ascontiguousarray(whole.reshape(rows, step)[:, :row])
    pixels: Pixels = flat
    if layout.depth == 16:
        pixels = (flat.view(">u2" if bigendian else "<u2") >> 0).astype(np.uint16)
    pixels = pixels.reshape(rows, width, layout.channels) if layout.channels > 1 else pixels
    return _rgb(_planes(pixels, height) if layout.rows == (3, 1) else pixels, layout)


def _planes(pixels: Pixels, height: int) -> Pixels:
    """Of NV24: grey, then both colours by turns, (h, w, 3)."""
    width = pixels.shape[1]
    return np.dstack((pixels[:height], pixels[height:].reshape(height, width, 2)))


def _rgb(pixels: Pixels, layout: _Layout) -> NDArray[np.uint8]:
    if layout.code is not None:
        try:
            pixels = np.asarray(cv2.cvtColor(pixels, layout.code))
        except cv2.error as error:
            raise ValueError(f"its pixels cannot be converted: {error.err or 'odd sides'}") from None
    return np.asarray(pixels >> 8 if layout.depth == 16 else pixels, np.uint8)
