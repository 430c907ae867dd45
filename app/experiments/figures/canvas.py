"""What all figures share: one style, the colours, and how they become files.

The same figure is the same SVG, byte for byte: no date, no version, one salt for its ids.
"""

# matplotlib tells the types of its own functions in part only.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import io
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter
from numpy.typing import NDArray

INK, SOFT, WALL, FAINT, PAPER = "#1f2328", "#5b626a", "#8a9199", "#d9dde1", "#ffffff"
BLUE, VERMILION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
ORANGE, SKY, BLACK = "#e69f00", "#56b4e9", "#000000"

CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, SOFT)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
ENGINE_COLOUR = {"paper": BLUE, "paper-2005": GREEN, "paper-2006": PURPLE, "ours": VERMILION}
# The page has its own shade of each, for light and dark.
THEMED = {
    INK: "ink", SOFT: "soft", WALL: "wall", FAINT: "faint", PAPER: "paper", BLACK: "ink",
    BLUE: "blue", VERMILION: "vermilion", GREEN: "green", PURPLE: "purple", ORANGE: "orange", SKY: "sky",
}  # fmt: skip

_STYLE = Path(__file__).with_name("ratslam.mplstyle")
WIDTH_IN = 7.2  # of a page's column
_SVG_DPI, _PNG_DPI = 72, 200
# Left to itself, matplotlib writes all of this into a file; the type is an address elsewhere.
_SAYS_NOTHING: dict[str, None] = dict.fromkeys(("Creator", "Date", "Format", "Type"))


@contextmanager
def style() -> Generator[None]:
    """Within it, figures are drawn in the one style, whatever the reader's own settings are."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rc_file(_STYLE, use_default_template=False)
        yield


def panels(
    rows: int, columns: int, width_in: float, height_in: float, **shares: Any
) -> tuple[Figure, NDArray[np.object_]]:
    """A figure of so many panels, (rows, columns). shares: sharex, sharey, width_ratios, height_ratios."""
    figure = Figure(figsize=(width_in, height_in), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **shares)


def svg_of(figure: Figure) -> str:
    """The figure as the text of an SVG file."""
    with style():
        _settle(figure)
        out = io.StringIO()
        FigureCanvasSVG(figure).print_svg(out, metadata=dict(_SAYS_NOTHING))
        return out.getvalue()


def png_of(figure: Figure) -> bytes:
    """The figure as a PNG file."""
    with style():
        _settle(figure)
        out = io.BytesIO()
        figure.set_dpi(_PNG_DPI)
        FigureCanvasAgg(figure).print_png(out, metadata={"Software": None})
        return out.getvalue()


def _settle(figure: Figure) -> None:
    """Lay the figure out once, at the resolution of an SVG. A second layout would begin where the first has ended."""
    figure.set_dpi(_SVG_DPI)
    if figure.get_layout_engine() is not None:
        FigureCanvasAgg(figure)
        figure.draw_without_rendering()
        figure.set_layout_engine("none")


def go_by_powers(axes: Axes, which: str) -> None:
    """Make an axis, "x" or "y", logarithmic, with numbers that need no formula."""
    (axes.set_xscale if which == "x" else axes.set_yscale)("log")
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_major_formatter(_Powers())
    axis.set_minor_formatter(_Powers())


class _Powers(LogFormatter):
    """0.1, 1, 10, and what lies between them where there is room."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def grid_lines(axes: Axes, which: str = "y") -> None:
    """Thin lines to read values off."""
    axes.grid(True, axis=which)  # pyright: ignore[reportUnknownMemberType, reportArgumentType]


def frame(axes: Axes) -> None:
    """A thin frame all round: the panel is a picture, without numbers."""
    axes.set(xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(True)
        spine.set_linewidth(0.4)
