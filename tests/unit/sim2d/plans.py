"""A plan of known walls, as the files that importers read."""

from __future__ import annotations

from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sim2d import World
from sim2d.importers import import_world

YAML = "image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def pgm(picture: NDArray[np.uint8]) -> bytes:
    return b"P5\n%d %d\n255\n" % (picture.shape[1], picture.shape[0]) + picture.astype(np.uint8).tobytes()


def png(picture: NDArray[np.uint8]) -> bytes:
    out = BytesIO()
    Image.fromarray(picture).save(out, "PNG")
    return out.getvalue()


def room(rows: int = 120, columns: int = 160, border: int = 5) -> NDArray[np.uint8]:
    picture = np.zeros((rows, columns), np.uint8)
    picture[border:-border, border:-border] = 255
    return picture


def from_picture(picture: NDArray[np.uint8], scale_m: float = 0.05, seed: int = 0) -> World:
    return import_world("plan.pgm", {"plan.pgm": pgm(picture)}, scale_m, seed)


def corners(world: World) -> set[tuple[float, float]]:
    return {(w.x1, w.y1) for w in world.walls}
