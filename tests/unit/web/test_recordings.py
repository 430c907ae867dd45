"""A recording that is sent is kept while it plays. One that is wrong is refused in a sentence, and leaves no file."""

from __future__ import annotations

import asyncio
import tempfile
import threading
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.requests import Request
from starlette.testclient import TestClient

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S
from tests.unit.web.doubles import ORIGIN, PORT, StubEngine, StubViewers
from web.http import recordings
from web.http.api import create_app
from web.http.commands import Malformed
from web.http.recordings import MAX_RECORDING_BYTES, SentRecordings
from web.latest import Latest
from web.messages import Accepted, PlayRecording, RecordingView, Refused, Snapshot

pytestmark = pytest.mark.slow

KIND = {"Content-Type": "application/octet-stream"}
VIEW = RecordingView("walk", "MCAP", 3, 0.2, ("camera", "speed"), over=False)


class Sender:
    def __init__(self, client: TestClient, engine: StubEngine, folder: Path) -> None:
        self.client, self.engine, self.folder = client, engine, folder

    def send(self, name: str, body: bytes, **headers: str) -> Any:
        return self.client.post("/api/recordings", params={"name": name}, content=body, headers={**KIND, **headers})

    def put(self, name: str, body: bytes, folder: str = "0123abcd", **headers: str) -> Any:
        params = {"name": name, "of": "tub", "folder": folder}
        return self.client.put("/api/recordings", params=params, content=body, headers={**KIND, **headers})

    def play_folder(self, folder: str = "0123abcd") -> Any:
        params = {"name": "tub", "folder": folder}
        return self.client.post("/api/recordings", params=params, headers=KIND)

    @property
    def files(self) -> list[str]:
        return sorted(path.name for path in self.folder.rglob("*") if path.is_file())


def opened(path: Path, called_off: threading.Event) -> object:
    """A file that begins with `good` can be played, and a folder with such a file in it."""
    if path.is_dir():
        return [opened(file, called_off) for file in sorted(path.rglob("*")) if file.is_file()]
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


# ------------------------------------------------------------ folders


def test_a_folder_is_sent_file_by_file_and_played(sender: Sender) -> None:
    sender.send("walk.mcap", b"good")
    assert sender.put("manifest.json", b"good").json() == {"room": MAX_RECORDING_BYTES - 4}
    assert sender.put("images/1.jpg", b"good 1").status_code == 200
    assert sender.put("empty.txt", b"").status_code == 200, "an empty file belongs to it, too"
    assert sender.files == ["1.jpg", "empty.txt", "manifest.json", "walk.mcap"]
    sender.put("empty.txt", b"good")
    assert sender.play_folder().status_code == 200
    assert sender.files == ["1.jpg", "empty.txt", "manifest.json"], "what played before is deleted"
    played = sender.engine.commands[-1]
    assert isinstance(played, PlayRecording)
    assert played.player == ["empty.txt", "1.jpg", "manifest.json"]
    home = next(path for path in sender.folder.rglob("tub"))
    assert (home / "images" / "1.jpg").read_bytes() == b"good 1"


def test_a_folder_that_cannot_be_played_is_refused_and_deleted(sender: Sender) -> None:
    sender.send("walk.mcap", b"good")
    sender.put("a.txt", b"bad")
    answer = sender.play_folder()
    assert answer.status_code == 422
    assert "line 1 is no recording" in answer.json()["detail"][0]["reason"]
    assert sender.files == ["walk.mcap"]
    assert "no file of this folder has been sent" in sender.play_folder().json()["detail"][0]["reason"]


def test_another_folder_takes_the_place_of_one_that_was_not_played(sender: Sender) -> None:
    sender.put("a.txt", b"good")
    sender.put("b.txt", b"good", folder="ffff0000")
    assert sender.files == ["b.txt"]
    assert sender.play_folder().status_code == 422
    assert sender.play_folder("ffff0000").status_code == 200


@pytest.mark.parametrize(
    "name", ["../up", "a/../../up", "/up", "a//up", "a\\..\\..\\up", "/".join("abcdefghi"), "a\x07b"]
)
def test_no_file_leads_out_of_the_folder(sender: Sender, name: str) -> None:
    answer = sender.put(name, b"good")
    assert answer.status_code == 422
    assert "plain names" in answer.json()["detail"][0]["reason"]
    assert sender.files == []


def test_a_folder_has_limits(sender: Sender, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("web.http.sent_folder.MAX_RECORDING_BYTES", 10)
    monkeypatch.setattr("web.http.sent_folder.MOST_FILES", 3)
    assert sender.put("a", b"good").json() == {"room": 6}
    assert sender.put("b", b"good").json() == {"room": 2}
    assert sender.put("c", b"good").status_code == 413
    assert "more than 3 files" in sender.put("d", b"").json()["detail"][0]["reason"]
    assert sender.put("e", b"good", **{"Content-Type": "text/plain"}).status_code == 415
    assert sender.put("e", b"good", **{"Sec-Fetch-Site": "cross-site"}).status_code == 403
    assert sender.put("e", b"good", folder="../..").status_code == 422


NAMES = [
    "a/b",
    "/",
    "a/",
    "..",
    "\u4e16" * 200,
    "\U0001f600" * 190 + ".mcap",
    "x" * 200,
    "\\",
    ". .",
    "a\u202e.bag",
    " ",
]


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_whatever_it_is_called_it_plays_or_is_refused_and_leaves_nothing(sender: Sender, name: str) -> None:
    """As a file, as a folder, and as a file or a folder in one; the fixture looks for what is left behind."""
    assert sender.send(name, b"good").status_code == 200
    for at, (of, inside) in enumerate(((name, "a"), ("tub", name), ("tub", f"{name}/a"), ("tub", "a"), ("tub", "a/b"))):
        params = {"name": inside, "of": of, "folder": f"0123abc{at // 3}"}
        answer = sender.client.put("/api/recordings", params=params, content=b"good", headers=KIND)
        assert answer.status_code in (200, 422), answer.text
    assert sender.play_folder("0123abc1").status_code == 200


class Body:
    """A request's, in two parts; the second one comes when it may."""

    def __init__(self, may: asyncio.Event) -> None:
        self._may, self.began = may, asyncio.Event()

    async def stream(self) -> AsyncIterator[bytes]:
        yield b"good"
        self.began.set()
        await self._may.wait()
        yield b"bye"

    async def is_disconnected(self) -> bool:
        return False


def test_an_upload_that_stalls_holds_up_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    engine = StubEngine()
    engine.answer = Accepted(0, VIEW)
    sent = SentRecordings(opened, engine.submit)

    async def two() -> None:
        never, now = asyncio.Event(), asyncio.Event()
        now.set()
        body: Any = Body(never)
        stalled = asyncio.create_task(sent.take(body, "stalled.bag"))
        await body.began.wait()
        after: Any = Body(now)
        async with asyncio.timeout(PATIENCE_S):
            await sent.take(after, "next.bag")
        stalled.cancel()  # as when its connection is ended
        await asyncio.wait({stalled})

    asyncio.run(two())
    assert [path.name for path in tmp_path.rglob("*.bag")] == ["next.bag"]


def test_whoever_leaves_while_it_is_opened_calls_it_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Or nobody could open a recording after one that is read without an end."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(recordings, "LOOK_S", 0.01)

    def endless(path: Path, called_off: threading.Event) -> object:
        called_off.wait()
        raise ValueError(f"{path}: called off")

    said = iter([{"type": "http.request", "body": b"good", "more_body": False}])

    async def receive() -> dict[str, object]:
        return next(said, {"type": "http.disconnect"})

    request = Request({"type": "http", "method": "POST", "headers": []}, receive)
    with pytest.raises(Malformed, match="called off"):
        asyncio.run(SentRecordings(endless, StubEngine().submit).take(request, "endless.db3"))
    assert not list(tmp_path.iterdir())
