"""Commands from JSON: checked, and errors said in a plain sentence with the field, its value and what would be right."""

from __future__ import annotations

from typing import Any, get_args

import orjson
from pydantic import BaseModel, TypeAdapter, ValidationError

from disk.words import shown
from sim2d.world.json_lines import deeper_than
from web.messages import Command

READER: TypeAdapter[Command] = TypeAdapter(Command)
MODELS: dict[str, type[BaseModel]] = {
    get_args(model.model_fields["type"].annotation)[0]: model for model in get_args(get_args(Command)[0])
}
_LONGEST_ECHO = 80
_MOST_LEVELS, _MOST_PARTS = 20, 100_000


class Wrong(BaseModel):
    """One thing that is wrong: the field (null for none in particular), its value, and what would be right."""

    field: str | None
    value: Any
    reason: str


class Problem(BaseModel):
    """Every error of this API has this shape."""

    detail: list[Wrong]


class CommandAccepted(BaseModel):
    """The engine took the command before this tick."""

    accepted: bool
    tick: int


class Declined(Exception):  # noqa: N818
    """A request that is not carried out: its HTTP status, and why."""

    def __init__(self, wrongs: list[dict[str, Any]], status: int) -> None:
        super().__init__("; ".join(wrong["reason"] for wrong in wrongs))
        self.wrongs, self.status = wrongs, status

    @classmethod
    def of(cls, status: int, reason: str) -> Declined:
        """One that concerns no field in particular."""
        return cls([wrong(None, None, reason)], status)


class Malformed(Declined):
    """A command that cannot be carried out; `wrongs` says why, field by field."""

    def __init__(self, wrongs: list[dict[str, Any]]) -> None:
        super().__init__(wrongs, 422)


def read_object(raw: bytes | str) -> dict[str, Any]:
    """The JSON object in `raw`. Raises Malformed when it is something else, or larger than any command can be."""
    opened = raw.count("[") + raw.count("{") if isinstance(raw, str) else raw.count(b"[") + raw.count(b"{")
    if opened > _MOST_PARTS:  # each takes thirty times as much memory as text
        raise Malformed([wrong(None, None, f"this has {opened} brackets [ and {{; at most {_MOST_PARTS} are allowed")])
    try:
        document: dict[str, Any] | list[Any] | str | float | None = orjson.loads(raw)
    except orjson.JSONDecodeError as error:
        reason = f"this is not JSON: {error} (NaN and Infinity are no JSON either)"
        raise Malformed([wrong(None, None, reason)]) from None
    if deeper_than(_MOST_LEVELS, document):
        reason = f"nested too deeply; at most {_MOST_LEVELS} lists or objects can lie within one another"
        raise Malformed([wrong(None, None, reason)])
    if not isinstance(document, dict):
        reason = f'a command is a JSON object such as {{"type": "pause"}}, got {_shown(document)}'
        raise Malformed([wrong(None, document, reason)])
    return document


def check(document: dict[str, Any]) -> Command:
    """The command in a JSON object. Raises Malformed."""
    try:
        return READER.validate_python(document)
    except ValidationError as error:
        raise Malformed(_explain(document, error)) from None


def wrong(field: str | None, value: object, reason: str) -> dict[str, Any]:
    """One entry of an error's `detail`, safe to send: long or odd values are shortened to text."""
    return {"field": field, "value": _echo(value), "reason": shown(reason)}


def problem(reason: str) -> bytes:
    """The body of an error that concerns no field in particular."""
    return orjson.dumps({"detail": [wrong(None, None, reason)]})


def _explain(document: dict[str, Any], error: ValidationError) -> list[dict[str, Any]]:
    wrongs: dict[str, dict[str, Any]] = {}
    for item in error.errors(include_url=False):
        kind, where, value = item["type"], [str(part) for part in item["loc"]], item["input"]
        field = where[1] if len(where) > 1 else "type"
        if field == "type":
            value = document.get("type")
            reason = "is missing" if "type" not in document else f"{_shown(value)} is not a command"
            reason = f"type {reason}; expected one of: {', '.join(MODELS)}"
        elif field == "steps" and len(where) > 2:
            path = "steps" + "".join(f"[{part}]" if part.isdigit() else f".{part}" for part in where[2:])
            reason = f"{path} is wrong: {item['msg'][0].lower()}{item['msg'][1:]}, got {_shown(value)}"
        elif field == "levels" and len(where) > 2:
            reason = f"levels must be a list of texts of at most 64 characters, got {_shown(value)}"
        elif len(where) > 2:  # a field that may be of several types
            reason = f"{field} must be a number, true, false or text of at most 64 characters, got {_shown(value)}"
        else:
            value = None if kind == "missing" else value
            reason = f"{field} {_rule(where[0], kind, item.get('ctx', {}), item['msg'], value)}"
        wrongs.setdefault(field, wrong(field, value, reason))
    return list(wrongs.values())


def _rule(command: str, kind: str, limits: dict[str, Any], message: str, value: object) -> str:
    takes = ", ".join(name for name in MODELS[command].model_fields if name != "type") or "no fields"
    rules = {
        "missing": f"is missing; {command} takes {takes}",
        "extra_forbidden": f"is not a field of {command}, which takes {takes}",
        "float_type": "must be a number",
        "int_type": "must be a whole number",
        "int_from_float": "must be a whole number",
        "string_type": "must be text",
        "speed": message,
        "finite_number": "must be a finite number",
        "greater_than_equal": f"must be at least {limits.get('ge')}",
        "less_than_equal": f"must be at most {limits.get('le')}",
        "string_too_long": f"must have at most {limits.get('max_length')} characters",
        "literal_error": f"must be {str(limits.get('expected')).replace(chr(39), '')}",
    }
    rule = rules.get(kind, f"is wrong: {message[0].lower()}{message[1:]}")
    return rule if kind in ("missing", "extra_forbidden") else f"{rule}, got {_shown(value)}"


def _shown(value: object) -> str:
    return shown(orjson.dumps(_echo(value), option=orjson.OPT_SERIALIZE_NUMPY).decode())


def _echo(value: object) -> Any:
    """The value itself when it is small and can be sent, else its beginning as text."""
    try:
        encoded = orjson.dumps(value, option=orjson.OPT_SERIALIZE_NUMPY)
        if len(encoded) <= _LONGEST_ECHO:
            return orjson.loads(encoded)
        text = encoded.decode()
    except (orjson.JSONEncodeError, RecursionError):
        text = ascii(value)
    return text if len(text) <= _LONGEST_ECHO else text[:_LONGEST_ECHO] + "..."
