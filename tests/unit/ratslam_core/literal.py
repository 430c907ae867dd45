"""Slow twins of the engine, written straight from the equations with loops and dense float64 arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from types import ModuleType
from typing import ParamSpec

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import PoseCells

Array = NDArray[np.float64]
Given = ParamSpec("Given")


def interpret(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the module's compiled functions by the Python from which they were compiled, so that coverage sees it."""
    for name, function in vars(module).copy().items():
        if hasattr(function, "py_func"):
            quiet = np.errstate(all="ignore")  # as compiled code is
            monkeypatch.setattr(module, name, quiet(function.py_func))


def also_interpreted(*modules: ModuleType) -> Callable[[Callable[Given, None]], Callable[Given, None]]:
    """A test that runs twice: with the compiled functions of these modules, and interpreted."""

    def twice(test: Callable[Given, None]) -> Callable[Given, None]:
        @wraps(test)
        def both(*args: Given.args, **named: Given.kwargs) -> None:
            test(*args, **named)
            with pytest.MonkeyPatch.context() as patch:
                for module in modules:
                    interpret(module, patch)
                test(*args, **named)

        return both

    return twice


def fill(pose_cells: PoseCells, dense: Array) -> None:
    """Put this activity, shape (n_theta, n_y, n_x), into a network that stands still."""
    flats = np.flatnonzero(dense)
    theta, y, x = (int(v) for v in np.unravel_index(flats[0], dense.shape))
    pose_cells.place(x, y, theta)
    pose_cells.active[1][0] = dense.flat[flats[0]]
    pose_cells.inject(flats[1:].astype(np.int32), dense.flat[flats[1:]].astype(np.float32))


def gaussian(sigma: float, radius: int) -> list[float]:
    weights = [math.exp(-(k**2) / (2 * sigma**2)) for k in range(-radius, radius + 1)]
    return [w / sum(weights) for w in weights]


def shift(P: Array, along: float, yaw: float) -> Array:
    """A5-A9: every cell's activity is divided over a cube of 2 x 2 x 2 cells, shifted along the heading of its own layer."""
    n_theta, n_y, n_x = P.shape
    result = np.zeros_like(P)
    for t, y, x in zip(*np.nonzero(P), strict=True):
        heading = 2 * math.pi * t / n_theta
        offsets = along * math.cos(heading), along * math.sin(heading), yaw
        wx, wy, wt = (math.floor(v) for v in offsets)
        fx, fy, ft = (v - math.floor(v) for v in offsets)
        for a in (0, 1):
            for b in (0, 1):
                for c in (0, 1):
                    alpha = (fx if a else 1 - fx) * (fy if b else 1 - fy) * (ft if c else 1 - ft)
                    result[(t + wt + c) % n_theta, (y + wy + b) % n_y, (x + wx + a) % n_x] += alpha * P[t, y, x]
    return result


def convolve(P: Array, weights: list[float]) -> Array:
    """A10: circular convolution with the product of three Gaussians."""
    reach = range(-(len(weights) // 2), len(weights) // 2 + 1)
    result = np.zeros_like(P)
    for t, y, x in zip(*np.nonzero(P), strict=True):
        for c, wt in zip(reach, weights, strict=True):
            for b, wy in zip(reach, weights, strict=True):
                for a, wx in zip(reach, weights, strict=True):
                    at = (t + c) % P.shape[0], (y + b) % P.shape[1], (x + a) % P.shape[2]
                    result[at] += wt * wy * wx * P[t, y, x]
    return result


def inhibit(P: Array, phi: float) -> Array:
    """A11-A12."""
    left = np.maximum(P - phi, 0)
    return left / left.sum()
