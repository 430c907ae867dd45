"""A sheet of an SVG: a heading, a field in which points of some frame are drawn, and lines of words below."""

from __future__ import annotations

from collections.abc import Sequence
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import ArrayLike, NDArray

from web.viewer.primitives.palette import Palette, Rgb

WIDTH, TOP, EDGE, FOOT = 1000.0, 78.0, 24.0, 54.0  # pixels
TALLEST = 1400.0  # of the field
_FONT = 'font-family="DejaVu Sans, Segoe UI, Roboto, Helvetica, Arial, sans-serif"'


class Sheet:
    """What is drawn later lies on top. Points are (n, 2) in the frame whose box is given; y goes up."""

    def __init__(self, palette: Palette, title: str, words: str, box: tuple[float, float, float, float]) -> None:
        """box: least x, least y, greatest x, greatest y of what is to be seen."""
        self.palette = palette
        x1, y1, x2, y2 = box
        self.scale = min((WIDTH - 2 * EDGE) / max(x2 - x1, 1e-6), TALLEST / max(y2 - y1, 1e-6))  # pixels a unit
        self._left = (WIDTH - (x2 - x1) * self.scale) / 2 - x1 * self.scale
        self._bottom = TOP + y2 * self.scale
        self.height = TOP + (y2 - y1) * self.scale + FOOT
        self._parts: list[str] = []
        self._clip = (x1, y1, x2, y2)
        self.polygon([(x1, y1), (x2, y1), (x2, y2), (x1, y2)], palette.floor, stroke=palette.rim)
        self._words(EDGE, 40, title, 28, palette.text, bold=True)
        self._words(EDGE, 64, words, 16, palette.text_2)

    def pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        xy = np.asarray(points, np.float64).reshape(-1, 2)
        return xy * (self.scale, -self.scale) + (self._left, self._bottom)

    def line(
        self, points: ArrayLike, colour: Rgb, width: float, *, opacity: float = 1.0, dash: str = ""
    ) -> None:  # width: pixels
        if len(np.asarray(points)) > 1:
            dashed = f' stroke-dasharray="{dash}"' if dash else ""
            self._parts.append(
                f'<path d="{_path(self.pixels(points))}" fill="none" stroke="{_hex(colour)}" stroke-width="{width:g}" '
                f'stroke-linecap="round" stroke-linejoin="round"{_see_through(opacity)}{dashed}/>'
            )

    def lines(self, segments: ArrayLike, colour: Rgb, width: float, *, opacity: float = 1.0) -> None:
        """segments: (n, 2, 2), all in one path."""
        ends = self.pixels(segments).reshape(-1, 2, 2)
        if len(ends):
            d = "".join(map(_path, ends))
            self._parts.append(
                f'<path d="{d}" fill="none" stroke="{_hex(colour)}" stroke-width="{width:g}" stroke-linecap="round"'
                f"{_see_through(opacity)}/>"
            )

    def polygon(self, points: ArrayLike, fill: Rgb, *, stroke: Rgb | None = None, opacity: float = 1.0) -> None:
        edge = "" if stroke is None else f' stroke="{_hex(stroke)}" stroke-width="1.5"'
        self._parts.append(
            f'<path d="{_path(self.pixels(points))}Z" fill="{_hex(fill)}"{edge}{_see_through(opacity)}/>'
        )

    def dot(self, place: Sequence[float], radius: float, fill: Rgb | None, stroke: Rgb | None = None) -> None:
        """radius: pixels."""
        x, y = self.pixels([place])[0]
        edge = "" if stroke is None else f' stroke="{_hex(stroke)}" stroke-width="2.5"'
        inside = "none" if fill is None else _hex(fill)
        self._parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{inside}"{edge}/>')

    def arrow(self, x: float, y: float, heading_rad: float, fill: Rgb, size: float) -> None:
        """A robot: an arrowhead of this size, pixels."""
        outline = np.array([(1.0, 0.0), (-0.8, 0.62), (-0.4, 0.0), (-0.8, -0.62)]) * size / self.scale
        c, s = np.cos(heading_rad), np.sin(heading_rad)
        self.polygon(outline @ np.array([(c, s), (-s, c)]) + (x, y), fill, stroke=self.palette.casing)

    def label(self, place: Sequence[float], words: str, colour: Rgb, *, size: float = 15, up: float = 0.0) -> None:
        """Words in the middle of a place, or so many pixels above it."""
        x, y = self.pixels([place])[0]
        half = 0.3 * size * len(words)
        x = float(np.clip(x, EDGE + half, max(EDGE + half, WIDTH - EDGE - half)))
        self._words(x, y - up + size / 3, words, size, colour, anchor="middle", casing=True)

    def foot(self, words: str, right: str = "") -> None:
        """Words below the field."""
        y = self.height - FOOT + 32
        self._words(EDGE, y, words, 15, self.palette.text_2)
        if right:
            self._words(WIDTH - EDGE, y, right, 15, self.palette.text_2, anchor="end")

    def scale_bar(self, colours: NDArray[np.uint8], low: str, high: str) -> None:
        """Colours, (n, 3), with what their ends mean, at the right of the heading."""
        x, y, width, height = WIDTH - EDGE - 200, 28, 200, 14
        stops = "".join(
            f'<stop offset="{k / (len(colours) - 1):.3f}" stop-color="{_hex(tuple(colour))}"/>'
            for k, colour in enumerate(colours.tolist())
        )
        self._parts.append(
            f'<linearGradient id="times">{stops}</linearGradient><rect x="{x:g}" y="{y:g}" width="{width:g}" '
            f'height="{height:g}" fill="url(#times)"/>'
        )
        self._words(x, y + 32, low, 14, self.palette.text_2)
        self._words(x + width, y + 32, high, 14, self.palette.text_2, anchor="end")

    def svg(self) -> str:
        size = f'width="{WIDTH:g}" height="{self.height:.0f}" viewBox="0 0 {WIDTH:g} {self.height:.0f}"'
        paper = f'<rect width="100%" height="100%" fill="{_hex(self.palette.sheet)}"/>'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {_FONT}>{paper}{"".join(self._parts)}</svg>\n'

    def _words(
        self, x: float, y: float, words: str, size: float, colour: Rgb, *, anchor: str = "start", bold: bool = False,
        casing: bool = False,
    ) -> None:  # fmt: skip
        weight = ' font-weight="700"' if bold else ""
        around = f' stroke="{_hex(self.palette.floor)}" stroke-width="4" paint-order="stroke"' if casing else ""
        self._parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" fill="{_hex(colour)}" text-anchor={quoteattr(anchor)}'
            f"{weight}{around}>{escape(_plain(words))}</text>"
        )


def _path(points: NDArray[np.float64]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist())


def _hex(colour: Sequence[int]) -> str:
    return "#" + "".join(f"{int(part):02x}" for part in colour)


def _see_through(opacity: float) -> str:
    return f' opacity="{opacity:.2f}"' if opacity < 1 else ""


def _plain(words: str) -> str:
    return "".join(c for c in words if c.isprintable())  # control characters are no XML
