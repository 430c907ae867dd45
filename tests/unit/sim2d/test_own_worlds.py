"""The folder of a person's own worlds when the disk is full, and after a crash."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sim2d import own_worlds
from tests.unit.disk.full import full_after


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    return tmp_path


def test_the_copy_from_before_is_never_half(folder: Path) -> None:
    for text in ("first", "second" * 1000):
        path = own_worlds.save("mine", text)
    before = path.with_name("mine.json.before")
    with full_after(1000), pytest.raises(ValueError, match=r"mine.json: cannot be written: File too large"):
        own_worlds.save("mine", "third")
    assert (path.read_text(), before.read_text()) == ("second" * 1000, "first")
    own_worlds.save("mine", "third")
    with full_after(1000), pytest.raises(ValueError, match="cannot be written"):
        own_worlds.save("mine", "fourth" * 1000)
    assert (path.read_text(), before.read_text()) == ("third", "third")
    assert sorted(os.listdir(folder)) == ["mine.json", "mine.json.before"]


def test_what_a_crash_left_is_tidied_up(folder: Path) -> None:
    old, young = folder / ".saving-k2x8q1", folder / ".saving-ratslam-01"
    for file in (old, young):
        file.write_text("{")
    os.utime(old, (0, 0))
    own_worlds.tidy()
    assert not old.exists()
    assert young.exists()
    os.utime(young, (0, 0))
    own_worlds.save("mine", "{}")
    assert os.listdir(folder) == ["mine.json"]
