"""What is drawn in a picture of a plate: its words and where they lie, its lines, rings and places."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np

from tests.fake_snapshots import fake_reports
from web.messages import Snapshot
from web.switches import NAMES, Name
from web.themes import Theme
from web.viewer.fits import DEPTH as FLOOR_DEPTH
from web.viewer.fits import WIDTH as FLOOR_WIDTH
from web.viewer.fits import MapFit, refit
from web.viewer.primitives.palette import Rgb
from web.viewer.vector import PlateName, vector_picture
from web.viewer.vector.sheet import EDGE, TOP, WIDTH, width_of

REPORTS = fake_reports()
SVG = "{http://www.w3.org/2000/svg}"
Picture = ElementTree.Element


def drawn(plate: PlateName, snapshot: Snapshot, on: tuple[Name, ...] = NAMES, theme: Theme = "dark") -> Picture:
    return ElementTree.fromstring(vector_picture(plate, snapshot, theme, on))


def words(picture: Picture) -> list[str]:
    return [text.text or "" for text in picture.iter(f"{SVG}text")]


def ink(colour: Rgb) -> str:
    return "#" + "".join(f"{part:02x}" for part in colour)


def strokes(picture: Picture, colour: Rgb) -> list[np.ndarray]:
    """In the field: the corners of each line of a colour, pixels."""
    field = next(group for group in picture if group.get("clip-path"))
    paths = [path.get("d", "") for path in field.iter(f"{SVG}path") if path.get("stroke") == ink(colour)]
    ways = [way for path in paths for way in path.split("M")[1:]]
    return [np.array(re.findall(r"-?\d+\.\d+", way), float).reshape(-1, 2) for way in ways]


def filled(picture: Picture, colour: Rgb) -> list[Picture]:
    """The shapes that are filled with a colour."""
    return [path for path in picture.iter(f"{SVG}path") if path.get("fill") == ink(colour)]


def corners(shape: Picture) -> np.ndarray:
    """(n, 2) of a shape, pixels."""
    return np.array(re.findall(r"-?\d+\.\d+", shape.get("d", "")), float).reshape(-1, 2)


def circles(picture: Picture, colour: Rgb) -> np.ndarray:
    """Middles of the rings of a colour in the field."""
    field = next(group for group in picture if group.get("clip-path"))
    found = [c for c in field.iter(f"{SVG}circle") if c.get("stroke") == ink(colour)]
    return np.array([(float(c.get("cx", 0)), float(c.get("cy", 0))) for c in found]).reshape(-1, 2)


def on_map(snapshot: Snapshot, points: np.ndarray) -> tuple[np.ndarray, tuple[float, float]]:
    """(n, 2) points of the map in pixels, and the field's size: they lie as on the plate, whose floor fills the field."""
    fit = refit(MapFit(), snapshot.map.extent_xy, snapshot.map_turn_rad)
    scale = (WIDTH - 2 * EDGE) / FLOOR_WIDTH
    pixels = (fit.to_plate(points) - (-FLOOR_WIDTH / 2, FLOOR_DEPTH / 2)) * (scale, -scale) + (EDGE, TOP)
    return pixels, (WIDTH - 2 * EDGE, FLOOR_DEPTH * scale)


def boxes(picture: Picture) -> list[tuple[float, float, float, float]]:
    """Left, top, right and bottom of all words, by the metrics of the widest font that may be taken."""
    found = []
    for text in picture.iter(f"{SVG}text"):
        size = float(text.get("font-size", 0))
        wide = width_of(text.text or "", size, bold=text.get("font-weight") == "700")
        share = {"start": 0.0, "middle": 0.5, "end": 1.0}[text.get("text-anchor", "start")]
        left, base = float(text.get("x", 0)) - share * wide, float(text.get("y", 0))
        found.append((left, base - 0.75 * size, left + wide, base + 0.2 * size))
    return found
