"""Scenes to look at, and local views with the front end that is asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ratslam_core import LocalView, LocalViewParams

Image = NDArray[np.uint8]
P = LocalViewParams()


def office(seed: int, light: float = 1.0, turned: int = 0) -> Image:
    """A varied scene of coloured panels, (48, 64, 3), shifted by `turned` pixels to the left."""
    rng = np.random.default_rng(seed)
    scene = np.full((48, 100, 3), 120.0)
    for _ in range(40):
        x, y, w, h = rng.integers(0, 92), rng.integers(0, 40), rng.integers(4, 20), rng.integers(4, 16)
        scene[y : y + h, x : x + w] = rng.uniform(20, 160, 3)
    return np.rint(light * scene[:, 16 - turned : 80 - turned]).astype(np.uint8)


def view_of(kind: str, **params: Any) -> LocalView:
    return LocalView(LocalViewParams(front_end=kind, **params))
