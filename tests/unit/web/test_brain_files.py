"""A brain is downloaded and uploaded again; a file that is no brain is refused in a sentence."""

from __future__ import annotations

import asyncio
import io
import json
import zipfile
from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from disk import archive
from ratslam_core import Odometry, RatSlam, take_snapshot
from tests.unit.web.doubles import House
from web.http import brains, security
from web.http.asking import NoAnswer
from web.http.brains import BrainDownload, packed, unpacked
from web.http.security import MAX_BRAIN_BYTES
from web.messages import Accepted, ReadBrain, Refused, UseBrain

BINARY = {"Content-Type": "application/octet-stream"}


@pytest.fixture(scope="module")
def brain() -> RatSlam:
    brain = RatSlam()
    brain.step(np.random.default_rng(0).integers(0, 256, (48, 64), np.uint8), Odometry(0.3, 0.1, 0.1))
    return brain


@pytest.fixture(scope="module")
def file(brain: RatSlam) -> bytes:
    return packed(take_snapshot(brain))


def uploaded(served: House, file: bytes, **headers: str) -> tuple[int, Any]:
    answer = served.client.post("/api/brain", content=file, headers=BINARY | headers)
    return answer.status_code, answer.json()


def saved(**arrays: np.ndarray) -> bytes:
    out = io.BytesIO()
    np.savez(out, allow_pickle=True, **arrays)
    return out.getvalue()


def with_one_number_changed(file: bytes) -> bytes:
    with np.load(io.BytesIO(file)) as arrays:
        changed = {name: array.copy() for name, array in arrays.items()}
    changed["a0"].view(np.uint8).reshape(-1)[0] ^= 1
    return saved(**changed)


def test_what_is_no_brain_is_refused_and_the_engine_is_not_asked(served: House, file: bytes, subtests) -> None:
    nothing = json.dumps({"digest": "", "format": 1}).encode()
    for words, spoilt in (
        ("the file is empty", b""),
        ("not a zip file", b"a picture of a cat"),
        ("not a zip file", file[: len(file) // 2]),
        ("its digest does not fit", with_one_number_changed(file)),
        ("its digest does not fit", saved(json=np.frombuffer(nothing, np.uint8))),
        ("no brain that can be taken back", saved(json=np.array([{"a": 1}], object))),
    ):
        with subtests.test(words=words, size=len(spoilt)):
            status, answer = uploaded(served, spoilt)
            (wrong,) = answer["detail"]
            assert (status, wrong["field"]) == (422, "brain")
            assert wrong["reason"].startswith("this file is no brain that can be taken back")
            assert words in wrong["reason"]
    assert served.engine.commands == []


def test_a_file_that_unpacks_to_too_much_is_refused_before_it_is_unpacked(monkeypatch) -> None:
    monkeypatch.setattr(archive, "MOST_BYTES", 1 << 20)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("json.npy", b"")
        file.writestr("a0.npy", bytes(2 << 20))
    with pytest.raises(ValueError, match="too large: 2 MiB unpacked, at most 1 are allowed"):
        unpacked(out.getvalue())


def test_a_brain_goes_down_as_a_file_if_it_could_come_up_again(served: House, brain: RatSlam, monkeypatch) -> None:
    served.engine.answer = Accepted(12, brain)
    with monkeypatch.context() as narrow:
        narrow.setattr(archive, "MOST_BYTES", 1000)
        answer = served.client.get("/api/brain")
    words = answer.json()["detail"][0]["reason"]
    assert answer.status_code == 507
    assert words.startswith("this brain cannot be sent: too large for a file: ")
    assert words.endswith(" MiB of arrays, at most 0 can be read again")
    answer = served.client.get("/api/brain")
    assert answer.status_code == 200
    assert answer.headers["content-disposition"] == 'attachment; filename="brain-office-seed3.npz"'
    assert unpacked(answer.content).digest() == brain.digest()
    assert served.engine.commands == [ReadBrain()] * 2
    served.engine.answer = Refused("type", "ReadBrain", "the engine has ended")
    answer = served.client.get("/api/brain")
    assert (answer.status_code, answer.json()["detail"][0]["reason"]) == (503, "the engine has ended")


def test_who_asks_while_a_brain_is_made_gets_the_same_and_who_comes_later_another_one(
    brain: RatSlam, monkeypatch
) -> None:
    answers: list[Future] = []

    def submit(_request: ReadBrain) -> Future:
        answers.append(Future())
        return answers[-1]

    async def nothing(*_: object) -> None:
        """Stands in for sending and receiving."""

    async def taken(asked: asyncio.Task) -> bytes:
        answer = await asked
        await answer({"type": "http"}, nothing, nothing)
        return answer.body

    async def ask() -> list[bytes]:
        download = BrainDownload(submit)  # type: ignore[arg-type]
        asked = [asyncio.create_task(download.answer({})) for _ in range(3)]
        while not answers:
            await asyncio.sleep(0)
        with monkeypatch.context() as hasty:
            hasty.setattr(brains, "FRESH_S", -1.0)  # so that the file is already too old
            with pytest.raises(NoAnswer, match="is being sent to somebody") as refused:
                await download.answer({})
        assert refused.value.status == 429
        answers[0].set_result(Accepted(12, brain))
        same = [(await one).body for one in asked]
        assert [await taken(one) for one in asked] == same
        asked = [asyncio.create_task(download.answer({}))]
        while len(answers) == 1:
            await asyncio.sleep(0)
        answers[1].set_result(Accepted(12, brain))
        return [*same, await taken(asked[0])]

    first, second, third, later = asyncio.run(ask())
    assert first is second is third is not later
    assert len(answers) == 2


def test_another_site_cannot_have_a_brain_or_anything_else_copied(served: House) -> None:
    paths = "brain brain/kept state?map=1 experience/0 world world/file export?to=mcap"
    for site in ("cross-site", "same-site"):
        for path in paths.split():
            answer = served.client.get(f"/api/{path}", headers={"Sec-Fetch-Site": site})
            assert (answer.status_code, "another site" in answer.text) == (403, True)
        assert served.client.get("/", headers={"Sec-Fetch-Site": site}).status_code == 200  # a link may lead here
    assert served.engine.commands == []
    assert served.client.get("/api/state", headers={"Sec-Fetch-Site": "same-origin"}).status_code == 200


def test_a_brain_comes_up_and_is_used_unless_the_engine_refuses_it(served: House, brain: RatSlam, file: bytes) -> None:
    status, answer = uploaded(served, file)
    assert (status, answer["accepted"]) == (200, True)
    (request,) = served.engine.commands
    assert isinstance(request, UseBrain)
    assert isinstance(request.brain, RatSlam)
    assert request.brain.digest() == brain.digest()
    served.engine.answer = Refused("brain", None, "this brain cannot be used here: it has no sonars")
    status, answer = uploaded(served, file)
    assert (status, answer["detail"][0]["reason"]) == (422, served.engine.answer.reason)


def test_only_binary_of_a_bounded_size_and_number_from_here_is_taken(served: House, monkeypatch) -> None:
    now_s = security.time.monotonic()
    monkeypatch.setattr(security, "time", SimpleNamespace(monotonic=lambda: now_s))
    assert served.client.post("/api/brain", json={}).status_code == 415
    assert served.client.post("/api/commands", content=b"{}", headers=BINARY).status_code == 415
    assert uploaded(served, b"x", **{"Content-Length": str(MAX_BRAIN_BYTES + 1)})[0] == 413
    assert uploaded(served, b"x", Origin="http://evil.example")[0] == 403
    codes = [uploaded(served, b"x")[0] for _ in range(14)]
    assert (codes[0], 429 in codes) == (422, True)
    assert served.engine.commands == []
