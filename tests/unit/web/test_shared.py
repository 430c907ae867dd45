"""What the page shares with Python is written from the models, and it is noticed when it is out of date."""

from __future__ import annotations

import json
import sys

import pytest

from sim2d.world.world_schema import LISTS
from web import shared
from web.http.commands import MODELS


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["shared", *arguments])
    return shared.main()


def test_every_command_and_every_list_of_a_world_has_a_type() -> None:
    text = shared.types_text()
    for name, model in MODELS.items():
        assert f'type {model.__name__} = {{ type: "{name}"' in text
    for name in LISTS:
        assert f"\n  {name}: " in text


@pytest.mark.parametrize(
    ("schema", "written"),
    [
        ({"enum": ["a", "b"]}, '"a" | "b"'),
        ({"const": 0}, "0"),
        ({"anyOf": [{"type": "integer"}, {"type": "number"}, {"type": "null"}]}, "number | null"),
        ({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}, "[number, number]"),
        ({"type": "array", "items": {"$ref": "#/$defs/_WallItem"}}, "(WallItem)[]"),
        (
            {"properties": {"x": {"type": "string"}, "y": {"type": "boolean"}}, "required": ["x"]},
            "{ x: string; y?: boolean }",
        ),
    ],
)
def test_a_schema_is_written_as_a_type(schema: dict[str, object], written: str) -> None:
    assert shared._type(schema) == written


def test_limits_are_the_world_files() -> None:
    text = shared.names_text()
    limits = json.loads(text.split("export const LIMITS = ")[1].rstrip(";\n"))
    assert limits["doors"]["width"] == [0.3, 6]
    assert limits["doors"]["hinge"] == limits["people"]["path"] == [-10_000, 10_000]
    assert limits["people"]["wait_s"] == [0, 1e6]


def test_a_file_older_than_the_models_is_named_and_written_anew(monkeypatch, tmp_path, capsys) -> None:
    for name in shared.FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
    for page in shared.PAGES.values():
        (tmp_path / "static" / page).parent.mkdir(exist_ok=True)
        (tmp_path / "static" / page).write_text('<input id="name"><svg id="plan"><symbol id="i-x"></symbol></svg>')
    monkeypatch.setattr(shared, "HERE", tmp_path)
    assert run(monkeypatch, "--check") == 1
    assert "static/shared.js, types/shared.d.ts" in capsys.readouterr().err
    assert run(monkeypatch) == 0
    assert run(monkeypatch, "--check") == 0
    declared = (tmp_path / "types" / "shared.d.ts").read_text()
    assert '"name": HTMLElementTagNameMap["input"]' in declared
    assert '"plan": SVGElementTagNameMap["svg"]' in declared
    assert "i-x" not in declared
