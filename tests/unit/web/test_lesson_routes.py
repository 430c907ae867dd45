"""The routes of the lessons, and the commands that give one."""

from __future__ import annotations

from typing import Any

import pytest
from starlette.testclient import TestClient

from app.gallery.lessons import StoredLessons
from tests.unit.web.doubles import ORIGIN, StubEngine, house
from web.messages import BeginLesson, Predict


@pytest.fixture
def parts() -> dict[str, Any]:
    return {"lessons": StoredLessons()}


def test_all_lessons_in_short(client: TestClient) -> None:
    cards = client.get("/api/lessons").json()
    assert {"name", "title", "idea", "paper", "number", "minutes"} <= set(cards[0])
    assert [card["number"] for card in cards] == list(range(1, len(cards) + 1))


def test_one_with_its_formulas_whose_symbols_name_their_parameters(client: TestClient) -> None:
    text = client.get("/api/lessons/kidnapped").json()
    assert text["card"]["title"] == "Kidnapped"
    assert text["explains"]
    assert not client.get("/api/lessons/packet").json()["explains"]
    assert [option.startswith("It") for option in text["predict"]["options"]] == [True] * 3
    formula = text["formulas"][0]
    assert formula["mathml"].startswith("<math")
    assert 'data-parameter="local_view.saturation"' in formula["mathml"]
    assert [symbol["parameter"] for symbol in formula["symbols"]][-1] == "local_view.saturation"
    assert formula["symbols"][-1]["value"] == "0.02"


def test_what_there_is_not(client: TestClient) -> None:
    answer = client.get("/api/lessons/castle")
    assert (answer.status_code, answer.json()["detail"][0]["reason"]) == (
        404,
        "there is no lesson 'castle'; /api/lessons lists them",
    )


def test_the_commands(client: TestClient, engine: StubEngine) -> None:
    for command in ({"type": "begin_lesson", "name": "kidnapped"}, {"type": "predict", "choice": 1}):
        assert client.post("/api/commands", json=command, headers={"Origin": ORIGIN}).json()["accepted"]
    assert engine.commands == [BeginLesson(type="begin_lesson", name="kidnapped"), Predict(type="predict", choice=1)]


def test_no_lessons_without_a_folder_of_them() -> None:
    with house() as server:
        assert server.client.get("/api/lessons").json() == []
