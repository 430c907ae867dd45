"""Complex cells: how strong edges of each orientation are in each place, whatever their phase.

ACRA 2004 section 3.3, Prasser et al. 2004.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd, grey
from ratslam_core.local_view.matcher import COLUMNS, ROWS, Features

WIDTH, HEIGHT = 48, 36  # pixels at which the filters work
ORIENTATIONS, BANDS = 4, 2  # 8 bytes a column: a band above and one below the horizon
WAVELENGTH, SIGMA, REACH = 6.0, 2.4, 5  # pixels
AROUND = 9  # pixels: width of the neighbourhood by whose brightness an edge is divided
DARK = 8.0  # grey levels added to that brightness, so that noise in the dark is not amplified
GAIN = 600.0  # levels of an edge as strong as the brightness around it
GLYPH = 9  # pixels of the small picture that stands for one place


def gabor_pair(across_rad: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Even and odd Gabor filter, blind to brightness; `across_rad` is the direction across the edge, 0 = to the right."""
    y, x = np.mgrid[-REACH : REACH + 1, -REACH : REACH + 1].astype(np.float64)
    envelope = np.exp(-(x**2 + y**2) / (2 * SIGMA**2))
    phase = 2 * math.pi / WAVELENGTH * (x * math.cos(across_rad) + y * math.sin(across_rad))
    even, odd = envelope * np.cos(phase), envelope * np.sin(phase)
    even -= envelope * even.sum() / envelope.sum()
    return tuple((f / np.sqrt((f**2).sum()) / envelope.sum() ** 0.5).astype(np.float32) for f in (even, odd))  # type: ignore[return-value]


PAIRS = [gabor_pair(math.pi * k / ORIENTATIONS) for k in range(ORIENTATIONS)]


@kind("complex cells/2")
class ComplexCells(FrontEnd):
    """Energy of quadrature pairs of Gabor filters, divided by the brightness around, so that the light may change."""

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 6.0, 20.0, 0.0

    def look(self, image: NDArray[np.uint8] | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        seen = cv2.resize(grey(image), (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA).astype(np.float32)
        around = cv2.blur(seen, (AROUND,) * 2, borderType=cv2.BORDER_REFLECT) + DARK
        features = np.empty((COLUMNS, BANDS, ORIENTATIONS), np.float32)
        for k, (even, odd) in enumerate(PAIRS):
            a, b = (cv2.filter2D(seen, cv2.CV_32F, f, borderType=cv2.BORDER_REFLECT) for f in (even, odd))
            edges = cv2.magnitude(a, b) / around
            features[:, :, k] = cv2.resize(edges, (COLUMNS, BANDS), interpolation=cv2.INTER_AREA).T
        return np.minimum(np.rint(GAIN * features), 255).astype(np.uint8).ravel()

    def picture(self, features: Features) -> NDArray[np.uint8]:
        """Short bars along the edges; the stronger the edges, the brighter the bars."""
        glyphs = _glyphs()[None, None] * features.reshape(COLUMNS, BANDS, ORIENTATIONS, 1, 1)
        return glyphs.max(axis=2).transpose(1, 2, 0, 3).reshape(BANDS * GLYPH, COLUMNS * GLYPH).astype(np.uint8)

    def words(self, features: Features) -> str:
        return f"edges of {ORIENTATIONS} orientations in 12 x {BANDS} places, {features.mean():.0f} on average"


def _glyphs() -> NDArray[np.float64]:
    """A bar for each orientation of edge, 0 to 1, shape (4, 9, 9)."""
    middle = GLYPH // 2
    y, x = np.mgrid[-middle : middle + 1, -middle : middle + 1]
    across = [math.pi * k / ORIENTATIONS for k in range(ORIENTATIONS)]
    away = np.array([np.abs(x * math.cos(a) + y * math.sin(a)) for a in across])
    return np.clip(1.2 - away, 0, 1) * (np.hypot(x, y) <= middle)
