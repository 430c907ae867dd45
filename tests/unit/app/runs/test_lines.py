"""A file of lines opens up to its last whole line, wherever it was cut off and whatever was damaged."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.runs.lines import Lines, line_of

pytestmark = pytest.mark.slow

VALUES = st.lists(st.dictionaries(st.text(max_size=5), st.integers() | st.text(max_size=20), max_size=3), max_size=8)


def file_of(values: list[dict]) -> tuple[bytes, list[int]]:
    """The bytes of a file, and where its lines end."""
    data, ends, check = b"", [], 0
    for value in values:
        line, check = line_of(value, check)
        data += line
        ends.append(len(data))
    return data, ends


@given(VALUES, st.integers(0, 10_000))
def test_a_file_cut_off_anywhere_opens_up_to_its_last_whole_line(tmp_path_factory, values: list[dict], at: int) -> None:
    data, ends = file_of(values)
    at = min(at, len(data))
    path: Path = tmp_path_factory.mktemp("lines") / "file"
    path.write_bytes(data[:at])
    lines, whole = Lines(path), sum(end <= at for end in ends)
    assert list(lines) == values[:whole]
    assert lines.size == (ends[whole - 1] if whole else 0)
    assert bool(lines.damage) == (lines.size < at)


@given(VALUES, st.integers(0, 10_000), st.integers(1, 255))
def test_a_damaged_byte_ends_what_is_read_and_nothing_else_is_read(
    tmp_path_factory, values: list[dict], at: int, flip: int
) -> None:
    data, ends = file_of([*values, {"last": 1}])
    at %= len(data)
    path: Path = tmp_path_factory.mktemp("lines") / "file"
    path.write_bytes(data[:at] + bytes([data[at] ^ flip]) + data[at + 1 :])
    lines = Lines(path)
    assert list(lines) == [*values, {"last": 1}][: sum(end <= at for end in ends)]
    assert lines.damage


@given(VALUES.filter(len), st.data())
def test_a_line_that_is_missing_or_twice_is_noticed(tmp_path_factory, values: list[dict], data: st.DataObject) -> None:
    whole, ends = file_of([{"first": 0}, *values, {"last": 1}])
    number, times = data.draw(st.integers(0, len(values))), data.draw(st.sampled_from([0, 2]))
    begin, end = (ends[number - 1] if number else 0), ends[number]
    path: Path = tmp_path_factory.mktemp("lines") / "file"
    path.write_bytes(whole[:begin] + whole[begin:end] * times + whole[end:])
    lines = Lines(path)
    assert len(list(lines)) <= number + 1
    assert lines.damage


def test_a_line_of_more_values_than_a_world_has_is_not_even_parsed(tmp_path: Path) -> None:
    line, _ = line_of({"tick": 0, "end": [[]] * 600_000}, 0)
    (tmp_path / "lines").write_bytes(line)
    lines = Lines(tmp_path / "lines")
    assert (list(lines), lines.size) == ([], 0)
    assert lines.damage == "line 1 is cut off or damaged; what follows is left out"
