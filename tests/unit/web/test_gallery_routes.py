"""The routes of what the page can show without a run: experiments and lessons, and the commands that begin one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from app.gallery import StoredLessons
from tests.unit.web.doubles import House, house
from web.http.gallery import Axis, Card, Cell, Detail, Dot, Plan, Results
from web.http.security import Bucket
from web.messages import BeginLesson, Predict, Refused, WatchExperiment

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
    return {"experiments": GalleryDouble(picture), "lessons": StoredLessons()}


def test_all_experiments_and_one_with_its_trials_and_its_picture(client: TestClient) -> None:
    assert client.get("/api/experiments").json() == [CARD.model_dump(mode="json")]
    assert client.get("/api/experiments/table").json() == DETAIL.model_dump(mode="json")
    answer = client.get("/api/experiments/table/picture")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "image/svg+xml")
    assert "script-src 'self'" in answer.headers["content-security-policy"]
    document = client.get("/openapi.json").json()
    assert {"/api/experiments", "/api/experiments/{name}", "/api/experiments/{name}/picture"} <= set(document["paths"])
    assert "WatchExperiment" in document["components"]["schemas"]


def test_all_lessons_in_short_and_one_with_formulas_whose_symbols_name_their_parameters(client: TestClient) -> None:
    cards = client.get("/api/lessons").json()
    assert {"name", "title", "idea", "paper", "number", "minutes"} <= set(cards[0])
    assert [card["number"] for card in cards] == list(range(1, len(cards) + 1))
    text = client.get("/api/lessons/kidnapped").json()
    assert (text["card"]["title"], bool(text["explains"])) == ("Kidnapped", True)
    assert not client.get("/api/lessons/packet").json()["explains"]
    assert (len(text["predict"]["options"]), bool(text["more"])) == (3, True)
    formula = text["formulas"][0]
    assert formula["mathml"].startswith("<math")
    assert 'data-parameter="local_view.saturation"' in formula["mathml"]
    assert [formula["symbols"][-1][key] for key in ("parameter", "value")] == ["local_view.saturation", "0.0007"]


def test_what_is_not_there_is_said_and_without_a_gallery_there_is_nothing(client: TestClient, monkeypatch) -> None:
    for path, words in {
        "/api/experiments/castle": "'castle'",
        "/api/experiments/castle/picture": "'castle'",
        "/api/lessons/castle": "there is no lesson 'castle'; /api/lessons lists them",
    }.items():
        answer = client.get(path)
        assert (answer.status_code, words in answer.json()["detail"][0]["reason"]) == (404, True), path
    with house() as made:
        assert [made.client.get(f"/api/{path}").json() for path in ("experiments", "lessons")] == [[], []]
        monkeypatch.setattr(Bucket, "take", lambda _: False)  # somebody asks too often
        paths = ("experiments", "experiments/castle", "lessons", "lessons/castle")
        assert [made.client.get(f"/api/{path}").status_code for path in paths] == [429] * 4


def test_their_commands_are_taken_and_refused_like_any_other(served: House) -> None:
    commands = {
        b'{"type": "begin_lesson", "name": "kidnapped"}': BeginLesson(type="begin_lesson", name="kidnapped"),
        b'{"type": "predict", "choice": 1}': Predict(type="predict", choice=1),
        b'{"type": "watch_experiment", "experiment": "table", "levels": ["0 %"], "moment_s": 60.0}': WatchExperiment(
            type="watch_experiment", experiment="table", levels=["0 %"], moment_s=60.0
        ),
    }
    assert [served.post(body)[0] for body in commands] == [200] * 3
    assert served.engine.commands == list(commands.values())
    served.engine.answer = Refused("levels", ["9 %"], "N_vis has no level '9 %'; expected one of: 0 %, 2 %")
    status, answer = served.post(list(commands)[-1])
    assert (status, answer["detail"][0]["field"]) == (422, "levels")
    for fields, words in (
        (b'"experiment": "table", "engine": "theirs"', "engine must be paper, paper-2005, paper-2006 or ours"),
        (b'"experiment": "table", "levels": [2]', "levels must be a list of texts"),
        (b'"experiment": "table", "moment_s": -1', "moment_s must be at least 0"),
        (b'"seed": 3', "experiment is missing"),
    ):
        status, answer = served.post(b'{"type": "watch_experiment", ' + fields + b"}")
        assert (status, words in answer["detail"][0]["reason"]) == (422, True), words
