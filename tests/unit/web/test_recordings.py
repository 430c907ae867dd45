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

from tests.patience import PATIENCE_S
from tests.unit.web.doubles import House, StubEngine, house
from web.http import recordings
from web.http.commands import Malformed
from web.http.recordings import MAX_RECORDING_BYTES, SentRecordings
from web.messages import Accepted, PlayRecording, RecordingView, Refused

pytestmark = pytest.mark.slow

KIND = {"Content-Type": "application/octet-stream"}
NOT_OURS: list[tuple[dict[str, Any], int]] = [
    ({"Content-Type": "text/plain"}, 415),
    ({"Sec-Fetch-Site": "cross-site"}, 403),
]
PLAYED = Accepted(0, RecordingView("walk", "MCAP", 3, 0.2, ("camera", "speed"), over=False))


def opened(path: Path, called_off: threading.Event) -> object:
    """A file that begins with `good` can be played, and a folder with such a file in it."""
    if path.is_dir():
        return [opened(file, called_off) for file in sorted(path.rglob("*")) if file.is_file()]
    if not path.read_bytes().startswith(b"good"):
        raise ValueError(f"{path}: line 1 is no recording")
    return path.name


def why(answer: Any) -> str:
    assert answer.status_code in (413, 422)
    return answer.json()["detail"][0]["reason"]


class Sender:
    def __init__(self, server: House, folder: Path) -> None:
        self.client, self.engine, self.folder = server.client, server.engine, folder

    def send(self, name: str, body: bytes = b"good", **headers: str) -> Any:
        return self.client.post("/api/recordings", params={"name": name}, content=body, headers={**KIND, **headers})

    def put(
        self, name: str, body: bytes = b"good", *, folder: str = "0123abcd", of: str = "tub", **headers: str
    ) -> Any:
        params = {"name": name, "of": of, "folder": folder}
        return self.client.put("/api/recordings", params=params, content=body, headers={**KIND, **headers})

    def play_folder(self, folder: str = "0123abcd") -> Any:
        params = {"name": "tub", "folder": folder}
        return self.client.post("/api/recordings", params=params, headers=KIND)

    @property
    def files(self) -> list[str]:
        return sorted(path.name for path in self.folder.rglob("*") if path.is_file())

    @property
    def played(self) -> object:
        command = self.engine.commands[-1]
        assert isinstance(command, PlayRecording)
        return command.player


@pytest.fixture
def sender(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Sender]:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with house(opener=opened) as server:
        server.engine.answer = PLAYED
        yield Sender(server, tmp_path)
    assert not list(tmp_path.iterdir()), "at the end of the program nothing is left behind"


def test_it_plays_and_is_kept_until_the_next_that_can_be_played(sender: Sender) -> None:
    answer = sender.send("walk.mcap", b"good" + bytes(100_000))
    assert answer.status_code == 200
    assert answer.json() == {
        "name": "walk", "format": "MCAP", "moments": 3, "seconds": 0.2, "has": ["camera", "speed"], "over": False,
    }  # fmt: skip
    assert (sender.played, sender.files) == ("walk.mcap", ["walk.mcap"])
    assert why(sender.send("bad.log", b"bad")) == "bad.log: line 1 is no recording"
    assert why(sender.send("empty.log", b"")) == "empty.log is empty"
    assert (len(sender.engine.commands), sender.files) == (1, ["walk.mcap"])
    assert sender.send("other.bag").status_code == 200
    assert sender.files == ["other.bag"]


def test_one_that_the_engine_refuses_leaves_no_file(sender: Sender) -> None:
    sender.engine.answer = Refused("recording", None, "this recording cannot be played: it has no moment")
    assert "it has no moment" in why(sender.send("walk.mcap"))
    assert sender.files == []


def test_too_much_and_other_kinds_are_refused(sender: Sender, monkeypatch: pytest.MonkeyPatch) -> None:
    for headers, status in [*NOT_OURS, ({"Content-Length": str(MAX_RECORDING_BYTES + 1)}, 413)]:
        assert sender.send("a.mcap", **headers).status_code == status
    monkeypatch.setattr(recordings, "MAX_RECORDING_BYTES", 10)
    assert sender.send("a.mcap", b"good" + bytes(10)).status_code == 413
    assert sender.files == []


# ------------------------------------------------------------ folders


def test_a_folder_is_sent_file_by_file_and_played(sender: Sender) -> None:
    sender.send("walk.mcap")
    assert sender.put("manifest.json").json() == {"room": MAX_RECORDING_BYTES - 4}
    assert sender.put("images/1.jpg", b"good 1").status_code == 200
    assert sender.put("empty.txt", b"").status_code == 200, "an empty file belongs to it, too"
    assert sender.files == ["1.jpg", "empty.txt", "manifest.json", "walk.mcap"]
    sender.put("empty.txt")
    assert sender.play_folder().status_code == 200
    assert sender.files == ["1.jpg", "empty.txt", "manifest.json"], "what played before is deleted"
    assert sender.played == ["empty.txt", "1.jpg", "manifest.json"]
    (home,) = sender.folder.rglob("tub")
    assert (home / "images" / "1.jpg").read_bytes() == b"good 1"


def test_a_folder_that_cannot_be_played_is_refused_and_deleted(sender: Sender) -> None:
    sender.send("walk.mcap")
    sender.put("a.txt", b"bad")
    assert "line 1 is no recording" in why(sender.play_folder())
    assert sender.files == ["walk.mcap"]
    assert "no file of this folder has been sent" in why(sender.play_folder())


def test_another_folder_takes_the_place_of_one_that_was_not_played(sender: Sender) -> None:
    sender.put("a.txt")
    sender.put("b.txt", folder="ffff0000")
    assert sender.files == ["b.txt"]
    assert sender.play_folder().status_code == 422
    assert sender.play_folder("ffff0000").status_code == 200


def test_a_folder_has_limits(sender: Sender, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("web.http.recordings.MAX_RECORDING_BYTES", 10)
    monkeypatch.setattr("web.http.recordings.MOST_FILES", 3)
    assert sender.put("a").json() == {"room": 6}
    assert sender.put("b").json() == {"room": 2}
    assert sender.put("c").status_code == 413
    assert "more than 3 files" in why(sender.put("d", b""))
    for headers, status in NOT_OURS:
        assert sender.put("e", **headers).status_code == status
    assert sender.put("e", folder="../..").status_code == 422


# ------------------------------------------------------------ names


def test_a_name_leads_out_of_no_folder_and_one_that_is_none_gets_one(sender: Sender) -> None:
    for name in ("../../up.mcap", "C:\\there\\up.mcap", "a\n/up.mcap", "..", ".", "/", "\x07"):
        assert sender.send(name).status_code == 200
        assert sender.files == ["up.mcap" if "up" in name else "recording"]


def test_no_file_leads_out_of_the_folder(sender: Sender) -> None:
    for name in ("../up", "a/../../up", "/up", "a//up", "a\\..\\..\\up", "/".join("abcdefghi"), "a\x07b"):
        assert "plain names" in why(sender.put(name))
    assert sender.files == []
    assert sender.put("/".join("abcdefgh")).status_code == 200  # no folder in it is deeper


NAMES = [
    "a/b", "/", "a/", "..", "\u4e16" * 200, "\U0001f600" * 190 + ".mcap", "x" * 200, "\\", ". .", "a\u202e.bag", " ",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_whatever_it_is_called_it_plays_or_is_refused_and_leaves_nothing(sender: Sender, name: str) -> None:
    """As a file, as a folder, and as a file or a folder in one; the fixture looks for what is left behind."""
    assert sender.send(name).status_code == 200
    for at, (of, inside) in enumerate(((name, "a"), ("tub", name), ("tub", f"{name}/a"), ("tub", "a"), ("tub", "a/b"))):
        answer = sender.put(inside, of=of, folder=f"0123abc{at // 3}")
        assert answer.status_code in (200, 422), answer.text
    assert sender.play_folder("0123abc1").status_code == 200


# ------------------------------------------------------------ whoever does not wait


class Body:
    """A request's, in two parts; the second one comes when it may."""

    def __init__(self) -> None:
        self.may, self.began = asyncio.Event(), asyncio.Event()

    async def stream(self) -> AsyncIterator[bytes]:
        yield b"good"
        self.began.set()
        await self.may.wait()
        yield b"bye"

    async def is_disconnected(self) -> bool:
        return False


def test_an_upload_that_stalls_holds_up_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    engine = StubEngine()
    engine.answer = PLAYED
    sent = SentRecordings(opened, engine.submit)

    async def two() -> None:
        never: Any = Body()
        stalled = asyncio.create_task(sent.take(never, "stalled.bag"))
        await never.began.wait()
        after: Any = Body()
        after.may.set()
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
