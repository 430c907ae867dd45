"""Reads the `.yaml` beside a ROS map_server picture, as Nav2 and map_server do: by a YAML library, and strictly in its values.

PyYAML's safe loader finds keys and their texts; nothing in the file makes objects. test_import_refusals.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, cast

import yaml

from sim2d.world.world_file import WorldError

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
