"""The routes: state, commands and their errors, pages, documents."""

from __future__ import annotations

import re
from typing import Any

import orjson
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fake_snapshots import fake_reports, fake_snapshot
from tests.unit.web.doubles import house
from web.http import asking
from web.http.api import STATIC
from web.http.commands import MODELS, Malformed, check, read_object
from web.messages import Accepted, Drive, Kidnap, ReadExperience, Refused, Reset, SetGoal, SetSpeed
from web.messages.commands import FASTEST, SLOWEST

pytestmark = pytest.mark.slow


def test_before_the_first_tick_it_is_told_how_far_the_start_has_come() -> None:
    with house(empty=True) as young, young.stream() as page:
        assert page.receive_json()["type"] == "hello"
        assert page.receive_json() == {"type": "waking", "doing": "starting"}
        young.latest.waking = "compiling 3 of 7"
        assert page.receive_json() == {"type": "waking", "doing": "compiling 3 of 7"}
        health, *others = (young.client.get(route) for route in ("/healthz", "/api/state", "/api/places"))
        assert [answer.status_code for answer in (health, *others)] == [503] * 3
        assert health.json() == {"status": "starting", "doing": "compiling 3 of 7", "tick": None}
        assert all("first tick yet (compiling 3 of 7)" in answer.json()["detail"][0]["reason"] for answer in others)
        young.latest.put(fake_snapshot(0))
        assert page.receive_json()["type"] == "state"
        health, places = young.client.get("/healthz"), young.client.get("/api/places")
        assert (health.status_code, health.json(), places.status_code) == (200, {"status": "ok", "tick": 0}, 200)


def test_the_page_offers_the_speeds_there_are() -> None:
    select = (STATIC / "index.html").read_text("utf-8").split('id="speed"')[1].split("</select>")[0]
    offered = [SetSpeed(type="set_speed", factor=float(v)).factor for v in re.findall(r'value="([^"]*)"', select)]
    assert (min(offered), sorted(offered)[1], max(offered)) == (0.0, SLOWEST, FASTEST)


def test_state_with_and_without_the_map_and_a_wrong_query_is_named(client) -> None:
    light, full, wrong = (client.get(f"/api/state{query}") for query in ("", "?map=1", "?map=perhaps"))
    told = full.json()["map"]
    assert "map" not in light.json()
    assert len(told["ids"]) == len(told["xy"]) > max(map(max, told["links"]))
    assert (wrong.status_code, wrong.json()["detail"][0]["field"]) == (422, "map")


def test_a_command_reaches_the_engine(served) -> None:
    commands = {
        b'{"type": "set_goal", "x": 1, "y": -2.5}': SetGoal(type="set_goal", x=1.0, y=-2.5),
        b'{"type": "kidnap"}': Kidnap(type="kidnap"),
        b'{"type": "reset", "seed": 7}': Reset(type="reset", seed=7),
        b'{"type": "drive", "speed": 0.5, "yaw_rate": -1.6}': Drive(type="drive", speed=0.5, yaw_rate=-1.6),
    }
    assert [served.post(body) for body in commands] == [(200, {"accepted": True, "tick": 5})] * len(commands)
    assert served.engine.commands == list(commands.values())


def test_a_command_that_the_engine_does_not_carry_out_is_told_with_the_reason(served, monkeypatch, subtests) -> None:
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.02)
    for answer, status, wrong in (
        (Refused("x", 99.0, "nothing is near"), 422, {"field": "x", "value": 99.0, "reason": "nothing is near"}),
        (None, 503, "did not answer"),
        (RuntimeError("out of cheese"), 500, "out of cheese"),
    ):
        with subtests.test(answer=answer):
            served.engine.answer = answer
            got, body = served.post(b'{"type": "set_goal", "x": 99, "y": 0}')
            (told,) = body["detail"]
            assert got == status
            assert told == wrong if isinstance(wrong, dict) else wrong in told["reason"]


SPEED = "factor must be 0 (as fast as possible) or from 0.25 to 16, got"
WRONG = [
    ('{"type": "dance"}', "type", 'type "dance" is not a command; expected one of: set_goal, cancel_goal'),
    ("{}", "type", "type is missing; expected one of: set_goal"),
    ('{"type": "set_goal", "x": 1}', "y", "y is missing; set_goal takes x, y"),
    ('{"type": "pause", "now": true}', "now", "now is not a field of pause, which takes no fields"),
    ('{"type": "drive", "speed": 3, "yaw_rate": 0}', "speed", "speed must be at most 0.5, got 3"),
    ('{"type": "drive", "speed": -3, "yaw_rate": 0}', "speed", "speed must be at least -0.5, got -3"),
    ('{"type": "drive", "speed": true, "yaw_rate": 0}', "speed", "speed must be a number, got true"),
    ('{"type": "set_goal", "x": "1", "y": 0}', "x", 'x must be a number, got "1"'),
    ('{"type": "step", "ticks": 1.5}', "ticks", "ticks must be a whole number, got 1.5"),
    ('{"type": "step", "ticks": 0}', "ticks", "ticks must be at least 1, got 0"),
    ('{"type": "set_speed", "factor": 16.5}', "factor", f"{SPEED} 16.5"),
    ('{"type": "set_speed", "factor": 0.1}', "factor", f"{SPEED} 0.1"),
    ('{"type": "set_mode", "mode": "fly"}', "mode", 'mode must be explore, manual or goal, got "fly"'),
    ('{"type": "reset", "seed": -1}', "seed", "seed must be at least 0, got -1"),
    (f'{{"type": "reset", "seed": {2**80}}}', "seed", "seed "),
    ('{"type": "reset", "world": 3}', "world", "world must be text, got 3"),
    ('{"type": "set_parameter", "name": "a", "value": [1]}', "value", "value must be a number, true, false or text"),
    (f'{{"type": "set_parameter", "name": "{"n" * 90}", "value": 1}}', "name", "name must have at most 64 characters"),
    ("[1, 2]", None, 'a command is a JSON object such as {"type": "pause"}, got [1,2]'),
    ("[" + '{"a": []},' * 100_000, None, "this has 200001 brackets [ and {; at most 100000 are allowed"),
    *[
        (bad, None, "this is not JSON")
        for bad in ('{"type": "set_goal", "x": NaN, "y": 0}', '{"type": "set_goal", "x": Infinity, "y": 0}',
                    '{"type": ', "", b"\xff\xfe", "[" * 5000)
    ],
]  # fmt: skip


def test_what_is_wrong_is_said_with_field_value_and_remedy(subtests) -> None:
    for body, field, reason in WRONG:
        with subtests.test(body=body[:60]):
            with pytest.raises(Malformed) as error:
                check(read_object(body))
            first = error.value.wrongs[0]
            assert first["field"] == field
            assert first["reason"].startswith(reason)
            assert str(error.value) == first["reason"]


def test_every_wrong_field_is_named_long_values_are_cut_and_odd_ones_are_text() -> None:
    with pytest.raises(Malformed) as error:
        check({"type": "set_goal", "x": "a" * 5000, "y": float("inf"), "z": 1 << 400})
    x, y, z = error.value.wrongs
    assert len(x["value"]) < 100
    assert y["reason"].startswith("y must be a finite number")
    assert z["value"].startswith("25822498780869085896")
    orjson.dumps(error.value.wrongs)


def test_what_is_nested_too_deeply_is_refused_on_every_route(subtests) -> None:
    for route in ("commands", "worlds/new", "worlds/open", "worlds/save", "worlds/delete"):
        with house() as server:
            for levels in (20, 254, 255, 1023, 9000):
                lists = b'{"type": ' + b"[" * levels + b"]" * levels + b"}"
                for body in (lists, b'{"a":' * levels + b"[]" + b"}" * levels):
                    with subtests.test(route=route, levels=levels, lists=body == lists):
                        sent = {"content": body, "headers": {"Content-Type": "application/json"}}
                        answer = server.client.post(f"/api/{route}", **sent)
                        reason = answer.json()["detail"][0]["reason"]
                        either = ["this is not JSON"] if levels > 1022 else []
                        assert answer.status_code == 422
                        assert reason.startswith(("nested too deeply; at most 20", *either))
            assert server.engine.commands == []
    assert read_object(b'{"a":' + b"[" * 19 + b"]" * 19 + b"}")
    assert read_object('{"a":[' + "[]," * 99_997 + "[]]}")  # a hundred thousand brackets


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
FIELDS = "x y heading_rad speed yaw_rate mode ticks factor world seed name value"


@settings(max_examples=100)
@given(
    st.dictionaries(st.sampled_from(FIELDS.split()), json_values, max_size=4),
    st.sampled_from([*MODELS, "nonsense"]) | json_values,
)
def test_anything_is_a_command_or_a_sentence(rest: dict[str, Any], kind: Any) -> None:
    wrongs: list[dict[str, Any]] = []
    try:
        assert check({**rest, "type": kind}).type == kind
    except Malformed as error:
        wrongs = error.wrongs
    assert orjson.dumps(wrongs)
    assert all(wrong["reason"] for wrong in wrongs)


def test_pages_are_there_and_nothing_else(client, subtests) -> None:
    for path, holds in {
        "/": "<title>RatSLAM</title>",
        "/docs": "docs/docs.js",
        "/static/main.js": "Connection",
        "/favicon.ico": "<svg",
    }.items():
        answer = client.get(path)
        assert (answer.status_code, holds in answer.text) == (200, True), path
    for path in ("/nothing", "/static/../api.py", "/static/%2e%2e/api.py", "/viser/../api.py", "/viser/x"):
        with subtests.test(path=path):
            answer = client.get(path)
            assert answer.status_code == 404
            assert answer.json()["detail"][0]["reason"].startswith("there is nothing at")
    answer = client.put("/api/state", headers={"Content-Type": "application/json"}, content=b"{}")
    assert (answer.status_code, answer.headers["allow"]) == (405, "GET")
    assert "PUT" in answer.json()["detail"][0]["reason"]


def test_nothing_in_the_pages_comes_from_elsewhere() -> None:
    for file in STATIC.rglob("*.*"):
        if "vendor" not in file.parts:  # its licence and comments name addresses, which it does not ask
            text = file.read_text(encoding="utf-8").replace("http://www.w3.org/", "")
            assert not re.search("https?://", text), file


def test_openapi_knows_every_command(client) -> None:
    document = client.get("/openapi.json").json()
    body = document["paths"]["/api/commands"]["post"]["requestBody"]["content"]["application/json"]["schema"]
    named = {reference.split("/")[-1] for reference in body["discriminator"]["mapping"].values()}
    assert set(body["discriminator"]["mapping"]) == set(MODELS)
    assert named | {"Problem"} <= set(document["components"]["schemas"])


def test_an_experience_is_told_or_refused_when_there_is_none(client, engine) -> None:
    engine.answer = Accepted(5, fake_reports()["experience"])
    answer = client.get("/api/experience/12")
    told = answer.json()
    assert engine.commands == [ReadExperience(12)]
    assert (answer.status_code, told["id"], told["view"], told["visits"]) == (200, 12, 7, 4)
    assert told["links"][0] | {"distance_m": 1.5, "behaviour": "following the wall"} == told["links"][0]
    assert len(told["view_links"]["cells"]) == len(told["view_links"]["strength"]) == 3
    engine.answer = Refused("experience", 12, "experience must be from 0 to 3, got 12")
    answer = client.get("/api/experience/12")
    assert answer.status_code == 422
    assert answer.json()["detail"] == [{"field": "experience", "value": 12, "reason": engine.answer.reason}]
    assert client.get("/api/experience/-1").status_code == 422
