"""A brain goes down and comes up again; what is none is refused with a sentence."""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest

from ratslam_core import RatSlam
from ratslam_core.brain_snapshot import take_snapshot
from tests.unit.web.doubles import house
from web import brain_files
from web.brain_files import packed, unpacked
from web.messages import Accepted, ReadBrain, Refused, UseBrain
from web.security import MAX_BRAIN_BYTES

BINARY = {"Content-Type": "application/octet-stream"}


@pytest.fixture(scope="module")
def brain() -> RatSlam:
    brain = RatSlam()
    brain.local_view.observe(np.random.default_rng(0).integers(0, 256, (48, 64), np.uint8))
    return brain


@pytest.fixture
def server():
    with house() as made:
        yield made


def test_a_brain_that_is_packed_comes_out_the_same(brain: RatSlam) -> None:
    assert unpacked(packed(take_snapshot(brain))).digest() == brain.digest()


def changed(data: bytes) -> bytes:
    """With one number of one array changed."""
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
    monkeypatch.setattr(brain_files, "MAX_UNPACKED_BYTES", 1 << 20)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("json.npy", bytes(2 << 20))
    with pytest.raises(ValueError, match="too large: 2 MiB unpacked, at most 1 can be"):
        unpacked(out.getvalue())


def test_a_brain_goes_down_as_a_file(server, brain) -> None:
    server.engine.answer = Accepted(12, take_snapshot(brain))
    answer = server.client.get("/api/brain")
    assert answer.status_code == 200
    assert server.engine.commands == [ReadBrain()]
    assert answer.headers["content-disposition"] == 'attachment; filename="brain-office-seed3.npz"'
    assert unpacked(answer.content).digest() == brain.digest()


def test_a_brain_comes_up_and_is_used(server, brain) -> None:
    answer = server.client.post("/api/brain", content=packed(take_snapshot(brain)), headers=BINARY)
    assert (answer.status_code, answer.json()["accepted"]) == (200, True)
    (errand,) = server.engine.commands
    assert isinstance(errand, UseBrain)
    assert isinstance(errand.brain, RatSlam)
    assert errand.brain.digest() == brain.digest()


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
