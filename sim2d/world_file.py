"""World files: JSON, schema 1, checked when loaded. Every complaint names file, item, value and what would be right."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim2d.free_space import FreeSpace
from sim2d.params import SimParams
from sim2d.texture import TEXTURES
from sim2d.world import Panel, Place, Rgb, Start, Wall, World

WORLDS = Path(__file__).parent / "worlds"
DEFAULT_WORLD = "office"
ROBOT_HEIGHT_M = 0.6  # what hangs higher does not touch the robot
MOST_M = 200.0  # floor and textures are held in full: larger worlds would fill the memory
MOST_WALL_M2 = 6000.0
_JOIN_M = 1e-6


class WorldError(ValueError):
    """A world file that cannot be used, and why."""


def world_names() -> tuple[tuple[str, str], ...]:
    """(name, title) of the worlds that come with the package, the default first."""
    names = sorted((path.stem for path in WORLDS.glob("*.json")), key=lambda name: (name != DEFAULT_WORLD, name))
    return tuple((name, str(json.loads((WORLDS / f"{name}.json").read_text("utf-8"))["title"])) for name in names)


def load_world(name_or_path: str | Path = DEFAULT_WORLD, robot_radius_m: float | None = None) -> World:
    """The world of this name, or in this file. Raises WorldError.

    `robot_radius_m`: of the robot that will start in it; without it the default robot's.
    """
    path = _find(name_or_path)
    try:
        raw = json.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise WorldError(f"{path.name}: cannot be read: {error}") from error
    except json.JSONDecodeError as error:
        raise WorldError(f"{path.name}: not JSON: line {error.lineno}, column {error.colno}: {error.msg}") from error
    try:
        file = _File.model_validate(raw)
    except ValidationError as error:
        raise WorldError(f"{path.name}: {_sentence(error)}") from None
    world = _world(file)
    _check(path.name, world, SimParams().robot_radius_m if robot_radius_m is None else robot_radius_m)
    return world


def _find(name_or_path: str | Path) -> Path:
    """One of ours by its name, else a file. Who takes names from strangers must compare with `world_names` first."""
    text = str(name_or_path)
    known = [name for name, _ in world_names()]
    if text in known:
        return WORLDS / f"{text}.json"
    path = Path(name_or_path)
    if path.suffix == ".json" and path.is_file():
        return path
    raise WorldError(f"no world {text!r}; expected one of: {', '.join(known)}; or the path of a .json file")


# ---------------------------------------------------------------- the schema


class _Item(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


_Number = Annotated[float, Field(ge=-1000, le=1000)]
_Length = Annotated[float, Field(gt=0, le=1000)]
_Point = Annotated[list[_Number], Field(min_length=2, max_length=2)]
_Colour = Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")]
_Name = Annotated[str, Field(min_length=1, max_length=40)]


class _PanelItem(_Item):
    at: Annotated[float, Field(ge=0, le=1000)]
    width: _Length
    bottom: Annotated[float, Field(ge=0, le=20)]
    top: Annotated[float, Field(gt=0, le=20)]
    texture: Literal[*TEXTURES]  # type: ignore[valid-type]
    colour: _Colour
    seed: Annotated[int, Field(ge=0)] = 0
    side: Literal["left", "right", "both"] = "left"


class _WallItem(_Item):
    start: Annotated[_Point, Field(alias="from")]
    end: Annotated[_Point, Field(alias="to")]
    kind: Literal["wall", "partition", "desk", "door", "window", "screen"] = "wall"
    height: Annotated[float, Field(gt=0, le=20)]
    colour: _Colour
    outer: bool = False
    bottom: Annotated[float, Field(ge=0, le=20)] = 0.0
    panels: list[_PanelItem] = []


class _StartItem(_Item):
    name: _Name
    x: _Number
    y: _Number
    heading_deg: Annotated[float, Field(ge=-360, le=360)]


class _PlaceItem(_Item):
    name: _Name
    x: _Number
    y: _Number


class _File(_Item):
    format: Literal[1]
    name: _Name
    title: Annotated[str, Field(min_length=1, max_length=80)]
    source: str
    floor_colour: _Colour
    ceiling_colour: _Colour
    walls: Annotated[list[_WallItem], Field(min_length=3, max_length=2000)]
    starts: Annotated[list[_StartItem], Field(min_length=1)]
    places: list[_PlaceItem] = []


def _sentence(error: ValidationError) -> str:
    """The first complaint: `walls[3].height: got -1; input should be greater than 0`."""
    first = error.errors(include_url=False)[0]
    where = ""
    for part in first["loc"]:
        where += f"[{part}]" if isinstance(part, int) else f".{part}" if where else part
    message = first["msg"][0].lower() + first["msg"][1:]
    if first["type"] == "extra_forbidden":
        message = "unknown key; take it out or correct its spelling"
    got = "" if first["type"] in ("missing", "model_type") else f" got {first['input']!r};"
    return f"{where or 'file'}:{got} {message}"


def _world(file: _File) -> World:
    walls = tuple(_wall(item) for item in file.walls)
    starts = tuple(Start(s.name, s.x, s.y, math.radians(s.heading_deg)) for s in file.starts)
    places = tuple(Place(p.name, p.x, p.y) for p in file.places)
    return World(
        file.name, file.title, file.source, walls, starts, places, _rgb(file.floor_colour), _rgb(file.ceiling_colour)
    )


def _wall(item: _WallItem) -> Wall:
    (x1, y1), (x2, y2) = item.start, item.end
    panels = tuple(_panel(panel) for panel in item.panels)
    return Wall(x1, y1, x2, y2, item.kind, item.height, _rgb(item.colour), item.outer, item.bottom, panels)


def _panel(item: _PanelItem) -> Panel:
    return Panel(item.at, item.width, item.bottom, item.top, item.texture, _rgb(item.colour), item.seed, item.side)


def _rgb(text: str) -> Rgb:
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


# ---------------------------------------------------------------- what no schema can say


def _check(name: str, world: World, radius: float) -> None:
    for i, wall in enumerate(world.walls):
        _check_wall(f"{name}: walls[{i}]", wall)
    _check_outline(name, world)
    _check_size(name, world)
    free = FreeSpace(world, radius)
    for kind, points in (("starts", world.starts), ("places", world.places)):
        for i, point in enumerate(points):
            refusal = free.refusal(point.x, point.y)
            if refusal is not None:
                raise WorldError(f"{name}: {kind}[{i}] ({point.name}): {refusal}")


def _check_wall(where: str, wall: Wall) -> None:
    if wall.length < 0.01:
        raise WorldError(
            f"{where}: no length: runs from ({wall.x1:g}, {wall.y1:g}) to ({wall.x2:g}, {wall.y2:g}); "
            "its ends must be at least 0.01 m apart"
        )
    if wall.bottom >= wall.height:
        raise WorldError(f"{where}: bottom {wall.bottom:g} must be below its height {wall.height:g}")
    if not wall.stands and wall.bottom < ROBOT_HEIGHT_M:
        raise WorldError(f"{where}: bottom {wall.bottom:g} must be 0 or at least {ROBOT_HEIGHT_M} m, above the robot")
    for j, panel in enumerate(wall.panels):
        if panel.at + panel.width > wall.length + 1e-9:
            raise WorldError(
                f"{where}.panels[{j}]: reaches to {panel.at + panel.width:g} m; the wall is {wall.length:g} m long"
            )
        if not wall.bottom <= panel.bottom < panel.top <= wall.height:
            raise WorldError(
                f"{where}.panels[{j}]: from {panel.bottom:g} up to {panel.top:g} m; must be upright and "
                f"between the wall's {wall.bottom:g} and {wall.height:g} m"
            )


def _check_outline(name: str, world: World) -> None:
    """Outer walls come first, each begins where the one before ends, and the ring runs counter-clockwise."""
    outer = [i for i, wall in enumerate(world.walls) if wall.outer]
    if len(outer) < 3:
        raise WorldError(f"{name}: walls: {len(outer)} are outer; at least 3 must close the outline")
    if outer != list(range(len(outer))):
        raise WorldError(f"{name}: walls[{outer[-1]}]: is outer but comes after inner ones; the outer walls come first")
    for i, k in [*pairwise(outer), (outer[-1], outer[0])]:
        ends, begins = world.walls[i], world.walls[k]
        if math.hypot(begins.x1 - ends.x2, begins.y1 - ends.y2) > _JOIN_M:
            raise WorldError(
                f"{name}: walls[{i}]: the outline is open: it ends at ({ends.x2:g}, {ends.y2:g}) but walls[{k}] begins "
                f"at ({begins.x1:g}, {begins.y1:g}); each outer wall must begin where the one before ends"
            )
        if not ends.stands:
            raise WorldError(f"{name}: walls[{i}]: bottom {ends.bottom:g} must be 0 in the outer wall")
    ring = world.outline
    after = np.roll(ring, -1, axis=0)
    area = 0.5 * float(np.sum(ring[:, 0] * after[:, 1] - ring[:, 1] * after[:, 0]))
    if area <= 0:
        raise WorldError(f"{name}: walls[0]: the outline encloses {area:g} m^2; it must run counter-clockwise")


def _check_size(name: str, world: World) -> None:
    x0, y0, x1, y1 = world.bounds
    if max(x1 - x0, y1 - y0) > MOST_M:
        raise WorldError(
            f"{name}: walls: the outline spans {x1 - x0:g} by {y1 - y0:g} m; at most {MOST_M:g} m each way"
        )
    area = sum(wall.length * (wall.height - wall.bottom) for wall in world.walls)
    if area > MOST_WALL_M2:
        raise WorldError(f"{name}: walls: {area:.0f} m^2 of wall in all; at most {MOST_WALL_M2:g}")
