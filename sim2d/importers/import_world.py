"""Importing worlds: from ROS map_server files, pictures and vector maps, and from our own world files."""

from __future__ import annotations

import math
import os
from pathlib import Path, PurePath
from typing import Any, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from sim2d.importers.picture_map import PICTURES, SCALES_M, MapYaml, Tell, picture_world, read_map_yaml
from sim2d.importers.plan import Dresser, plan_world
from sim2d.importers.trace import choose_floor
from sim2d.params import SimParams
from sim2d.world.json_lines import line_of
from sim2d.world.world import World
from sim2d.world.world_check import MOST_M
from sim2d.world.world_file import WorldError, load_world, parse_json, world_from_json, world_names
from sim2d.world.world_schema import MOST_WALLS

YAMLS = (".yaml", ".yml")
DRAWINGS = (
    ".svg",
    ".svgz",
    ".pdf",
    ".eps",
    ".ps",
    ".ai",
    ".dxf",
    ".dwg",
    ".drawio",
    ".vsdx",
    ".odg",
    ".ifc",
    ".heic",
    ".avif",
)
MOST_BYTES = {".json": 1_000_000, ".yaml": 65_536, ".yml": 65_536}  # of an uploaded file
MOST_WORLD_BYTES = 10_000_000  # a world of 10,000 walls with posters takes 7.7 MB
MOST_PICTURE_BYTES = 16_000_000
_OCCUPIED, _FREE = 0.65, 0.196  # the defaults of map_server


def _quiet(_sentence: str) -> None:
    pass


def import_world(
    name: str,
    files: dict[str, bytes],
    scale_m: float | None = None,
    seed: int = 0,
    robot_radius_m: float | None = None,
    tell: Tell = _quiet,
) -> World:
    """The world in the file `name`. files: name -> contents, of this file and of all that it refers to.

    scale_m: metres per pixel, for a plain picture only. seed: for the looks of bare walls; the same seed gives the same
    world. robot_radius_m: of the robot that will start in it. tell: is given sentences about what was left unused or
    taken in another way than it is written. Nothing is read from or written to the disk.
    Raises WorldError, which names file, line or pixel, value and what would be right.
    """
    for given, data in files.items():
        limit = _most_bytes(given, data)
        if len(data) > limit:
            raise WorldError(f"{given}: {len(data)} bytes; at most {limit}")
    return _import(name, files, scale_m, seed, robot_radius_m, tell)


def import_file(
    path: str | Path,
    scale_m: float | None = None,
    seed: int = 0,
    robot_radius_m: float | None = None,
    tell: Tell = _quiet,
) -> World:
    """The world in a file on disk. The picture of a map_server file must lie beside it. Raises WorldError."""
    path = Path(path)
    try:
        files = {path.name: path.read_bytes()}
        if path.suffix.lower() in YAMLS:
            about = read_map_yaml(path.name, _text(path.name, files[path.name]))
            files[about.picture] = _picture_of(path, about).read_bytes()
    except OSError as error:
        raise WorldError(f"{error.filename}: cannot be read: {error.strerror}") from None
    return _import(path.name, files, scale_m, seed, robot_radius_m, tell)


def _picture_of(path: Path, about: MapYaml) -> Path:
    """The file that a map names: where it says, if that is in the map's folder, else the one of that name beside it. Never
    one from another folder, also not by a link. WorldError: there is none."""
    homes = {path.parent.resolve(), path.resolve().parent}  # a map that is linked to its place brings its picture along
    for place in (path.parent / about.image.replace("\\", "/"), path.parent / about.picture):
        try:
            found = place.resolve()
            if found.is_file() and any(found.is_relative_to(home) for home in homes):
                return found
        except (OSError, RuntimeError, ValueError):
            continue
    raise WorldError(
        f"{path.name}: image: got {about.image!r}, but there is no file {about.picture!r} in {path.parent}; put the map's "
        "picture beside it under that name"
    )


def open_world(
    name_or_path: str | Path,
    scale_m: float | None = None,
    seed: int = 0,
    robot_radius_m: float | None = None,
    tell: Tell = _quiet,
) -> World:
    """A world by its name, or anything that can be imported from a file. Raises WorldError."""
    path = Path(name_or_path)
    if str(name_or_path) in dict(world_names()):
        if scale_m is not None:
            raise WorldError(f"{name_or_path}: got a scale of {scale_m:g} m a pixel; only plain pictures take one")
        return load_world(name_or_path, robot_radius_m)
    if not os.path.isfile(path):  # False also for what can be no name
        return load_world(name_or_path, robot_radius_m)
    return import_file(path, scale_m, seed, robot_radius_m, tell)


def _import(
    name: str, files: dict[str, bytes], scale_m: float | None, seed: int, radius_m: float | None, tell: Tell
) -> World:
    radius = SimParams().robot_radius_m if radius_m is None else radius_m
    if name not in files:
        raise WorldError(f"{name}: is not among the files given: {', '.join(sorted(files)) or 'none'}")
    suffix = PurePath(name).suffix.lower()
    if suffix in YAMLS:
        _require_no_scale(name, scale_m, "it says itself how long a pixel is (resolution)")
        about = read_map_yaml(name, _text(name, files[name]), tell)
        if about.picture not in files:
            raise WorldError(f"{name}: image: {about.picture!r} was not given with it; put both together")
        if about.image != about.picture:
            tell(f"{name}: image: {about.image!r} is taken for {about.picture!r} beside it")
        return picture_world(about.picture, files[about.picture], about, seed, radius, tell=tell)
    if suffix in PICTURES:
        return picture_world(name, files[name], _plain(name, scale_m), seed, radius, tell=tell)
    if suffix == ".json":
        _require_no_scale(name, scale_m, "a world or a vector map is in metres")
        return _from_json(name, _text(name, files[name]), seed, radius)
    if suffix in DRAWINGS:
        raise WorldError(
            f"{name}: a drawing in {suffix[1:].upper()} is not read; save or export it as PNG, and give the scale of that, in "
            "metres a pixel"
        )
    raise WorldError(
        f"{name}: cannot be imported; expected .json (a world, or a list of segments), "
        f"{' or '.join(YAMLS)} (map_server), or a picture: {', '.join(PICTURES)}"
    )


def _require_no_scale(name: str, scale_m: float | None, why: str) -> None:
    if scale_m is not None:
        raise WorldError(f"{name}: got a scale of {scale_m:g} m a pixel; only plain pictures take one, and {why}")


def _from_json(name: str, text: str, seed: int, radius: float) -> World:
    raw: object = parse_json(text, name)
    if isinstance(raw, list):
        return vector_world(name, text, cast("list[object]", raw), seed, radius)
    if isinstance(raw, dict) and "format" not in raw:
        keys = [*cast("dict[str, object]", raw)]
        raise WorldError(
            f"{name}: an object with keys {', '.join(keys[:6]) or 'none'}; expected a world file, which has "
            '"format": 1, or a list of wall segments'
        )
    return world_from_json(text, name, radius)


def _most_bytes(name: str, data: bytes) -> int:
    """The largest size of an uploaded file. Only JSON that begins with { can be a world, so only it may be as large."""
    suffix = PurePath(name).suffix.lower()
    if suffix == ".json" and data[:100].lstrip().startswith(b"{"):
        return MOST_WORLD_BYTES
    return MOST_BYTES.get(suffix, MOST_PICTURE_BYTES)


def _plain(name: str, scale_m: float | None) -> MapYaml:
    if scale_m is None:
        raise WorldError(f"{name}: a plain picture needs its scale, metres a pixel")
    if not SCALES_M[0] <= scale_m <= SCALES_M[1]:
        raise WorldError(
            f"{name}: got a scale of {scale_m:g}; must be from {SCALES_M[0]:g} to {SCALES_M[1]:g} m a pixel"
        )
    return MapYaml(name, scale_m, (0.0, 0.0, 0.0), False, _OCCUPIED, _FREE, "trinary")


def _text(name: str, data: bytes) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise WorldError(f"{name}: not text: byte {error.start} is {data[error.start]:#04x}; must be UTF-8") from None


MARGIN_M = 0.3  # from the outermost walls to the fence around them: too narrow for the robot
_LEAST_M = 0.01  # shorter segments are left out; such files may contain some of length 0


def vector_world(name: str, text: str, items: list[Any], seed: int, radius_m: float) -> World:
    """items: each {"p0": {"x", "y"}, "p1": {"x", "y"}}, [x1, y1, x2, y2] or [[x1, y1], [x2, y2]]. Raises WorldError."""
    if len(items) > MOST_WALLS:
        raise WorldError(f"{name}: {len(items)} segments; at most {MOST_WALLS}")
    segments = np.array([_segment(name, text, i, item) for i, item in enumerate(items)]).reshape(-1, 4)
    segments = segments[np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]) >= _LEAST_M]
    if not len(segments):
        raise WorldError(f"{name}: {len(items)} segments, none of them {_LEAST_M} m long or longer; a plan needs walls")
    low = segments.reshape(-1, 2).min(axis=0) - MARGIN_M
    high = segments.reshape(-1, 2).max(axis=0) + MARGIN_M
    if max(high - low) > MOST_M:
        raise WorldError(
            f"{name}: spans {high[0] - low[0]:.0f} by {high[1] - low[1]:.0f} m; at most {MOST_M:g} m each way"
        )
    cell = max(0.05, float(max(high - low)) / 4000)
    floor = choose_floor(name, _free(segments, low, high, cell), cell, radius_m)
    ring = np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])
    dresser = Dresser(seed)
    walls = dresser.line(ring, "left", outer=True)
    for segment in segments:
        walls += dresser.line(segment.reshape(2, 2), "both")
    starts = floor.starts * (cell, cell, 1.0) + (*low, 0.0)
    return plan_world(name, tuple(walls), starts, "a vector map", radius_m)


def _numbers(item: Any) -> list[Any] | None:
    """The numbers of an item in one of the three forms, not yet checked; None if it has none of these forms."""
    if isinstance(item, dict):
        ends: list[Any] = [cast("dict[str, Any]", item).get(end) for end in ("p0", "p1")]
        return (
            [end.get(axis) for end in ends for axis in ("x", "y")] if all(isinstance(e, dict) for e in ends) else None
        )
    if not isinstance(item, list):
        return None
    parts = cast("list[Any]", item)
    if len(parts) == 2 and all(isinstance(end, list) for end in parts):
        return [*parts[0], *parts[1]]
    return parts


def _segment(name: str, text: str, i: int, item: Any) -> tuple[float, ...]:
    numbers = _numbers(item)
    if numbers is None or len(numbers) != 4 or not all(type(n) in (int, float) and abs(n) < 10_000 for n in numbers):
        raise WorldError(
            f"{name}: [{i}]: got {str(item)[:80]}; must be "
            '{"p0": {"x": 0, "y": 0}, "p1": {"x": 1, "y": 0}}, [x1, y1, x2, y2] or [[x1, y1], [x2, y2]]: finite, in metres '
            f"(line {line_of(text, (i,))})"
        )
    return tuple(map(float, numbers))


def _free(
    segments: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64], cell: float
) -> NDArray[np.bool_]:
    """The plan as pixels of `cell` metres, row 0 at the bottom; False where there is a wall."""
    columns, rows = (math.ceil(k) for k in (high - low) / cell)
    plan = np.ones((rows, columns), np.uint8)
    ends = np.floor((segments.reshape(-1, 2) - low) / cell).astype(np.int32).reshape(-1, 2, 2)
    for a, b in ends.tolist():
        cv2.line(plan, a, b, 0)
    return plan.astype(np.bool_)
