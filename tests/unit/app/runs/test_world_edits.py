"""An edit of a text is small, makes the same text again, and does not fit another text."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.runs.world_edits import edit_of, edited
from sim2d import load_world, world_to_json

TEXTS = st.lists(st.sampled_from(["a\n", "b\n", "c", "\u2028", ""]), max_size=12).map("".join)


@given(TEXTS, TEXTS)
def test_an_edit_makes_the_same_text_again(before: str, after: str) -> None:
    assert edited(before, json.loads(json.dumps(edit_of(before, after)))) == after


def test_one_wall_more_is_a_short_edit() -> None:
    text = world_to_json(load_world("office"))
    longer = text.replace('"walls": [\n', '"walls": [\n    {"from": [1, 1], "to": [2, 1]},\n', 1)
    assert len(json.dumps(edit_of(text, longer))) < 150


@pytest.mark.parametrize(
    "edit", [{}, {"from": 0}, {"from": 0, "to": 99, "put": "", "check": 0}, {"from": 0, "to": 1, "put": 3, "check": 0},
             {"from": 0, "to": 1, "put": "x", "check": 0}, {"from": "0", "to": 1, "put": "x", "check": 0}],
)  # fmt: skip
def test_an_edit_of_another_text_is_refused(edit: dict) -> None:
    with pytest.raises(ValueError, match="an edit of the world cannot be made again"):
        edited("one\ntwo\n", edit)
