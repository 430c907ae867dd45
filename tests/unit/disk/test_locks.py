"""Only what says that somebody else has the lock is taken for that; a file system without locks is told of as one."""

from __future__ import annotations

import errno
import os
import sqlite3
from pathlib import Path

import pytest

from app.experiments.store import connected
from disk import locks
from disk.locks import lock, require_record_locks

pytestmark = pytest.mark.skipif(locks.fcntl is None, reason="this system has no such locks")
HELD = [errno.EAGAIN, errno.EACCES]
NONE_THERE = [errno.ENOLCK, errno.ENOTSUP, errno.EINVAL, errno.ENOSYS, errno.EIO]


def fail(monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    def refuse(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(locks.fcntl, "flock", refuse)
    monkeypatch.setattr(locks.fcntl, "lockf", refuse)


def test_one_writes_and_the_others_see_it(tmp_path: Path) -> None:
    path = tmp_path / "file"
    with path.open("wb") as first, path.open("rb+") as second, path.open("rb") as third, path.open("rb") as fourth:
        assert [lock(first), lock(second), lock(third, shared=True)] == [True, False, False]
        first.close()
        assert [lock(third, shared=True), lock(fourth, shared=True)] == [True, True], "who looks is in nobody's way"


def test_each_error_means_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, subtests: pytest.Subtests
) -> None:
    for number in HELD + NONE_THERE:
        with subtests.test(os.strerror(number)), (tmp_path / "file").open("wb") as file:
            fail(monkeypatch, number)
            assert lock(file) is (False if number in HELD else None)
            if number in HELD:
                require_record_locks(tmp_path, "the trials need")
            else:
                with pytest.raises(ValueError) as refused:
                    require_record_locks(tmp_path, "the trials need")
                words = f"{tmp_path} has no file locks ({os.strerror(number)}), which the trials need"
                assert str(refused.value) == words


def test_experiments_say_where_else_the_trials_could_be_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At once: SQLite would wait for a minute and then say that somebody else has the file."""
    fail(monkeypatch, errno.ENOLCK)
    with monkeypatch.context() as patch:  # coverage asks it afterwards
        patch.setattr(sqlite3, "connect", lambda *_, **__: pytest.fail("SQLite was asked"))
        with pytest.raises(ValueError, match=r"has no file locks .*; keep them on a local disk: --store FILE"):
            connected(tmp_path / "trials.sqlite")
