"""The routes of the experiments' gallery, and the command that watches one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.unit.web.doubles import house
from web.http.experiments import Axis, Card, Cell, Detail, Dot, Plan, Results
from web.messages import Refused, WatchExperiment

PLAN = Plan(width=2, depth=1, left=0, bottom=0, walls="M0 0L2 0", way="", places=[(1.0, 0.5)])
CARD = Card(
    name="table", title="A title", paper="D", asks="Why?", found="So.", world="Office", engines=["paper", "ours"],
    axes=[Axis(name="N_vis", levels=["0 %", "2 %"])], watch=["0 %"], seed=7, trials=10, seconds=60.0, done=1,
    picture="/api/experiments/table/picture", plan=PLAN,
)  # fmt: skip
DOT = Dot(id="a1", seed=7, quick=False, good=2, of=3, words="2 of 3", moment_s=61.0, moment="printer: not reached")
CELL = Cell(engine="ours", levels=["0 %"], n=1, words="67 % (21-94)", shade=0.67, dots=[DOT])
DETAIL = Detail(card=CARD, results=Results(score="goals reached", is_rate=True, note="", cells=[CELL]))


class GalleryDouble:
    def __init__(self, picture: Path) -> None:
        self._picture = picture

    def cards(self) -> list[Card]:
        return [CARD]

    def detail(self, name: str) -> Detail | None:
        return DETAIL if name == "table" else None

    def picture(self, name: str) -> Path | None:
        return self._picture if name == "table" else None


@pytest.fixture
def parts(tmp_path: Path) -> dict[str, Any]:
    picture = tmp_path / "table-1-curves.svg"
    picture.write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    return {"experiments": GalleryDouble(picture)}


def test_all_experiments_and_one_with_its_trials(client: TestClient) -> None:
    assert client.get("/api/experiments").json() == [CARD.model_dump(mode="json")]
    assert client.get("/api/experiments/table").json() == DETAIL.model_dump(mode="json")


def test_the_picture_has_its_type_and_the_page_policy(client: TestClient) -> None:
    answer = client.get("/api/experiments/table/picture")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "image/svg+xml")
    assert "script-src 'self'" in answer.headers["content-security-policy"]


@pytest.mark.parametrize("path", ["/api/experiments/castle", "/api/experiments/castle/picture"])
def test_what_is_not_there_is_said(client: TestClient, path: str) -> None:
    answer = client.get(path)
    assert answer.status_code == 404
    assert "'castle'" in answer.json()["detail"][0]["reason"]


def test_they_are_in_the_document(client: TestClient) -> None:
    document = client.get("/openapi.json").json()
    assert {"/api/experiments", "/api/experiments/{name}", "/api/experiments/{name}/picture"} <= set(document["paths"])
    assert "WatchExperiment" in document["components"]["schemas"]


def test_too_many_questions_are_declined(client: TestClient) -> None:
    assert 429 in [client.get("/api/experiments").status_code for _ in range(40)]


def test_without_a_gallery_there_are_none() -> None:
    with house() as made:
        assert made.client.get("/api/experiments").json() == []


def test_the_command_is_taken_and_refused_like_any_other() -> None:
    with house() as made:
        body = b'{"type": "watch_experiment", "experiment": "table", "levels": ["0 %"], "moment_s": 60.0}'
        assert made.post(body)[0] == 200
        assert made.engine.commands == [
            WatchExperiment(type="watch_experiment", experiment="table", levels=["0 %"], moment_s=60.0)
        ]
        made.engine.answer = Refused("levels", ["9 %"], "N_vis has no level '9 %'; expected one of: 0 %, 2 %")
        status, answer = made.post(body)
        assert status == 422
        assert answer["detail"][0]["field"] == "levels"


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (b'"experiment": "table", "engine": "theirs"', "engine must be paper, paper-2005, paper-2006 or ours"),
        (b'"experiment": "table", "levels": [2]', "levels must be a list of texts"),
        (b'"experiment": "table", "moment_s": -1', "moment_s must be at least 0"),
        (b'"seed": 3', "experiment is missing"),
    ],
)
def test_a_wrong_field_is_named(fields: bytes, words: str) -> None:
    with house() as made:
        status, answer = made.post(b'{"type": "watch_experiment", ' + fields + b"}")
        assert status == 422
        assert words in answer["detail"][0]["reason"]
