"""Every number that decides what the pilot does is declared once, where it can be set."""

from __future__ import annotations

import ast
from dataclasses import fields
from pathlib import Path

import pytest

import app.pilot
from app.config import Config
from app.pilot import PilotParams
from app.pilot.behaviours import Behaviour, words_of

ROOM = Path(app.pilot.__file__).parent
FORM = {-1, 0, 1, 2, 0.5}  # numbers that belong to formulas: signs, halves and doubles, nothing, all, the first


def literals(source: str) -> list[tuple[int, float]]:
    """Line and value of each number that is not an index: `ranges_m[2:6]` names sonars."""
    tree = ast.parse(source)
    places = {id(n) for s in ast.walk(tree) if isinstance(s, ast.Subscript) for n in ast.walk(s.slice)}
    numbers = (n for n in ast.walk(tree) if isinstance(n, ast.Constant) and type(n.value) in (int, float))
    return [(n.lineno, n.value) for n in numbers if id(n) not in places]


@pytest.mark.parametrize("file", sorted(p.name for p in ROOM.glob("*.py") if p.name != "behaviours.py"))
def test_no_number_stands_outside_the_parameters(file: str) -> None:
    found = [(line, value) for line, value in literals((ROOM / file).read_text()) if value not in FORM]
    assert not found, f"app/pilot/{file}: declare in app/pilot/params: {found}"


def test_a_number_in_the_code_would_be_found() -> None:
    assert literals("x = 0.35 if ranges[2:6] else -4") == [(1, 0.35), (1, 4)]


def test_the_pilots_parameters_are_one_section_with_all_that_is_told_of_each() -> None:
    rows = {name: item for name, item, _ in Config().items() if name.startswith("pilot.")}
    assert len(rows) == len(fields(PilotParams)) > 50
    for name, item in rows.items():
        about = item.metadata
        assert isinstance(item.default, bool) or about["low"] <= item.default <= about["high"], name
        assert len(about["meaning"]) > 10, name
        assert about["source"], name


def test_links_remember_a_behaviour_by_its_number() -> None:
    assert {behaviour.number for behaviour in Behaviour} == set(range(7))
    assert words_of(Behaviour.COASTING.number) == "following the route"
    assert (words_of(0), words_of(6), words_of(9)) == ("standing", "driven by hand", "9")
