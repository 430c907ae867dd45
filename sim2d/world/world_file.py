"""World files: JSON, format 1, checked when loaded. Errors name file, item, line, value and what would be right."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from sim2d.params import SimParams
from sim2d.world import DEFAULT_WORLD, own_worlds
from sim2d.world.json_lines import deeper_than, line_of
from sim2d.world.world import World
from sim2d.world.world_schema import WorldFile, world_to_json

if TYPE_CHECKING:
    from sim2d.world.world_check import Fault, Where

WORLDS = Path(__file__).parents[1] / "worlds"
SCHEMA = WORLDS / "schema.json"  # kept equal to `schema_text` by test_world_file.py::test_schema_is_published
MOST_BYTES = 16_000_000
MOST_LEVELS = 20  # a valid file has at most six
_TOO_DEEP = f"not a world: nested too deeply; at most {MOST_LEVELS} lists or objects can lie within one another"


class WorldError(ValueError):
    """Why a world file cannot be used, in words that can always be printed, whatever the file contains."""

    def __init__(self, words: str) -> None:
        super().__init__(words.encode("utf-8", "backslashreplace").decode())


@cache
def world_names() -> tuple[tuple[str, str], ...]:
    """(name, title) of the worlds that come with the program, the default first."""
    names = sorted(
        (path.stem for path in WORLDS.glob("*.json") if path != SCHEMA), key=lambda name: (name != DEFAULT_WORLD, name)
    )
    return tuple((name, str(json.loads((WORLDS / f"{name}.json").read_text("utf-8"))["title"])) for name in names)


def our_worlds() -> Iterator[tuple[str, World]]:
    """The same worlds with their names. What is in them is right: a test checks it."""
    for name, _ in world_names():
        file = f"{name}.json"
        yield name, world_as_written((WORLDS / file).read_text("utf-8"), file)


def load_world(name_or_path: str | Path = DEFAULT_WORLD, robot_radius_m: float | None = None) -> World:
    """The world of this name, or the one in this file. Raises WorldError.

    robot_radius_m: of the robot that will start in it; None: that of the default robot.
    """
    path = _find(name_or_path)
    try:
        if path.stat().st_size > MOST_BYTES:
            raise WorldError(f"{path.name}: {path.stat().st_size} bytes; a world has at most {MOST_BYTES}")
        text = path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise WorldError(f"{path.name}: cannot be read: {error}") from error
    return world_from_json(text, path.name, robot_radius_m)


def holds(path: Path, world: World) -> bool:
    """Whether the file describes exactly this world. A file that cannot be read does not."""
    try:
        text = path.read_text("utf-8")
        return text == world_to_json(world) or world_as_written(text, path.name) == world
    except (OSError, ValueError):
        return False


def world_from_json(text: str, file_name: str, robot_radius_m: float | None = None, *, begins: bool = True) -> World:
    """The world in the text of a file. file_name: for error messages only. Raises WorldError.

    begins: whether a robot is to begin in it, or is in it already.
    """
    try:
        world = world_as_written(text, file_name)
    except ValidationError as error:
        raise WorldError(next(_schema_complaints(error, file_name, text))) from None
    for complaint in _complaints(world, text, file_name, robot_radius_m, begins):
        raise WorldError(complaint)
    return world


def world_as_written(text: str, file_name: str) -> World:
    """The world in the text of a file, whose places and walls are not looked at. Raises WorldError, ValidationError."""
    return WorldFile.model_validate(parse_json(text, file_name)).world()


def complaints(text: str, file_name: str, robot_radius_m: float | None = None) -> list[str]:
    """Everything that is wrong with the text of a world file, in sentences. Some checks need walls that are valid."""
    try:
        world = world_as_written(text, file_name)
    except ValidationError as error:
        return list(_schema_complaints(error, file_name, text))
    except WorldError as error:
        return [str(error)]
    return list(_complaints(world, text, file_name, robot_radius_m))


def schema_text() -> str:
    """The JSON schema of world files."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **WorldFile.model_json_schema()}
    return json.dumps(schema, indent=2) + "\n"


def parse_json(text: str, file_name: str) -> Any:
    """The parsed text. Raises WorldError with line and column."""
    try:
        raw = json.loads(text)
    except json.JSONDecodeError as error:
        raise WorldError(f"{file_name}: not JSON: line {error.lineno}, column {error.colno}: {error.msg}") from error
    except ValueError:
        raise WorldError(f"{file_name}: a number has thousands of digits") from None
    except RecursionError:
        raise WorldError(f"{file_name}: {_TOO_DEEP}") from None
    if deeper_than(MOST_LEVELS, raw):
        raise WorldError(f"{file_name}: {_TOO_DEEP}")
    return raw


def item_complaint(error: ValidationError, kind: str) -> str:
    """The first thing that is wrong with one item of a list: `walls: height: got -1; input should be ...`."""
    return next(_schema_complaints(error, kind))


def fault_words(fault: Fault) -> str:
    """What is wrong and with which item, without file and line."""
    between = " " if fault.message.startswith("(") else ": "
    return f"{_path(fault.where)}{between}{fault.message}"


def _schema_complaints(error: ValidationError, name: str, text: str | None = None) -> Iterator[str]:
    """`walls[3].height: got -1; input should be greater than 0 (line 12)`."""
    for item in error.errors(include_url=False):
        message = item["msg"][0].lower() + item["msg"][1:]
        if item["type"] == "extra_forbidden":
            message = "unknown key; take it out or correct its spelling"
        got = "" if item["type"] in ("missing", "model_type", "too_long") else f" got {_short(item['input'])};"
        line = "" if text is None else _line(text, item["loc"])
        yield f"{name}: {_path(item['loc']) or 'file'}:{got} {message}{line}"


def _complaints(world: World, text: str, name: str, radius_m: float | None, begins: bool = True) -> Iterator[str]:
    from sim2d.world.world_check import world_faults  # takes kernels

    radius = SimParams().robot_radius_m if radius_m is None else radius_m
    for fault in world_faults(world, radius, begins=begins):
        yield f"{name}: {fault_words(fault)}{_line(text, fault.where)}"


def _find(name_or_path: str | Path) -> Path:
    """The file of a world by its name, ours or the user's; else the argument as a path. Code that accepts names from
    strangers must first compare them with `world_names` and `own_worlds.names`."""
    text = str(name_or_path)
    known = [name for name, _ in world_names()]
    if text in known:
        return WORLDS / f"{text}.json"
    own = [name for name, _ in own_worlds.names()]
    if text in own:
        return own_worlds.folder() / f"{text}.json"
    known += own
    path = Path(name_or_path)
    if path.suffix == ".json" and os.path.isfile(path):
        return path
    raise WorldError(f"no world {text!r}; expected one of: {', '.join(known)}; or the path of a .json file")


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:80] + "..."


def _path(where: Where) -> str:
    """`walls[3].panels[0]`."""
    path = ""
    for part in where:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else part
    return path


def _line(text: str, where: Where) -> str:
    return f" (line {line_of(text, where)})"
