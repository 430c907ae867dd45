"""The papers' front ends: grey levels, complex cells, hue and saturation, and the scene numbers of their simulations."""

# Callers may not be type-checked.
# pyright: reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
import numbers

import cv2
import numpy as np

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd, checked, grey, grey_template
from ratslam_core.local_view.matcher import COLUMNS, ROWS, SIZE, Features
from ratslam_core.types import Bytes, Floats, Singles


@kind("template/2")
class Template(FrontEnd):
    """A view as 12 x 8 grey levels. ACRA 2006 section 7.

    Every change counts, the light included, so several views may stand for one place.
    """

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 6.0, 20.0, 0.0

    def look(self, image: Bytes | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        return np.ascontiguousarray(grey_template(image).T).ravel()

    def picture(self, features: Features) -> Bytes:
        return features.reshape(COLUMNS, ROWS).T

    def words(self, features: Features) -> str:
        return f"12 x 8 grey levels, {features.mean():.0f} on average"


FILTERED_WIDTH, FILTERED_HEIGHT = 48, 36  # pixels at which the filters work
ORIENTATIONS, BANDS = 4, 2  # 8 bytes a column: a band above and one below the horizon
WAVELENGTH, SIGMA, REACH = 6.0, 2.4, 5  # pixels
AROUND = 9  # pixels: width of the neighbourhood by whose brightness an edge is divided
DARK = 8.0  # grey levels added to that brightness, so that noise in the dark is not amplified
GAIN = 600.0  # levels of an edge as strong as the brightness around it
GLYPH = 9  # pixels of the small picture that stands for one place


def gabor_pair(across_rad: float) -> tuple[Singles, Singles]:
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
    """How strong edges of each orientation are in each place, whatever their phase. ACRA 2004 section 3.3, Prasser et al. 2004.

    Energy of quadrature pairs of Gabor filters, divided by the brightness around, so that the light may change.
    """

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 6.0, 20.0, 0.0

    def look(self, image: Bytes | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        small = cv2.resize(grey(image), (FILTERED_WIDTH, FILTERED_HEIGHT), interpolation=cv2.INTER_AREA)
        seen = small.astype(np.float32)
        around = cv2.blur(seen, (AROUND,) * 2, borderType=cv2.BORDER_REFLECT) + DARK
        features = np.empty((COLUMNS, BANDS, ORIENTATIONS), np.float32)
        for k, (even, odd) in enumerate(PAIRS):
            a, b = (cv2.filter2D(seen, cv2.CV_32F, f, borderType=cv2.BORDER_REFLECT) for f in (even, odd))
            edges = cv2.magnitude(a, b) / around
            features[:, :, k] = cv2.resize(edges, (COLUMNS, BANDS), interpolation=cv2.INTER_AREA).T
        return np.minimum(np.rint(GAIN * features), 255).astype(np.uint8).ravel()

    def picture(self, features: Features) -> Bytes:
        """Short bars along the edges; the stronger the edges, the brighter the bars."""
        glyphs = _glyphs()[None, None] * features.reshape(COLUMNS, BANDS, ORIENTATIONS, 1, 1)
        return glyphs.max(axis=2).transpose(1, 2, 0, 3).reshape(BANDS * GLYPH, COLUMNS * GLYPH).astype(np.uint8)

    def words(self, features: Features) -> str:
        return f"edges of {ORIENTATIONS} orientations in 12 x {BANDS} places, {features.mean():.0f} on average"


def _glyphs() -> Floats:
    """A bar for each orientation of edge, 0 to 1, shape (4, 9, 9)."""
    middle = GLYPH // 2
    y, x = np.mgrid[-middle : middle + 1, -middle : middle + 1]
    across = [math.pi * k / ORIENTATIONS for k in range(ORIENTATIONS)]
    away = np.array([np.abs(x * math.cos(a) + y * math.sin(a)) for a in across])
    return np.clip(1.2 - away, 0, 1) * (np.hypot(x, y) <= middle)


HUES, SATURATIONS = COLUMNS, ROWS  # bins
FULL_SATURATION = 0.5  # from which on a pixel falls into the last bin
CERTAIN_SATURATION = 0.1  # from which on the hue of a pixel is trusted
FULL_BIN = 1 / 6  # share of the image that fills a bin
SMALL_WIDTH, SMALL_HEIGHT = 32, 24  # pixels; fewer than the camera's, which averages out its noise


@kind("hue and saturation/2")
class HueSaturation(FrontEnd):
    """A histogram of the image's hues and saturations. ACRA 2005 section 7, Prasser et al. 2005.

    Neither brightness nor where in the image a colour is makes a difference.
    """

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = False, 2.5, 5.0, 20.0, 0.0

    def look(self, image: Bytes | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        rgb = checked(image)
        if rgb.ndim == 2:
            raise ValueError(f"image must be in colour, shape (h, w, 3), for hue and saturation, got {rgb.shape}")
        small = cv2.resize(rgb.astype(np.float32) / 255, (SMALL_WIDTH, SMALL_HEIGHT), interpolation=cv2.INTER_AREA)
        hsv = np.asarray(cv2.cvtColor(small, cv2.COLOR_RGB2HSV), np.float32)
        shares = histogram(hsv[..., 0].ravel(), hsv[..., 1].ravel(), FULL_SATURATION, CERTAIN_SATURATION)
        return np.minimum(np.rint(255 / FULL_BIN * shares), 255).astype(np.uint8).ravel()

    def picture(self, features: Features) -> Bytes:
        """Hue to the right, saturation downwards; each bin in its colour, the brighter the larger its share."""
        value = np.minimum(features.reshape(HUES, SATURATIONS).T * 2.5, 255).astype(np.uint8)
        hue = np.tile((np.arange(HUES) * 180 // HUES).astype(np.uint8), (SATURATIONS, 1))
        saturation = np.tile((np.arange(SATURATIONS) * 255 // (SATURATIONS - 1)).astype(np.uint8)[:, None], (1, HUES))
        return np.asarray(cv2.cvtColor(np.dstack([hue, saturation, value]), cv2.COLOR_HSV2RGB), np.uint8)

    def words(self, features: Features) -> str:
        hue, saturation = divmod(int(features.argmax()), SATURATIONS)
        return f"mostly hue {hue * 360 // HUES}° at saturation {saturation} of {SATURATIONS - 1}"


def histogram(hue_deg: Singles, saturation: Singles, full: float, certain: float) -> Floats:
    """Shares of the bins, shape (12, 8), sum 1. Every pixel is divided between the two nearest hues and the two nearest
    saturations; a saturation of `full` or more falls into the last bin.

    [ours] A pixel of a saturation below `certain` is spread over all hues, the more evenly the greyer it is, so that
    noise does not make it jump from one hue to another. test_hue_saturation.py::test_grey_has_no_hue.
    """
    level = np.minimum(saturation / full, 1.0) * (SATURATIONS - 1)
    low = np.minimum(level.astype(np.int64), SATURATIONS - 2)
    turn = hue_deg * (HUES / 360.0)
    left = np.floor(turn).astype(np.int64)
    sure = np.minimum(saturation / certain, 1.0)
    shares = np.zeros((HUES, SATURATIONS))
    for row, by_level in ((low, low + 1 - level), (low + 1, level - low)):
        shares += np.bincount(row, by_level * (1 - sure), SATURATIONS) / HUES
        for column, by_hue in ((left, left + 1 - turn), (left + 1, turn - left)):
            bins = column % HUES * SATURATIONS + row
            shares += np.bincount(bins, by_level * by_hue * sure, HUES * SATURATIONS).reshape(HUES, SATURATIONS)
    return np.maximum(shares, 0) / len(hue_deg)


LARGEST = 2**63 - 1
NUMBER = slice(0, 8)  # where the number is kept in the features


@kind("scene numbers/2")
class SceneNumbers(FrontEnd):
    """Scene numbers given by a simulator, as in the papers' own simulations. ACRA 2005 section 5, ACRA 2006 section 5.1.

    Each number is one local view cell, recruited at first sight. The image is ignored.
    """

    columns, rows = COLUMNS, ROWS
    shifts, scale, vague = False, 1000.0, 5.0  # other numbers are 10 levels away or more; a scene is no point
    threshold, surprise = vague, math.inf  # a number is either known or not, and does not tell how far apart scenes are

    def look(self, _image: Bytes | None, scene: int | None = None, _ranges_m: object = None) -> Features:
        if not isinstance(scene, numbers.Integral) or isinstance(scene, bool) or not 0 <= scene <= LARGEST:
            raise ValueError(f"scene must be a whole number from 0 to {LARGEST} for scene numbers, got {scene!r}")
        features = np.zeros(SIZE, np.uint8)
        features[NUMBER] = np.frombuffer(int(scene).to_bytes(8, "little"), np.uint8)
        return features

    def picture(self, features: Features) -> Bytes:
        """The number in digits."""
        text = self.words(features).removeprefix("scene ")
        (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_DUPLEX, 1.0, 1)
        paper = np.full((max(height + below, 2 * width // 3) + 8, width + 8), 40, np.uint8)
        at = (4, (len(paper) + height) // 2)
        return np.asarray(cv2.putText(paper, text, at, cv2.FONT_HERSHEY_DUPLEX, 1.0, 235, 1, cv2.LINE_AA), np.uint8)

    def words(self, features: Features) -> str:
        return f"scene {int.from_bytes(features[NUMBER].tobytes(), 'little')}"
