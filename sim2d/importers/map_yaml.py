"""Reads the `.yaml` beside a ROS map_server picture: a few plain keys, read strictly, without a YAML library."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from sim2d.world.world_file import WorldError

_KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
_NEEDED = _KEYS[:6]
_MODES = ("trinary", "scale", "raw")
SCALES_M = (0.001, 1.0)  # metres per pixel, least and most


@dataclass(frozen=True, slots=True)
class MapYaml:
    """The contents of the file. origin: x, y (m) and yaw (rad) of the picture's lower left corner."""

    image: str
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied: float
    free: float
    mode: str


def read_map_yaml(name: str, text: str) -> MapYaml:
    """Read the text of a file. Raises WorldError, which names file, line, value and what would be right."""
    found = _pairs(name, text)
    for key in _NEEDED:
        if key not in found:
            raise WorldError(f"{name}: {key} is missing; a map_server file has {', '.join(_NEEDED)}")
    image, line = found["image"]
    if not image or "/" in image or "\\" in image or image in (".", ".."):
        raise WorldError(
            f"{name}: line {line}: image: got {image!r}; must be the plain name of a picture that lies beside this file"
        )
    resolution = _number(name, found, "resolution", *SCALES_M, unit=" metres a pixel")
    occupied = _number(name, found, "occupied_thresh", 0.0, 1.0)
    free = _number(name, found, "free_thresh", 0.0, 1.0)
    if free >= occupied:
        raise WorldError(
            f"{name}: line {found['free_thresh'][1]}: free_thresh: got {free:g}; must be below occupied_thresh, {occupied:g}"
        )
    negate = _number(name, found, "negate", 0, 1)
    if negate not in (0, 1):
        raise WorldError(f"{name}: line {found['negate'][1]}: negate: got {found['negate'][0]}; must be 0 or 1")
    mode, line = found.get("mode", ("trinary", 0))
    if mode not in _MODES:
        raise WorldError(f"{name}: line {line}: mode: got {mode!r}; expected one of: {', '.join(_MODES)}")
    return MapYaml(image, resolution, _origin(name, *found["origin"]), bool(negate), occupied, free, mode)


def _pairs(name: str, text: str) -> dict[str, tuple[str, int]]:
    """Key -> (value, line). Understands `key: value`, quotes, comments, `[a, b, c]` and lists of `- a` lines."""
    found: dict[str, tuple[str, int]] = {}
    last = ""
    for number, raw in enumerate(text.lstrip("\ufeff").splitlines(), 1):
        line = re.sub(r"(^|\s)#.*$", "", raw).rstrip()
        if not line.strip() or line.strip() in ("---", "..."):
            continue
        item = re.fullmatch(r"\s*-\s+(\S.*)", line)
        if item and last and found[last][0].startswith("["):
            value, at = found[last]
            found[last] = (f"{value}{', ' if len(value) > 1 else ''}{item[1]}", at)
            continue
        pair = re.fullmatch(r"([A-Za-z_]+)\s*:(?:\s+(.*))?", line)
        if pair is None:
            raise WorldError(f"{name}: line {number}: got {raw.strip()[:60]!r}; expected `key: value`")
        key, value = pair[1], (pair[2] or "").strip()
        if key not in _KEYS:
            raise WorldError(f"{name}: line {number}: unknown key {key!r}; expected one of: {', '.join(_KEYS)}")
        if key in found:
            raise WorldError(f"{name}: line {number}: {key} is there twice, first on line {found[key][1]}")
        if len(value) > 1 and value[0] == value[-1] and value[0] in "'\"":
            value = value[1:-1]
        found[key] = (value or "[", number)
        last = key
    return found


def _number(name: str, found: dict[str, tuple[str, int]], key: str, low: float, high: float, unit: str = "") -> float:
    text, line = found[key]
    text = {"true": "1", "false": "0"}.get(text.lower(), text)
    try:
        value = float(text)
    except ValueError:
        raise WorldError(f"{name}: line {line}: {key}: got {text!r}; must be a number") from None
    if not low <= value <= high:
        raise WorldError(f"{name}: line {line}: {key}: got {text}; must be from {low:g} to {high:g}{unit}")
    return value


def _origin(name: str, text: str, line: int) -> tuple[float, float, float]:
    try:
        x, y, yaw = (float(part) for part in text.strip("[] ").split(","))
    except ValueError:
        raise WorldError(f"{name}: line {line}: origin: got {text}; must be [x, y, yaw]: metres, radians") from None
    if not (abs(x) <= 9000 and abs(y) <= 9000 and math.isfinite(yaw)):
        raise WorldError(f"{name}: line {line}: origin: got {text}; x and y must be within 9000 m, all finite")
    return x, y, yaw
