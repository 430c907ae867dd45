"""A sheet of an SVG: a heading, a field in which points of some frame are drawn, and lines of words below. None of its labels
covers another or leaves the field, and one that had to go aside has a line to its place.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import ArrayLike, NDArray

from web.viewer.marks.judged import clipped
from web.viewer.primitives import images
from web.viewer.primitives.labels import clear_place
from web.viewer.primitives.palette import Palette, Rgb

Array = NDArray[np.float64]
Mark = Literal["line", "dashes", "ring", "oval", "area"]
Entry = tuple[Mark, Rgb, str]  # of a legend
WIDTH, TOP, EDGE, FOOT = 1000.0, 78.0, 24.0, 54.0  # pixels
TALLEST = 1400.0  # of the field
SHARP = 4  # a pixel of an image is so many wide: programs that smooth what they enlarge blur less of it
HEADING = WIDTH - 2 * EDGE - 230  # beside it may be a scale
GAP = 4.0  # pixels
ASIDE = 0.7  # of its height: a label that has gone farther has a line
CLEAR = 11.0  # pixels around what it names, in which there is no line
_FONT = 'font-family="DejaVu Sans, Segoe UI, Roboto, Helvetica, Arial, sans-serif"'


class Sheet:
    """What is drawn later lies on top, labels over all else. Points are (n, 2) in the frame whose box is given; y goes up."""

    def __init__(
        self, palette: Palette, title: str, words: str, box: tuple[float, float, float, float], ink: Rgb | None = None
    ) -> None:
        """box: least x, least y, greatest x, greatest y of what is to be seen. ink: of the title."""
        self.palette, self.box = palette, box
        x1, y1, x2, y2 = box
        self.scale = min((WIDTH - 2 * EDGE) / max(x2 - x1, 1e-6), TALLEST / max(y2 - y1, 1e-6))  # pixels a unit
        self._left = (WIDTH - (x2 - x1) * self.scale) / 2 - x1 * self.scale
        self._bottom = TOP + y2 * self.scale
        self.height = TOP + (y2 - y1) * self.scale + FOOT
        self._parts: list[str] = []  # in the field
        self._around: list[str] = []
        self._labels: list[Label] = []
        self._avoided: list[tuple[float, float, float]] = []
        self.polygon([(x1, y1), (x2, y1), (x2, y2), (x1, y2)], palette.floor)
        self._words(EDGE, 40, title, _fitting(title, 28, HEADING, bold=True), ink or palette.text, bold=True)
        self._words(EDGE, 64, words, _fitting(words, 16, HEADING), palette.text_2)

    def inside(self, points: ArrayLike) -> NDArray[np.bool_]:
        """(n,) which of the points are in the field."""
        x1, y1, x2, y2 = self.box
        xy = np.asarray(points, np.float64).reshape(-1, 2)
        return np.all((xy >= (x1, y1)) & (xy <= (x2, y2)), axis=1)

    def within(self, segments: ArrayLike) -> NDArray[np.float64]:
        """(m, 2, 2) what of (n, 2, 2) segments is in the field."""
        x1, y1, x2, y2 = self.box
        middle = np.array([(x1 + x2) / 2, (y1 + y2) / 2])
        moved = (np.asarray(segments, np.float64).reshape(-1, 2) - middle).reshape(-1, 4)
        return clipped(moved, ((x2 - x1) / 2, (y2 - y1) / 2)).reshape(-1, 2, 2) + middle

    def pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        xy = np.asarray(points, np.float64).reshape(-1, 2)
        return xy * (self.scale, -self.scale) + (self._left, self._bottom)

    def line(self, points: ArrayLike, colour: Rgb, width: float, *, opacity: float = 1.0, dash: str = "") -> None:
        """width: pixels."""
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

    def polygon(
        self, points: ArrayLike, fill: Rgb, *, stroke: Rgb | None = None, opacity: float = 1.0,
        holes: Sequence[ArrayLike] = (),
    ) -> None:  # fmt: skip
        """holes: polygons, which may overlap, in which it is not drawn."""
        edge = "" if stroke is None else f' stroke="{_hex(stroke)}" stroke-width="1.5"'
        d = f"{_path(self.pixels(points))}Z"
        if holes:
            name, cut = f"holes{len(self._parts)}", "".join(f"{_path(self.pixels(hole))}Z" for hole in holes)
            self._parts.append(f'<mask id="{name}"><path d="{d}" fill="#fff"/><path d="{cut}"/></mask>')
            edge += f' mask="url(#{name})"'
        self._parts.append(f'<path d="{d}" fill="{_hex(fill)}"{edge}{_see_through(opacity)}/>')

    def dot(
        self, place: Sequence[float], radius: float, fill: Rgb | None, stroke: Rgb | None = None, *, edge: float = 2.5
    ) -> None:
        """radius, and how wide its edge is: pixels."""
        x, y = self.pixels([place])[0]
        rim = "" if stroke is None else f' stroke="{_hex(stroke)}" stroke-width="{edge:g}"'
        inside = "none" if fill is None else _hex(fill)
        self._parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{inside}"{rim}/>')

    def image(self, pixels: images.Pixels, corners: ArrayLike) -> None:
        """RGB or RGBA. corners: (3, 2) of the frame where its upper left, upper right and lower left ones are."""
        large = pixels.repeat(SHARP, 0).repeat(SHARP, 1)
        height, width = large.shape[:2]
        (left, top), right, bottom = self.pixels(corners).tolist()
        across = (right[0] - left) / width, (right[1] - top) / width
        down = (bottom[0] - left) / height, (bottom[1] - top) / height
        matrix = " ".join(f"{part:.6g}" for part in (*across, *down, left, top))
        png = base64.b64encode(images.png(large)).decode()
        self._parts.append(
            f'<image width="{width}" height="{height}" transform="matrix({matrix})" preserveAspectRatio="none" '
            f'style="image-rendering:pixelated" xlink:href="data:image/png;base64,{png}"/>'
        )

    def arrow(self, x: float, y: float, heading_rad: float, fill: Rgb, size: float, *, edge: Rgb | None = None) -> None:
        """A robot: an arrowhead of this size, pixels."""
        outline = np.array([(1.0, 0.0), (-0.8, 0.62), (-0.4, 0.0), (-0.8, -0.62)]) * size / self.scale
        c, s = np.cos(heading_rad), np.sin(heading_rad)
        self.polygon(outline @ np.array([(c, s), (-s, c)]) + (x, y), fill, stroke=edge or self.palette.casing)

    def way(self, points: ArrayLike, colour: Rgb, width: float) -> None:
        """A line in a casing, with a head at its end."""
        xy = np.asarray(points, np.float64)
        ahead = xy[-1] - xy[-2]
        self.line(xy, self.palette.casing, 1.6 * width)
        self.line(xy, colour, width)
        self.arrow(xy[-1, 0], xy[-1, 1], float(np.arctan2(ahead[1], ahead[0])), colour, 2.4 * width)

    def label(
        self, place: Sequence[float], words: str, colour: Rgb, *, size: float = 15, up: float = 0.0,
        fill: Rgb | None = None, rim: Rgb | None = None,
    ) -> None:  # fmt: skip
        """Words in the middle of a place or so many pixels above it, or beside that where labels that came before are.

        fill, rim: of a bar below them; a place beside the field is named at its edge."""
        x1, y1, x2, y2 = self.box
        x, y = self.pixels([np.clip(place, (x1, y1), (x2, y2))])[0].tolist()
        self._labels.append(Label((x, y), up, _plain(words), colour, size, fill, rim))

    def note(self, place: Sequence[float], words: str, *, anchor: str, up: float, bold: bool = False) -> None:
        """Words that stay where they are, so many pixels above a place, as numbers on an axis do; labels give way."""
        (x, y), size = self.pixels([place])[0].tolist(), 14
        colour = self.palette.text if bold else self.palette.text_2
        self._words(x, y - up, words, size, colour, anchor=anchor, bold=bold, casing=True)
        half = width_of(words, size, bold=bold) / 2
        self._avoided.append((x + {"start": half, "middle": 0.0, "end": -half}[anchor], y - up - 0.36 * size, half))

    def avoid(self, place: Sequence[float], radius: float) -> None:
        """No label is to lie here. radius: pixels."""
        if self.inside(place)[0]:
            x, y = self.pixels([place])[0].tolist()
            self._avoided.append((x, y, radius))

    def foot(self, words: str, right: str = "") -> None:
        """Words below the field."""
        y = self.height - FOOT + 30
        room = WIDTH - 2 * EDGE - (width_of(right, 15) + 24 if right else 0)
        self._words(EDGE, y, words, _fitting(words, 15, room), self.palette.text_2)
        if right:
            self._words(WIDTH - EDGE, y, right, 15, self.palette.text_2, anchor="end")

    def legend(self, entries: Sequence[Entry]) -> None:
        """What the marks mean, in lines below the foot."""
        x = EDGE
        for k, (mark, colour, words) in enumerate(entries):
            wide = 40 + width_of(words, 14)
            if k == 0 or x + wide > WIDTH - EDGE:
                x, self.height = EDGE, self.height + 24
            y = self.height - 24
            self._around.append(_sample(mark, colour, x, y, self.palette.rim))
            self._words(x + 34, y + 5, words, 14, self.palette.text_2)
            x += wide + 22

    def scale_bar(self, colours: NDArray[np.uint8], low: str, high: str) -> None:
        """Colours, (n, 3), with what their ends mean, at the right of the heading."""
        x, y, width, height = WIDTH - EDGE - 200, 28, 200, 14
        stops = "".join(
            f'<stop offset="{k / (len(colours) - 1):.3f}" stop-color="{_hex(tuple(colour))}"/>'
            for k, colour in enumerate(colours.tolist())
        )
        self._around.append(
            f'<linearGradient id="times">{stops}</linearGradient><rect x="{x:g}" y="{y:g}" width="{width:g}" '
            f'height="{height:g}" fill="url(#times)"/>'
        )
        self._words(x, y + 32, low, 14, self.palette.text_2)
        self._words(x + width, y + 32, high, 14, self.palette.text_2, anchor="end")

    def svg(self) -> str:
        (x1, y2), (x2, y1) = self.pixels([self.box[:2], self.box[2:]]).tolist()
        edge = f"M{x1:.1f} {y1:.1f}H{x2:.1f}V{y2:.1f}H{x1:.1f}Z"
        field = f'<clipPath id="field"><path d="{edge}"/></clipPath>'
        rim = f'<path d="{edge}" fill="none" stroke="{_hex(self.palette.rim)}" stroke-width="1.5"/>'
        drawn = f'{field}<g clip-path="url(#field)">{"".join(self._parts)}</g>{rim}'
        self._name(np.array([(x1, y1), (x2, y2)]))
        size = f'width="{WIDTH:g}" height="{self.height:.0f}" viewBox="0 0 {WIDTH:g} {self.height:.0f}"'
        paper = f'<rect width="100%" height="100%" fill="{_hex(self.palette.sheet)}"/>'
        around = "".join(self._around)
        names = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
        return f"<svg {names} {size} {_FONT}>{paper}{drawn}{around}</svg>\n"

    def _name(self, field: NDArray[np.float64]) -> None:
        """Draws the labels, lines first."""
        places = laid_out(self._labels, self._avoided, field)
        for label, place in zip(self._labels, places, strict=True):
            line = _line_to(label, place)
            if line is not None:
                ink = _hex(label.fill or label.ink)
                self._around.append(
                    f'<path d="{_path(line)}" stroke="{ink}" stroke-width="1.5" stroke-linecap="round"/>'
                )
        for label, (x, y) in zip(self._labels, places, strict=True):
            if label.fill is not None:
                width, height = label.bar.tolist()
                rim = "" if label.rim is None else f' stroke="{_hex(label.rim)}" stroke-width="1.2"'
                self._around.append(
                    f'<rect x="{x - width / 2:.1f}" y="{y - height / 2:.1f}" width="{width:.1f}" height="{height:.1f}" '
                    f'rx="{height / 2:.1f}" fill="{_hex(label.fill)}"{rim}/>'
                )
            bar = label.fill is not None
            self._words(
                x, y + 0.36 * label.size, label.words, label.size, label.ink, anchor="middle", bold=bar, casing=not bar
            )

    def _words(
        self, x: float, y: float, words: str, size: float, colour: Rgb, *, anchor: str = "start", bold: bool = False,
        casing: bool = False,
    ) -> None:  # fmt: skip
        weight = ' font-weight="700"' if bold else ""
        around = f' stroke="{_hex(self.palette.floor)}" stroke-width="4" paint-order="stroke"' if casing else ""
        self._around.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" fill="{_hex(colour)}" text-anchor={quoteattr(anchor)}'
            f"{weight}{around}>{escape(_plain(words))}</text>"
        )


def _fitting(words: str, size: float, room: float, *, bold: bool = False) -> float:
    """The size at which words need no more than the room."""
    return size * min(1.0, room / max(width_of(words, size, bold=bold), 1e-6))


def _sample(mark: Mark, colour: Rgb, x: float, y: float, rim: Rgb) -> str:
    """What a mark looks like, 26 pixels wide from x on, about y."""
    ink = f'fill="none" stroke="{_hex(colour)}" stroke-width="2.5"'
    middle = x + 13
    return {
        "line": f'<path d="M{x:.1f} {y:.1f}h26" {ink}/>',
        "dashes": f'<path d="M{x:.1f} {y:.1f}h26" {ink} stroke-dasharray="6 4"/>',
        "ring": f'<circle cx="{middle:.1f}" cy="{y:.1f}" r="7" {ink}/>',
        "oval": f'<ellipse cx="{middle:.1f}" cy="{y:.1f}" rx="12" ry="7" {ink}/>',
        "area": f'<rect x="{x:.1f}" y="{y - 7:.1f}" width="26" height="14" rx="3" fill="{_hex(colour)}" '
        f'stroke="{_hex(rim)}"/>',
    }[mark]


def _path(points: NDArray[np.float64]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist())


def _hex(colour: Sequence[int]) -> str:
    return "#" + "".join(f"{int(part):02x}" for part in colour)


def _see_through(opacity: float) -> str:
    return f' opacity="{opacity:.2f}"' if opacity < 1 else ""


@dataclass(frozen=True)
class Label:
    """All in pixels; y goes down."""

    at: tuple[float, float]  # what it names
    up: float  # how far above it the label would be best
    words: str
    ink: Rgb
    size: float  # of the words
    fill: Rgb | None  # of the bar below them; None: there is none
    rim: Rgb | None = None  # of the bar

    @property
    def bar(self) -> Array:
        """(2,) width and height of what it takes."""
        aside = 0.9 * self.size if self.fill is not None else 2.0
        return np.array([width_of(self.words, self.size, bold=self.fill is not None) + 2 * aside, 1.5 * self.size])


def width_of(words: str, size: float, *, bold: bool = False) -> float:
    """In DejaVu Sans, which is wider than what a browser without it takes instead."""
    return float(images.font(48, bold).getlength(_plain(words))) * size / 48


def _plain(words: str) -> str:
    return "".join(c for c in words if c.isprintable())  # control characters are no XML


def laid_out(labels: list[Label], avoided: list[tuple[float, float, float]], field: Array) -> list[tuple[float, float]]:
    """The middle of each; the earlier ones have the choice. avoided: middles and radii; field: (2, 2) two opposite corners."""
    around = [(x, y, 2 * radius, 2 * radius) for x, y, radius in avoided]
    taken = np.array(around, np.float64).reshape(-1, 4)
    places: list[tuple[float, float]] = []
    for label in labels:
        wanted = np.array(label.at) - (0.0, label.up)
        x, y = clear_place(wanted, label.bar, taken, field, GAP).tolist()
        taken = np.vstack([taken, (x, y, *label.bar)])
        places.append((x, y))
    return places


def _line_to(label: Label, place: tuple[float, float]) -> Array | None:
    """(2, 2) from beside what it names to its bar; None: it needs no line."""
    half, middle, at = label.bar / 2, np.array(place), np.array(label.at)
    end = np.clip(at, middle - half, middle + half)
    far = float(np.hypot(*(end - at)))
    if far <= CLEAR or np.hypot(*(middle - at + (0.0, label.up))) <= ASIDE * 2 * half[1]:
        return None
    return np.stack([at + (end - at) * CLEAR / far, end])
