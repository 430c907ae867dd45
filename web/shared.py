"""What the page shares with Python, written from the Python side: `python -m web.shared` after a change of either.

`static/shared.js` holds the names that the page uses at run time. `types/shared.d.ts` holds what only the type check
reads: the commands, the world file and the ids of the page's elements. `--check` says whether both are up to date.
"""

from __future__ import annotations

import json
import sys
from dataclasses import fields
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel

from ratslam_core.params import RatSlamParams
from ratslam_core.params.additions import ADDITIONS, Addition
from sim2d.world.world_schema import LISTS, WorldFile
from web.http.commands import MODELS
from web.http.security import LOOKS
from web.messages import EditStep, EventKind, GoalState, OfficeList
from web.messages.commands import EngineName
from web.panel.panel import TABS
from web.themes import THEMES
from web.viewer.camera_views import VIEWS

HERE = Path(__file__).parent
PAGES = {"Index": "index.html", "Docs": "docs/docs.html", "Vote": "lessons/vote.html"}
FILES = {"static/shared.js": lambda: names_text(), "types/shared.d.ts": lambda: types_text()}
_HEAD = "// Written by `python -m web.shared` from the models in Python: change those and run it again.\n"


def names_text() -> str:
    """The lists as JavaScript; the type of each is exactly its words."""
    world = WorldFile.model_json_schema()["$defs"]
    values = {
        "VIEWS": VIEWS,
        "TABS": TABS,
        "THEMES": THEMES,
        "LOOKS": LOOKS,
        "EVENT_KINDS": get_args(EventKind),
        "GOAL_STATES": get_args(GoalState),
        "OFFICE_LISTS": get_args(OfficeList),
        "ENGINES": get_args(EngineName),
        "SCRIPT_ACTIONS": world["_EventItem"]["properties"]["do"]["enum"],
        "WALL_KINDS": world["_WallItem"]["properties"]["kind"]["enum"],
        "ADDITIONS": [
            {"name": addition.name, "adds": addition.adds, "why": addition.why, "live": _live(addition)}
            for addition in ADDITIONS
        ],
    }
    rows = [f"export const {name} = /** @type {{const}} */ ({json.dumps(value)});\n" for name, value in values.items()]
    limits = {name: _limits(model.model_json_schema()) for name, model in LISTS.items()}
    about = "// The least and the most of each number of the world file, by list and key.\n"
    return _HEAD + "".join(rows) + f"{about}export const LIMITS = {json.dumps(limits, indent=2)};\n"


def types_text() -> str:
    """The commands, the world file and the elements by id as declarations for the type check."""
    parts = [_HEAD, *_declared({model.__name__: model for model in (EditStep, *MODELS.values())})]
    parts.append(f"type Command = {' | '.join(model.__name__ for model in MODELS.values())};\n")
    parts += _declared({"WorldFile": WorldFile})
    lists = "".join(f"  {name}: {_public(model.__name__)};\n" for name, model in LISTS.items())
    parts.append(f"type Things = {{\n{lists}}};\n")
    for name, page in PAGES.items():
        ids = _Ids()
        ids.feed((HERE / "static" / page).read_text(encoding="utf-8"))
        rows = "".join(f"  {json.dumps(key)}: {kind};\n" for key, kind in sorted(ids.found.items()))
        parts.append(f"type {name}Ids = {{\n{rows}}};\n")
    return "".join(parts)


def _live(addition: Addition) -> bool:
    """Whether it can be switched while a brain runs."""
    params = RatSlamParams()
    known = {
        f"{section.name}.{item.name}": item
        for section in fields(params)
        for item in fields(getattr(params, section.name))
    }
    return all(known[dotted].metadata["live"] for dotted in addition.off)


class _Ids(HTMLParser):
    """Which element each id of a page names. Symbols are left out, since they are only drawn by reference."""

    def __init__(self) -> None:
        super().__init__()
        self.found: dict[str, str] = {}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        name = dict(attrs).get("id")
        if name and tag != "symbol":
            room = "SVGElementTagNameMap" if tag in ("svg", "g") else "HTMLElementTagNameMap"
            self.found[name] = f'{room}["{tag}"]'


def _limits(schema: dict[str, Any]) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for key, field in schema["properties"].items():
        number = field.get("items", field)
        number = number.get("items", number)  # a list of points
        if "maximum" in number:
            found[key] = [number.get("minimum", number.get("exclusiveMinimum")), number["maximum"]]
    return found


def _declared(models: dict[str, type[BaseModel]]) -> list[str]:
    known: dict[str, str] = {}
    for name, model in models.items():
        schema = model.model_json_schema()
        for part, definition in schema.get("$defs", {}).items():
            known.setdefault(_public(part), _type(definition))
        known.setdefault(name, _type(schema))
    return [f"type {name} = {text};\n" for name, text in known.items()]


def _type(schema: dict[str, Any]) -> str:
    """One JSON schema as a TypeScript type, without its limits, which the server checks."""
    if "$ref" in schema:
        return _public(schema["$ref"].split("/")[-1])
    if "const" in schema or "enum" in schema:
        return " | ".join(json.dumps(value) for value in schema.get("enum", [schema.get("const")]))
    if "anyOf" in schema:
        return " | ".join(dict.fromkeys(map(_type, schema["anyOf"])))
    if schema.get("type") == "array":
        item = _type(schema["items"])
        pair = schema.get("maxItems") == schema.get("minItems") == 2
        return f"[{item}, {item}]" if pair else f"({item})[]"
    if "properties" in schema:
        required = schema.get("required", [])
        rows = [f"{key}{'' if key in required else '?'}: {_type(part)}" for key, part in schema["properties"].items()]
        return "{ " + "; ".join(rows) + " }"
    kinds = {"integer": "number", "number": "number", "string": "string", "boolean": "boolean", "null": "null"}
    return kinds.get(schema.get("type", ""), "{ [key: string]: any }")


def _public(name: str) -> str:
    return name.lstrip("_")


def main() -> int:
    stale = [name for name, text in FILES.items() if not _is(HERE / name, text())]
    if "--check" in sys.argv:
        if stale:
            print(
                f"older than the models: {', '.join(stale)}; `python -m web.shared` writes them anew", file=sys.stderr
            )
        return 1 if stale else 0
    for name in stale:
        (HERE / name).write_text(FILES[name](), encoding="utf-8")
        print(f"written: web/{name}")
    return 0


def _is(path: Path, text: str) -> bool:
    return path.is_file() and path.read_text(encoding="utf-8") == text


if __name__ == "__main__":
    raise SystemExit(main())
