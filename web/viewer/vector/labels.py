"""The labels of a sheet: none covers another or leaves the field, and one that had to go aside has a line to its place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from web.viewer.primitives import images
from web.viewer.primitives.label_room import clear_place
from web.viewer.primitives.palette import Rgb

GAP = 4.0  # pixels
ASIDE = 0.7  # of its height: a label that has gone farther has a line
CLEAR = 11.0  # pixels around what it names, in which there is no line
Array = NDArray[np.float64]


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
    return float(images.font(48, bold).getlength(plain(words))) * size / 48


def plain(words: str) -> str:
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


def line_to(label: Label, place: tuple[float, float]) -> Array | None:
    """(2, 2) from beside what it names to its bar; None: it needs no line."""
    half, middle, at = label.bar / 2, np.array(place), np.array(label.at)
    end = np.clip(at, middle - half, middle + half)
    far = float(np.hypot(*(end - at)))
    if far <= CLEAR or np.hypot(*(middle - at + (0.0, label.up))) <= ASIDE * 2 * half[1]:
        return None
    return np.stack([at + (end - at) * CLEAR / far, end])
