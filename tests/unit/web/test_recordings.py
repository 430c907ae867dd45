"""A recording that is sent is kept while it plays. One that is wrong is refused in a sentence, and leaves no file."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import ORIGIN, PORT, StubEngine, StubViewers
from web.http.api import create_app
from web.http.recordings import MAX_RECORDING_BYTES
from web.latest import Latest
from web.messages import Accepted, PlayRecording, RecordingView, Refused, Snapshot

KIND = {"Content-Type": "application/octet-stream"}
VIEW = RecordingView("walk", "MCAP", 3, 0.2, ("camera", "speed"), over=False)


class Sender:
    def __init__(self, client: TestClient, engine: StubEngine, folder: Path) -> None:
        self.client, self.engine, self.folder = client, engine, folder

    def send(self, name: str, body: bytes, **headers: str) -> Any:
        return self.client.post("/api/recordings", params={"name": name}, content=body, headers={**KIND, **headers})

    @property
    def files(self) -> list[str]:
        return sorted(path.name for path in self.folder.rglob("*") if path.is_file())


def opened(path: Path) -> object:
    """A file that begins with `good` can be played."""
    if not path.read_bytes().startswith(b"good"):
        raise ValueError(f"{path}: line 1 is no recording")
    return path.name


@pytest.fixture
def sender(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Sender]:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    latest: Latest[Snapshot] = Latest()
    latest.put(fake_snapshot(1))
    engine = StubEngine()
    engine.answer = Accepted(0, VIEW)
    with TestClient(create_app(latest, engine.submit, StubViewers(), PORT, opener=opened), base_url=ORIGIN) as client:
        yield Sender(client, engine, tmp_path)
    assert not list(tmp_path.iterdir()), "at the end of the program nothing is left behind"


def test_it_plays_and_is_kept_until_the_next(sender: Sender) -> None:
    answer = sender.send("walk.mcap", b"good" + bytes(100_000))
    assert answer.status_code == 200
    assert answer.json() == {
        "name": "walk", "format": "MCAP", "moments": 3, "seconds": 0.2, "has": ["camera", "speed"], "over": False,
    }  # fmt: skip
    played = sender.engine.commands[-1]
    assert isinstance(played, PlayRecording)
    assert played.player == "walk.mcap"
    assert sender.files == ["walk.mcap"]
    assert sender.send("other.bag", b"good").status_code == 200
    assert sender.files == ["other.bag"]


def test_a_wrong_one_is_refused_and_the_one_before_stays(sender: Sender) -> None:
    sender.send("walk.mcap", b"good")
    sent = len(sender.engine.commands)
    answer = sender.send("bad.log", b"bad")
    assert answer.status_code == 422
    assert answer.json()["detail"][0]["reason"] == "bad.log: line 1 is no recording"
    assert sender.send("empty.log", b"").json()["detail"][0]["reason"] == "empty.log is empty"
    assert len(sender.engine.commands) == sent
    assert sender.files == ["walk.mcap"]


def test_one_that_the_engine_refuses_leaves_no_file(sender: Sender) -> None:
    sender.engine.answer = Refused("recording", None, "this recording cannot be played: it has no moment")
    answer = sender.send("walk.mcap", b"good")
    assert answer.status_code == 422
    assert "it has no moment" in answer.json()["detail"][0]["reason"]
    assert sender.files == []


@pytest.mark.parametrize("name", ["../../up.mcap", "C:\\there\\up.mcap", "a\n/up.mcap"])
def test_a_name_leads_out_of_no_folder(sender: Sender, name: str) -> None:
    assert sender.send(name, b"good").status_code == 200
    assert sender.files == ["up.mcap"]


@pytest.mark.parametrize("name", ["..", ".", "/", "\x07"])
def test_a_name_that_is_none_gets_one(sender: Sender, name: str) -> None:
    assert sender.send(name, b"good").status_code == 200
    assert sender.files == ["recording"]


def test_too_much_and_other_kinds_are_refused(sender: Sender, monkeypatch: pytest.MonkeyPatch) -> None:
    assert sender.send("a.mcap", b"good", **{"Content-Type": "text/plain"}).status_code == 415
    assert sender.send("a.mcap", b"good", **{"Sec-Fetch-Site": "cross-site"}).status_code == 403
    assert sender.send("a.mcap", b"x", **{"Content-Length": str(MAX_RECORDING_BYTES + 1)}).status_code == 413
    monkeypatch.setattr("web.http.recordings.MAX_RECORDING_BYTES", 10)
    assert sender.send("a.mcap", b"good" + bytes(10)).status_code == 413
    assert sender.files == []
