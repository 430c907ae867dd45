"""The routes of situations: what a page is told of the moment, with its camera, and what is wrong with what it sends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.unit.web.doubles import StubEngine
from web.http.security import MAX_BODY_BYTES
from web.http.situations import Made
from web.messages import Accepted, Look, OpenSituation, ReadSituation, Refused


@dataclass(frozen=True)
class Moment:
    tick: int = 12
    state_hash: str = "ab" * 32
    look: Look = Look(plate="map")


class FewSituations:
    """The text "good" is a situation."""

    def made(self, spec: object, look: Look) -> Made:
        if spec == "unreadable":
            raise OSError(2, "No such file")
        return Made(
            link="run=x", why="", name="a.situation.json", file=look.model_dump_json(), python="", tick=12, time_s=1.2,
            state_hash="ab" * 32, orders=3,
        )  # fmt: skip

    def read(self, text: str) -> Moment:
        if not text.startswith("good"):
            raise ValueError("it is neither the file of a situation nor a link")
        return Moment()


@pytest.fixture
def parts() -> dict[str, Any]:
    return {"situations": FewSituations()}


def reason(answer: Any) -> str:
    assert answer.status_code == 422
    return answer.json()["detail"][0]["reason"]


def test_the_moment_is_made_with_what_the_page_shows(client: TestClient, engine: StubEngine) -> None:
    engine.answer = Accepted(12, "led here")
    answer = client.post("/api/situation", json={"plate": "pose", "tab": "Truth", "page": "nobody's"}).json()
    assert isinstance(engine.commands[-1], ReadSituation)
    assert Look.model_validate_json(answer.pop("file")) == Look(plate="pose", tab="Truth")
    assert answer == {
        "link": "run=x", "why": "", "name": "a.situation.json", "python": "", "tick": 12, "time_s": 1.2,
        "state_hash": "ab" * 32, "orders": 3,
    }  # fmt: skip
    engine.answer = Accepted(12, "unreadable")
    assert "the brain that the run began with cannot be read" in reason(client.post("/api/situation", json={}))


def test_a_link_or_a_long_file_is_opened(client: TestClient, engine: StubEngine) -> None:
    for text in ("good", "good" + "[" * 2 * MAX_BODY_BYTES):
        answer = client.post("/api/situation/open", json={"text": text})
        look = {"plate": "map", "tab": None, "camera": None}
        assert answer.json() == {"tick": 12, "state_hash": "ab" * 32, "look": look}
        command = engine.commands[-1]
        assert isinstance(command, OpenSituation)
        assert command.situation == Moment()


def test_what_is_wrong_is_said_and_reaches_no_engine(client: TestClient, engine: StubEngine) -> None:
    assert "neither the file" in reason(client.post("/api/situation/open", json={"text": "bad"}))
    for body in ({}, {"text": 3}, {"text": ""}, {"text": "good", "more": 1}, []):
        assert "this takes text" in reason(client.post("/api/situation/open", json=body))
    assert "plate" in reason(client.post("/api/situation", json={"plate": "moon"}))
    assert engine.commands == []
    engine.answer = Refused("situation", None, "it cannot be played here: no")
    assert "it cannot be played here" in reason(client.post("/api/situation/open", json={"text": "good"}))
    told = len(engine.commands)
    for headers in ({"Sec-Fetch-Site": "cross-site"}, {"Origin": "http://elsewhere.org"}):
        assert client.post("/api/situation/open", json={"text": "good"}, headers=headers).status_code == 403
    assert len(engine.commands) == told
