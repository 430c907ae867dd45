"""What the page shares with Python is written from the models, and it is noticed when it is out of date."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from web import shared


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["shared", *arguments])
    return shared.main()


def test_a_file_older_than_the_models_is_named_and_written_anew(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, "--check") == 0, "what lies in web/ is up to date"
    for name in (*shared.FILES, *(f"static/{page}" for page in shared.PAGES.values())):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text('<input id="name"><svg id="plan"><symbol id="i-x"></symbol></svg>')
    monkeypatch.setattr(shared, "HERE", tmp_path)
    assert run(monkeypatch, "--check") == 1
    assert "static/shared.js, types/shared.d.ts" in capsys.readouterr().err
    assert (run(monkeypatch), run(monkeypatch, "--check")) == (0, 0)
    declared = (tmp_path / "types" / "shared.d.ts").read_text()
    assert '"name": HTMLElementTagNameMap["input"]' in declared
    assert '"plan": SVGElementTagNameMap["svg"]' in declared
    assert "i-x" not in declared
