"""A brain is downloaded and uploaded again; a file that is no brain is refused in a sentence."""

from __future__ import annotations

import asyncio
import io
import json
import threading
import zipfile
from concurrent.futures import Future

import numpy as np
import pytest

from disk import archive
from ratslam_core import Odometry, RatSlam, take_snapshot
from tests.unit.web.doubles import house
from web.http import brain_download
from web.http.asking import NoAnswer
from web.http.brain_download import BrainDownload
from web.http.brain_files import packed, unpacked
from web.http.security import MAX_BRAIN_BYTES
from web.messages import Accepted, ReadBrain, Refused, UseBrain

BINARY = {"Content-Type": "application/octet-stream"}


@pytest.fixture(scope="module")
def brain() -> RatSlam:
    brain = RatSlam()
    brain.step(np.random.default_rng(0).integers(0, 256, (48, 64), np.uint8), Odometry(0.3, 0.1, 0.1))
    return brain


@pytest.fixture
def server():
    with house() as made:
        yield made


def test_a_brain_that_is_packed_comes_out_the_same(brain: RatSlam) -> None:
    assert unpacked(packed(take_snapshot(brain))).digest() == brain.digest()


def changed(data: bytes) -> bytes:
    """The file with one number of one array changed."""
    with np.load(io.BytesIO(data)) as file:
        arrays = dict(file)
    arrays["a0"] = arrays["a0"].copy()
    arrays["a0"].view(np.uint8).reshape(-1)[0] ^= 1
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def foreign() -> bytes:
    out = io.BytesIO()
    np.savez(out, json=np.frombuffer(json.dumps({"digest": "", "format": 1}).encode(), np.uint8))
    return out.getvalue()


def pickled() -> bytes:
    out = io.BytesIO()
    np.savez(out, json=np.array([{"a": 1}], object), allow_pickle=True)
    return out.getvalue()


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda _: b"", "the file is empty"),
        (lambda _: b"a picture of a cat", "not a zip file"),
        (lambda data: data[: len(data) // 2], "not a zip file"),
        (changed, "its digest does not fit"),
        (lambda _: foreign(), "its digest does not fit"),
        (lambda _: pickled(), "no brain that can be taken back"),
    ],
)
def test_what_is_no_brain_is_refused_and_the_engine_is_not_asked(server, brain, spoil, words) -> None:
    answer = server.client.post("/api/brain", content=spoil(packed(take_snapshot(brain))), headers=BINARY)
    assert answer.status_code == 422
    (wrong,) = answer.json()["detail"]
    assert wrong["field"] == "brain"
    assert wrong["reason"].startswith("this file is no brain that can be taken back")
    assert words in wrong["reason"]
    assert server.engine.commands == []


def test_a_file_that_unpacks_to_too_much_is_refused_before_it_is_unpacked(monkeypatch) -> None:
    monkeypatch.setattr(archive, "MOST_BYTES", 1 << 20)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("json.npy", b"")
        file.writestr("a0.npy", bytes(2 << 20))
    with pytest.raises(ValueError, match="too large: 2 MiB unpacked, at most 1 are allowed"):
        unpacked(out.getvalue())


def test_a_brain_goes_down_as_a_file(server, brain) -> None:
    server.engine.answer = Accepted(12, brain)
    answer = server.client.get("/api/brain")
    assert answer.status_code == 200
    assert server.engine.commands == [ReadBrain()]
    assert answer.headers["content-disposition"] == 'attachment; filename="brain-office-seed3.npz"'
    assert unpacked(answer.content).digest() == brain.digest()
    assert server.client.get("/api/brain").status_code == 200
    assert server.engine.commands == [ReadBrain(), ReadBrain()]  # another one


def test_a_brain_that_could_not_come_up_again_does_not_go_down(server, brain, monkeypatch) -> None:
    server.engine.answer = Accepted(12, brain)
    monkeypatch.setattr(archive, "MOST_BYTES", 1000)
    answer = server.client.get("/api/brain")
    assert answer.status_code == 507
    words = answer.json()["detail"][0]["reason"]
    assert words.startswith("this brain cannot be sent: too large for a file: ")
    assert words.endswith(" MiB of arrays, at most 0 can be read again")
    monkeypatch.undo()
    assert server.client.get("/api/brain").status_code == 200


def test_who_asks_while_a_brain_is_made_gets_the_same(brain, monkeypatch) -> None:
    made, go_on, calls = [], threading.Event(), []

    def slowly(copy: RatSlam) -> bytes:
        made.append(copy)
        assert go_on.wait(60)
        return b"a brain"

    def submit(request: ReadBrain) -> Future:
        calls.append(request)
        future: Future = Future()
        future.set_result(Accepted(12, brain))
        return future

    async def ask_thrice() -> list[bytes]:
        download = BrainDownload(submit)  # type: ignore[arg-type]
        asked = [asyncio.create_task(download.answer({})) for _ in range(3)]
        while not made:
            await asyncio.sleep(0.01)
        monkeypatch.setattr(brain_download, "FRESH_S", -1.0)  # so that the file is already too old
        with pytest.raises(NoAnswer, match="is being sent to somebody") as refused:
            await download.answer({})
        assert refused.value.status == 429
        go_on.set()
        answers = await asyncio.gather(*asked)
        for answer in answers:
            await answer({"type": "http"}, _nothing, _nothing)  # type: ignore[arg-type]
        assert download._file is None  # nothing is kept
        return [answer.body for answer in answers]

    monkeypatch.setattr(brain_download, "_packed", slowly)
    bodies = asyncio.run(ask_thrice())
    assert bodies == [b"a brain"] * 3
    assert bodies[0] is bodies[1] is bodies[2]
    assert (len(made), len(calls)) == (1, 1)


async def _nothing(*_: object) -> None:
    """Stands in for sending and receiving."""


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_another_site_cannot_have_a_brain_copied(server, site: str) -> None:
    for path in ("/api/brain", "/api/state?map=1", "/api/experience/0", "/api/world", "/api/world/file"):
        answer = server.client.get(path, headers={"Sec-Fetch-Site": site})
        assert (answer.status_code, "another site" in answer.text) == (403, True)
    assert server.engine.commands == []
    assert server.client.get("/", headers={"Sec-Fetch-Site": site}).status_code == 200  # a link may lead here
    assert server.client.get("/api/state", headers={"Sec-Fetch-Site": "same-origin"}).status_code == 200


def test_an_engine_that_has_ended_is_told_of(server) -> None:
    server.engine.answer = Refused("type", "ReadBrain", "the engine has ended")
    answer = server.client.get("/api/brain")
    assert (answer.status_code, answer.json()["detail"][0]["reason"]) == (503, "the engine has ended")


def test_a_brain_comes_up_and_is_used(server, brain) -> None:
    answer = server.client.post("/api/brain", content=packed(take_snapshot(brain)), headers=BINARY)
    assert (answer.status_code, answer.json()["accepted"]) == (200, True)
    (request,) = server.engine.commands
    assert isinstance(request, UseBrain)
    assert isinstance(request.brain, RatSlam)
    assert request.brain.digest() == brain.digest()


def test_a_brain_that_the_engine_refuses_is_told(server, brain) -> None:
    server.engine.answer = Refused("brain", None, "this brain cannot be used here: it has no sonars")
    answer = server.client.post("/api/brain", content=packed(take_snapshot(brain)), headers=BINARY)
    assert answer.status_code == 422
    assert answer.json()["detail"][0]["reason"].endswith("it has no sonars")


def test_only_binary_of_a_bounded_size(server) -> None:
    assert server.client.post("/api/brain", json={}).status_code == 415
    large = BINARY | {"Content-Length": str(MAX_BRAIN_BYTES + 1)}
    assert server.client.post("/api/brain", content=b"x", headers=large).status_code == 413
    assert server.client.post("/api/commands", content=b"{}", headers=BINARY).status_code == 415
    foreign = BINARY | {"Origin": "http://evil.example"}
    assert server.client.post("/api/brain", content=b"x", headers=foreign).status_code == 403
    assert server.engine.commands == []


def test_brains_are_limited_in_number(server) -> None:
    codes = [server.client.post("/api/brain", content=b"x", headers=BINARY).status_code for _ in range(14)]
    assert codes[0] == 422
    assert 429 in codes
