"""Where a person's things are kept: never in the root of the file system."""

from __future__ import annotations

import os
import pwd
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from disk import user_folder
from sim2d import World, WorldError, load_world, own_worlds


def account(home: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    def look_up(_number: int) -> Any:
        if home is None:
            raise KeyError
        return SimpleNamespace(pw_dir=home)

    monkeypatch.setattr(pwd, "getpwuid", look_up)


def test_without_HOME_the_account_tells(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:  # noqa: N802
    monkeypatch.setenv("HOME", str(tmp_path / "mine"))
    assert user_folder("lessons") == tmp_path / "mine" / ".ratslam" / "lessons"
    account(str(tmp_path), monkeypatch)
    monkeypatch.setenv("HOME", "")
    assert user_folder("lessons") == tmp_path / ".ratslam" / "lessons"
    monkeypatch.delenv("HOME")
    assert user_folder("lessons") == tmp_path / ".ratslam" / "lessons"
    monkeypatch.undo()
    monkeypatch.delenv("HOME", raising=False)
    assert user_folder("lessons") == Path(pwd.getpwuid(os.getuid()).pw_dir) / ".ratslam" / "lessons"


def test_the_root_is_no_home(monkeypatch: pytest.MonkeyPatch, subtests: pytest.Subtests) -> None:
    monkeypatch.delenv("RATSLAM_WORLDS", raising=False)
    for home, account_home in (("/", "/root"), ("//", None), ("", "/"), ("", ""), ("", None)):
        with subtests.test(f"{home!r}, {account_home!r}"):
            monkeypatch.setenv("HOME", home)
            account(account_home, monkeypatch)
            with pytest.raises(ValueError, match=r"there is no home directory .* set HOME to a folder of yours"):
                user_folder("lessons")
            assert own_worlds.names() == ()
            own_worlds.tidy()
            assert isinstance(load_world("office"), World)
            with pytest.raises(WorldError, match="no world 'mine'; expected one of: office"):
                load_world("mine")
            with pytest.raises(ValueError, match="there is no home directory"):
                own_worlds.save("mine", "{}")
