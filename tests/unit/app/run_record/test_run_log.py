"""A file of lines opens up to its last whole line, wherever it was cut off and whatever was damaged; and an edit of a text is
small, makes the same text again, and does not fit another text."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.run_record.order_rows import edit_of, edited
from app.run_record.run_log import Lines, line_of
from sim2d import load_world, world_to_json

VALUES = st.lists(st.dictionaries(st.text(max_size=5), st.integers() | st.text(max_size=20), max_size=3), max_size=8)
TEXTS = st.lists(st.sampled_from(["a\n", "b\n", "c", "\u2028", ""]), max_size=12).map("".join)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("lines") / "file"


def read(path: Path, data: bytes) -> tuple[list[dict], Lines]:
    path.write_bytes(data)
    lines = Lines(path)
    return list(lines), lines


def file_of(values: list[dict]) -> tuple[bytes, list[int]]:
    """The bytes of a file, and where its lines end."""
    data, ends, check = b"", [], 0
    for value in values:
        line, check = line_of(value, check)
        data += line
        ends.append(len(data))
    return data, ends


@given(VALUES, st.integers(0, 10_000))
def test_a_file_cut_off_anywhere_opens_up_to_its_last_whole_line(path: Path, values: list[dict], at: int) -> None:
    data, ends = file_of(values)
    at = min(at, len(data))
    found, lines = read(path, data[:at])
    whole = sum(end <= at for end in ends)
    assert found == values[:whole]
    assert lines.size == (ends[whole - 1] if whole else 0)
    assert bool(lines.damage) == (lines.size < at)


@given(VALUES, st.integers(0, 10_000), st.integers(1, 255))
def test_a_damaged_byte_ends_what_is_read_and_nothing_else_is_read(
    path: Path, values: list[dict], at: int, flip: int
) -> None:
    values = [*values, {"last": 1}]
    data, ends = file_of(values)
    at %= len(data)
    found, lines = read(path, data[:at] + bytes([data[at] ^ flip]) + data[at + 1 :])
    assert found == values[: sum(end <= at for end in ends)]
    assert lines.damage


@given(VALUES.filter(len), st.data())
def test_a_line_that_is_missing_or_twice_is_noticed(path: Path, values: list[dict], data: st.DataObject) -> None:
    whole, ends = file_of([{"first": 0}, *values, {"last": 1}])
    number, times = data.draw(st.integers(0, len(values))), data.draw(st.sampled_from([0, 2]))
    begin, end = (ends[number - 1] if number else 0), ends[number]
    found, lines = read(path, whole[:begin] + whole[begin:end] * times + whole[end:])
    assert len(found) <= number + 1
    assert lines.damage


def test_a_line_of_more_values_than_a_world_has_is_not_even_parsed(path: Path) -> None:
    found, lines = read(path, line_of({"tick": 0, "end": [[]] * 600_000}, 0)[0])
    assert (found, lines.size) == ([], 0)
    assert lines.damage == "line 1 is cut off or damaged; what follows is left out"


@given(TEXTS, TEXTS)
def test_an_edit_makes_the_same_text_again(before: str, after: str) -> None:
    assert edited(before, json.loads(json.dumps(edit_of(before, after)))) == after


def test_one_wall_more_is_a_short_edit_and_one_of_another_text_is_refused() -> None:
    text = world_to_json(load_world("office"))
    longer = text.replace('"walls": [\n', '"walls": [\n    {"from": [1, 1], "to": [2, 1]},\n', 1)
    assert len(json.dumps(edit_of(text, longer))) < 150
    right = {"from": 0, "to": 1, "put": "x", "check": 0}
    for edit in ({}, {"from": 0}, {**right, "to": 99, "put": ""}, {**right, "put": 3}, right, {**right, "from": "0"}):
        with pytest.raises(ValueError, match="an edit of the world cannot be made again"):
            edited("one\ntwo\n", edit)
