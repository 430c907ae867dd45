"""Where a person's things are kept: never in the root of the file system."""

from __future__ import annotations

import os
import pwd
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from disk import kept_folder
from sim2d import World, WorldError, load_world, own_worlds


def account(home: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    def look_up(_number: int) -> Any:
        if home is None:
            raise KeyError
        return SimpleNamespace(pw_dir=home)

    monkeypatch.setattr(pwd, "getpwuid", look_up)


@pytest.mark.parametrize("home", [None, ""])
def test_without_HOME_the_account_tells(  # noqa: N802
    home: str | None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "mine"))
    assert kept_folder() == tmp_path / "mine" / ".ratslam"
    monkeypatch.delenv("HOME") if home is None else monkeypatch.setenv("HOME", home)
    assert kept_folder() == Path(pwd.getpwuid(os.getuid()).pw_dir) / ".ratslam"
    account(str(tmp_path), monkeypatch)
    assert kept_folder() == tmp_path / ".ratslam"


@pytest.mark.parametrize(("home", "account_home"), [("/", "/root"), ("//", None), ("", "/"), ("", ""), ("", None)])
def test_the_root_is_no_home(home: str, account_home: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", home)
    monkeypatch.delenv("RATSLAM_WORLDS", raising=False)
    account(account_home, monkeypatch)
    with pytest.raises(ValueError, match=r"there is no home directory .* set HOME to a folder of yours"):
        kept_folder()
    assert own_worlds.names() == ()
    own_worlds.tidy()
    assert isinstance(load_world("office"), World)
    with pytest.raises(WorldError, match="no world 'mine'; expected one of: office"):
        load_world("mine")
    with pytest.raises(ValueError, match="there is no home directory"):
        own_worlds.save("mine", "{}")
