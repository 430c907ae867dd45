"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from disk import sweep, whole_file, write_whole
from disk.whole_file import OLD_S
from tests.unit.disk.full import full_after

LONG_AGO = (OLD_S, OLD_S)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_full_disk_leaves_what_was_there_and_names_the_file(tmp_path: Path) -> None:
    file = tmp_path / "plan.json"
    write_whole(file, "old")
    with full_after(1000), pytest.raises(OSError, match="File too large") as caught:
        write_whole(file, "ü" * 501)
    assert caught.value.filename == str(file)
    assert (names(tmp_path), file.read_text("utf-8")) == (["plan.json"], "old")
    with full_after(1000):
        write_whole(file, "ü" * 500)
    assert file.read_text("utf-8") == "ü" * 500


def test_what_fails_half_way_or_cannot_be_begun_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), whole_file(tmp_path / "new") as file:  # noqa: PT012
        file.write(b"half")
        raise KeyboardInterrupt
    for bad in (tmp_path / "no" / "plan.json", tmp_path):
        with pytest.raises(OSError) as caught:
            write_whole(bad, "")
        assert caught.value.filename == str(bad)
    assert names(tmp_path) == []


def test_who_dies_while_writing_leaves_the_old_one_and_is_tidied_up_after(tmp_path: Path) -> None:
    file = tmp_path / "plan.json"
    write_whole(file, "old")
    dying = "import os, sys, disk\nwith disk.whole_file(sys.argv[1]) as f: f.write(b'new'); f.flush(); os._exit(9)"
    assert subprocess.run([sys.executable, "-c", dying, str(file)], timeout=120, check=False).returncode == 9
    assert file.read_text() == "old"
    (left,) = set(names(tmp_path)) - {"plan.json"}
    write_whole(file, "young ones stay: somebody may be writing")
    assert left in names(tmp_path)
    os.utime(tmp_path / left, LONG_AGO)
    write_whole(file, "new")
    assert (names(tmp_path), file.read_text()) == (["plan.json"], "new")


def test_only_what_was_left_over_is_swept(tmp_path: Path) -> None:
    for name in (".saving-abc", ".savings", "saving-abc", ".saving-young"):
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, LONG_AGO)
    (tmp_path / ".saving-young").touch()
    sweep(tmp_path)
    assert names(tmp_path) == [".saving-young", ".savings", "saving-abc"]
    sweep(tmp_path / "nowhere")


def test_mode_and_link_stay(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    file, link = tmp_path / "real" / "plan.json", tmp_path / "link.json"
    before = os.umask(0o027)
    try:
        write_whole(file, "1")
    finally:
        os.umask(before)
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    file.chmod(0o604)
    link.symlink_to(file)
    write_whole(link, "2")
    assert link.is_symlink()
    assert (file.read_text(), stat.S_IMODE(file.stat().st_mode)) == ("2", 0o604)


def test_a_pipe_is_written_to_and_stays(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(pipe, "through")
    assert os.read(reader, 100) == b"through"
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
