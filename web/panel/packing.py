"""A message with arrays: a head of JSON and the bytes of each array, so that the page can draw them as they are.

Four bytes with the head's length (little-endian), the head, then the arrays one after the other. Each array begins at a
multiple of four: the head is padded with spaces, an array with zeros.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import orjson
from numpy.typing import NDArray

MANY_BYTES = 4096  # larger colour pictures go as JPEG with whole colours, a fifth of the bytes
_JPEG = (cv2.IMWRITE_JPEG_QUALITY, 93, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444)


@dataclass(frozen=True, slots=True)
class Packed:
    """One array: how to read it, and its bytes."""

    kind: str  # "u1", "u2", "f4": numbers; "jpeg": a picture that the browser unpacks
    shape: tuple[int, ...]
    body: bytes


def packed(array: NDArray[Any]) -> Packed:
    """An array as it is sent: large colour pictures as JPEG, all others as they are."""
    if array.dtype == np.uint8 and array.ndim == 3 and array.nbytes > MANY_BYTES:
        _, image = cv2.imencode(".jpg", np.ascontiguousarray(array[..., ::-1]), _JPEG)
        return Packed("jpeg", array.shape, image.tobytes())
    little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    return Packed(f"{array.dtype.kind}{array.dtype.itemsize}", array.shape, little.tobytes())


def framed(head: dict[str, Any], arrays: Mapping[str, Packed]) -> bytes:
    """The whole message; the head gets the arrays' names, kinds, shapes and lengths in their order."""
    listed = [{"name": n, "kind": p.kind, "shape": p.shape, "bytes": len(p.body)} for n, p in arrays.items()]
    text = _to_four(orjson.dumps({**head, "arrays": listed}), b" ")
    bodies = (_to_four(array.body, b"\0") for array in arrays.values())
    return b"".join((len(text).to_bytes(4, "little"), text, *bodies))


def _to_four(raw: bytes, filler: bytes) -> bytes:
    return raw + filler * (-len(raw) % 4)
