"""Pictures of floor plans as worlds: light pixels are floor, dark ones are wall, those in between are outside.

The `.yaml` beside one is read as Nav2 and map_server read it: by PyYAML's safe loader, which finds keys and their texts
(nothing in the file makes objects), and strictly in its values. test_import_refusals.py.
"""

from __future__ import annotations

import math
import struct
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import Any, cast

import cv2
import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

from sim2d.importers.plan import Dresser, plan_world
from sim2d.importers.trace import choose_floor, ring_area, simplify, trace
from sim2d.world.world import Wall, World
from sim2d.world.world_file import WorldError

PICTURES = (".pgm", ".png", ".bmp", ".jpg", ".jpeg", ".ppm", ".pbm", ".webp", ".tif", ".tiff", ".gif")
_FORMATS = ("PPM", "PNG", "BMP", "JPEG", "WEBP", "TIFF", "GIF")  # PPM reads .pgm and .pbm, too
MOST_PIXELS = 16_000_000
MOST_SIDE = 12_000
SPECK_PX = 9  # obstacles with a smaller area, in pixels, are noise
_SLIVER_PX = 3  # floor narrower than this is taken for a gap between echoes ...
_SLIVER_M = 0.3  # ... if it is also too narrow for any robot


def picture_world(
    name: str,
    data: bytes,
    about: MapYaml,
    seed: int,
    radius_m: float,
    speck_px: int = SPECK_PX,
    tell: Tell = lambda _: None,
) -> World:
    """The world that a picture shows. about: scale, origin and thresholds. Raises WorldError.

    What is transparent shows the paper beneath, which is floor, as in any viewer.
    """
    grey, veiled = read_picture(name, data, 0 if about.negate else 255)
    free = free_pixels(grey, veiled, about)[::-1]
    if veiled.any() and about.mode == "trinary":
        if free.all():
            raise WorldError(
                f"{name}: no pixel is wall: what is transparent counts as white paper, and nothing on it is dark; are its "
                "lines light, for a dark ground?"
            )
        tell(f"{name}: {veiled.mean():.0%} of it is transparent, which counts as white paper")
    if not free.any():
        raise WorldError(f"{name}: {_no_floor(grey, about)}")
    scale = about.resolution
    floor = choose_floor(name, without_slivers(free, scale), scale, radius_m)
    rings = sorted(trace(floor.mask), key=ring_area, reverse=True)
    rings = [simplify(ring) for ring in rings if ring_area(ring) > 0 or -ring_area(ring) >= speck_px]
    dresser, walls = Dresser(seed), list[Wall]()
    for ring in rings:
        thin = len(ring) == 2  # simplified to a line
        points = ring if thin else np.concatenate([ring, ring[:1]])
        walls += dresser.line(_placed(points, about), "both" if thin else "left", outer=ring is rings[0])
    starts = np.column_stack([_placed(floor.starts[:, :2], about), floor.starts[:, 2] + about.origin[2]])
    return plan_world(name, tuple(walls), starts, f"a picture of {free.shape[1]} x {free.shape[0]} pixels", radius_m)


def free_pixels(grey: NDArray[np.uint8], veiled: NDArray[np.bool_], about: MapYaml) -> NDArray[np.bool_]:
    """Which pixels are floor, by the rules of map_server. veiled: not fully opaque; unknown in mode `scale`."""
    if about.mode == "raw":  # the pixel is the occupancy in per cent; above 100 it is unknown
        return (grey <= 100) & (grey / 100.0 < about.free)
    occupied = (grey if about.negate else 255 - grey.astype(np.float64)) / 255.0
    free = occupied < about.free
    return free & ~veiled if about.mode == "scale" else free


def _no_floor(grey: NDArray[np.uint8], about: MapYaml) -> str:
    clear = grey if about.mode == "raw" or about.negate else 255 - grey
    row, column = np.unravel_index(np.argmin(clear), clear.shape)
    rule = "below" if about.mode == "raw" else f"{'dark' if about.negate else 'light'}, with an occupancy below"
    return (
        f"no pixel is floor: the nearest to it, in column {column} of row {row}, has grey {grey[row, column]}; floor is "
        f"{rule} {about.free:g}"
    )


def without_slivers(free: NDArray[np.bool_], scale_m: float) -> NDArray[np.bool_]:
    """Remove floor that is at most two pixels wide: rays of a scanner through a window, gaps in a pitted wall."""
    if (_SLIVER_PX - 1) * scale_m > _SLIVER_M:
        return free
    kernel = np.ones((_SLIVER_PX, _SLIVER_PX), np.uint8)
    padded = np.pad(free, _SLIVER_PX).astype(np.uint8)
    opened = cv2.morphologyEx(padded, cv2.MORPH_OPEN, kernel)
    return opened[_SLIVER_PX:-_SLIVER_PX, _SLIVER_PX:-_SLIVER_PX].astype(np.bool_)


def _placed(pixels: NDArray[np.generic], about: MapYaml) -> NDArray[np.float64]:
    """From pixels (k, 2), counted from the lower left corner, to metres, rounded to the millimetre."""
    x, y, yaw = about.origin
    c, s = math.cos(yaw), math.sin(yaw)
    metres = pixels.astype(np.float64) * about.resolution
    right, up = metres[:, 0], metres[:, 1]
    return np.round(np.column_stack([x + c * right - s * up, y + s * right + c * up]), 3)


def read_picture(name: str, data: bytes, paper: int = 255) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Grey levels (rows, columns), top row first, each the mean of the three colours as they look on `paper`, a grey level;
    and where a pixel is not fully opaque. It is turned as whoever took it held the camera (EXIF).

    Raises WorldError if the data are no picture, broken, of more than 8 bits, or too large. Their size is checked before they
    are unpacked.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our own limit is far below Pillow's
            picture = Image.open(BytesIO(data), formats=_FORMATS)
        width, height = picture.size
        if max(width, height) > MOST_SIDE or width * height > MOST_PIXELS:
            raise WorldError(
                f"{name}: {width} x {height} pixels; at most {MOST_PIXELS / 1e6:g} million, {MOST_SIDE} a side"
            )
        if picture.mode.startswith(("I", "F")):
            raise WorldError(f"{name}: more than 8 bits a pixel (mode {picture.mode}); save it with 8, 0 to 255")
        rgba = np.asarray(_opaque_or_not(ImageOps.exif_transpose(picture)))
    except UnidentifiedImageError:
        raise WorldError(
            f"{name}: not a picture that can be read; expected PGM, PNG, BMP, JPEG, WebP, TIFF or GIF"
        ) from None
    except WorldError:
        raise
    except Image.DecompressionBombError:
        raise WorldError(f"{name}: hundreds of millions of pixels; at most {MOST_PIXELS / 1e6:g} million") from None
    except (OSError, ValueError, SyntaxError, TypeError, LookupError, EOFError, struct.error) as error:
        raise WorldError(f"{name}: the picture is broken: {error}") from None
    grey, veiled = rgba[:, :, :3].astype(np.uint16).sum(axis=2) / 3.0, rgba[:, :, 3] < 255
    if veiled.any():
        share = rgba[:, :, 3] / 255.0
        grey = share * grey + (1.0 - share) * paper
    return np.rint(grey).astype(np.uint8), veiled


def _opaque_or_not(picture: Image.Image) -> Image.Image:
    """As RGBA, of whatever colours."""
    if "A" in picture.mode or "a" in picture.mode or "transparency" in picture.info or picture.mode in ("P", "L", "1"):
        return picture.convert("RGBA")
    return picture.convert("RGB").convert("RGBA")


Tell = Callable[[str], None]  # is given a sentence about something that was taken in a way that one may want to know of

_NEEDED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_KEYS = (*_NEEDED, "mode")
_MODES = ("trinary", "scale", "raw")
_YES, _NO = ("true", "yes", "on", "y"), ("false", "no", "off", "n")
_WORDS: dict[str, str] = {**dict.fromkeys(_YES, "1"), **dict.fromkeys(_NO, "0")}
SCALES_M = (0.001, 1.0)  # metres per pixel, least and most


@dataclass(frozen=True, slots=True)
class MapYaml:
    """The contents of the file. image: as it is written, often a path of another machine; origin: x, y (m) and yaw (rad) of
    the picture's lower left corner."""

    image: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied: float
    free: float
    mode: str

    @property
    def picture(self) -> str:
        """The name of the picture, without the folders before it."""
        return self.image.replace("\\", "/").rsplit("/", 1)[-1].strip()


@dataclass(frozen=True, slots=True)
class _Value:
    """A scalar's text, or those of a list."""

    texts: tuple[str, ...]
    is_list: bool
    line: int

    def __str__(self) -> str:
        text = ", ".join(self.texts)
        return f"[{text}]" if self.is_list else text


def read_map_yaml(name: str, text: str, tell: Tell = lambda _: None) -> MapYaml:
    """Read the text of a file. Raises WorldError, which names file, line, value and what would be right."""
    found = _pairs(name, text, tell)
    for key in _NEEDED:
        if key not in found:
            others = ", ".join(repr(other[:40]) for other in found if other not in _KEYS)
            raise WorldError(
                f"{name}: {key} is missing; a map_server file has {', '.join(_NEEDED)}"
                + (others and f", and not {others}")
            )
    resolution = _number(name, found, "resolution", *SCALES_M, unit=" metres a pixel")
    occupied = _number(name, found, "occupied_thresh", 0.0, 1.0)
    free = _number(name, found, "free_thresh", 0.0, 1.0)
    if free >= occupied:
        raise WorldError(
            f"{name}: line {found['free_thresh'].line}: free_thresh: got {free:g}; must be below occupied_thresh, {occupied:g}"
        )
    negate = _number(name, found, "negate", 0, 1)
    if negate not in (0, 1):
        raise WorldError(f"{name}: line {found['negate'].line}: negate: got {found['negate']}; must be 0 or 1")
    mode = found.get("mode", _Value(("trinary",), False, 0))
    if str(mode) not in _MODES:
        raise WorldError(f"{name}: line {mode.line}: mode: got {str(mode)!r}; expected one of: {', '.join(_MODES)}")
    origin = _origin(name, found["origin"], tell)
    about = MapYaml(str(found["image"]), resolution, origin, bool(negate), occupied, free, str(mode))
    if about.picture in ("", ".", "..") or "\0" in about.picture:
        raise WorldError(f"{name}: line {found['image'].line}: image: got {about.image!r}; must name a picture")
    return about


class _Loader(yaml.SafeLoader):
    """Without aliases, by which a small file becomes a huge one; no map has any."""

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event: Any = cast(Any, self).peek_event()
        if isinstance(event, yaml.AliasEvent):
            raise yaml.MarkedYAMLError(problem="an alias, as no map has", problem_mark=cast(Any, event).start_mark)
        return super().compose_node(parent, index)


def _pairs(name: str, text: str, tell: Tell) -> dict[str, _Value]:
    try:
        every: Iterator[yaml.Node] = cast(Any, yaml).compose_all(text, Loader=_Loader)
        documents = [node for node in every if not _empty(node)]
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f"line {error.problem_mark.line + 1}: "
        raise WorldError(f"{name}: {line}not YAML: {error.problem or error.context}") from None
    except RecursionError:
        raise WorldError(f"{name}: not YAML: nested too deep") from None
    except (yaml.YAMLError, ValueError) as error:
        raise WorldError(f"{name}: not YAML: {' '.join(str(error).split())[:200]}") from None
    if len(documents) != 1 or not isinstance(documents[0], yaml.MappingNode):
        line = documents[-1].start_mark.line + 1 if documents else 1
        raise WorldError(f"{name}: line {line}: expected one list of `key: value`, with {', '.join(_NEEDED)}")
    found: dict[str, _Value] = {}
    for key_node, value_node in documents[0].value:
        key, value = _value(key_node), _value(value_node)
        if str(key) in found:
            raise WorldError(
                f"{name}: line {key.line}: {str(key)[:40]} is there twice, first on line {found[str(key)].line}"
            )
        found[str(key)] = value
    for key, value in found.items():
        if key not in _KEYS:
            tell(f"{name}: line {value.line}: {key[:40]!r} is not used; used are {', '.join(_KEYS)}")
    return found


def _empty(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.value == ""


def _value(node: yaml.Node) -> _Value:
    line = node.start_mark.line + 1
    if isinstance(node, yaml.SequenceNode):
        return _Value(tuple(str(item.value)[:80] for item in node.value), True, line)
    return _Value((node.value if isinstance(node, yaml.ScalarNode) else "{...}",), False, line)


def _number(name: str, found: dict[str, _Value], key: str, low: float, high: float, unit: str = "") -> float:
    given = found[key]
    text = _WORDS.get(str(given).lower(), str(given))
    try:
        value = _float(text)
    except ValueError:
        raise WorldError(f"{name}: line {given.line}: {key}: got {str(given)[:80]!r}; must be a number") from None
    if not low <= value <= high:
        raise WorldError(f"{name}: line {given.line}: {key}: got {text[:80]}; must be from {low:g} to {high:g}{unit}")
    return value


def _origin(name: str, given: _Value, tell: Tell) -> tuple[float, float, float]:
    texts = given.texts if given.is_list else str(given).strip("[] ").split(",")  # some write the list in quotes
    try:
        x, y, yaw = (_float(text) for text in texts)
    except ValueError:
        raise WorldError(
            f"{name}: line {given.line}: origin: got {str(given)[:80]}; must be [x, y, yaw]: metres, radians"
        ) from None
    if not (abs(x) <= 9000 and abs(y) <= 9000):
        raise WorldError(
            f"{name}: line {given.line}: origin: got {str(given)[:80]}; x and y must be within 9000 m, all finite"
        )
    if not math.isfinite(yaw):
        tell(f"{name}: line {given.line}: origin: the yaw is {texts[2].strip()}, no angle; 0 is taken")
        yaw = 0.0
    return x, y, yaw


def _float(text: str) -> float:
    """A number as YAML or C write it. ValueError: it is none."""
    plain = text.strip().lower()
    return float(plain.replace(".", "", 1) if plain.lstrip("+-") in (".nan", ".inf") else plain)
