"""The routes: state, commands and their errors, pages, documents."""

from __future__ import annotations

import re

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


@pytest.fixture
def server():
    with house() as made:
        yield made


def test_healthz_tells_the_tick(server):
    assert server.client.get("/healthz").json() == {"status": "ok", "tick": 12}


def test_before_the_first_tick():
    with house(empty=True) as young:
        young.latest.waking = "compiling 3 of 7"
        answer = young.client.get("/healthz")
        assert answer.status_code == 503
        assert answer.json() == {"status": "starting", "doing": "compiling 3 of 7", "tick": None}
        answer = young.client.get("/api/state")
        assert answer.status_code == 503
        assert "first tick yet (compiling 3 of 7)" in answer.json()["detail"][0]["reason"]
        young.latest.put(fake_snapshot(0))
        answer = young.client.get("/healthz")
        assert (answer.status_code, answer.json()) == (200, {"status": "ok", "tick": 0})


def test_the_page_hears_how_far_the_start_has_come():
    with house(empty=True) as young, young.stream() as page:
        assert page.receive_json()["type"] == "hello"
        assert page.receive_json() == {"type": "waking", "doing": "starting"}
        young.latest.waking = "compiling 3 of 7"
        assert page.receive_json() == {"type": "waking", "doing": "compiling 3 of 7"}
        young.latest.put(fake_snapshot(0))
        assert page.receive_json()["type"] == "state"


def test_the_page_offers_the_speeds_there_are():
    select = (STATIC / "index.html").read_text("utf-8").split('id="speed"')[1].split("</select>")[0]
    offered = [float(value) for value in re.findall(r'value="([^"]*)"', select)]
    for factor in offered:
        SetSpeed(type="set_speed", factor=factor)
    assert (min(offered), sorted(offered)[1], max(offered)) == (0.0, SLOWEST, FASTEST)


def test_state_with_and_without_the_map(server):
    light, full = server.client.get("/api/state").json(), server.client.get("/api/state?map=1").json()
    assert "map" not in light
    assert len(full["map"]["ids"]) == len(full["map"]["xy"]) > max(map(max, full["map"]["links"]))


def test_a_wrong_query_is_named(server):
    answer = server.client.get("/api/state?map=perhaps")
    assert answer.status_code == 422
    assert answer.json()["detail"][0]["field"] == "map"


@pytest.mark.parametrize(
    ("body", "command"),
    [
        (b'{"type": "set_goal", "x": 1, "y": -2.5}', SetGoal(type="set_goal", x=1.0, y=-2.5)),
        (b'{"type": "kidnap"}', Kidnap(type="kidnap")),
        (b'{"type": "reset", "seed": 7}', Reset(type="reset", seed=7)),
        (b'{"type": "drive", "speed": 0.5, "yaw_rate": -1.6}', Drive(type="drive", speed=0.5, yaw_rate=-1.6)),
    ],
)
def test_a_command_reaches_the_engine(server, body, command):
    assert server.post(body) == (200, {"accepted": True, "tick": 5})
    assert server.engine.commands == [command]


def test_a_refusal_of_the_engine_has_field_value_and_reason(server):
    server.engine.answer = Refused("x", 99.0, "there is no experience near")
    assert server.post(b'{"type": "set_goal", "x": 99, "y": 0}') == (
        422,
        {"detail": [{"field": "x", "value": 99.0, "reason": "there is no experience near"}]},
    )


def test_a_silent_engine_is_503(server, monkeypatch):
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.02)
    server.engine.answer = None
    status, body = server.post(b'{"type": "pause"}')
    assert status == 503
    assert "did not answer" in body["detail"][0]["reason"]


def test_an_engine_that_fails_says_so(server):
    server.engine.answer = RuntimeError("out of cheese")
    status, body = server.post(b'{"type": "pause"}')
    assert status == 500
    assert "out of cheese" in body["detail"][0]["reason"]


WRONG = [
    (b'{"type": "dance"}', "type", 'type "dance" is not a command; expected one of: set_goal, cancel_goal'),
    (b"{}", "type", "type is missing; expected one of: set_goal"),
    (b'{"type": "set_goal", "x": 1}', "y", "y is missing; set_goal takes x, y"),
    (b'{"type": "pause", "now": true}', "now", "now is not a field of pause, which takes no fields"),
    (b'{"type": "drive", "speed": 3, "yaw_rate": 0}', "speed", "speed must be at most 0.5, got 3"),
    (b'{"type": "drive", "speed": -3, "yaw_rate": 0}', "speed", "speed must be at least -0.5, got -3"),
    (b'{"type": "drive", "speed": true, "yaw_rate": 0}', "speed", "speed must be a number, got true"),
    (b'{"type": "set_goal", "x": "1", "y": 0}', "x", 'x must be a number, got "1"'),
    (b'{"type": "step", "ticks": 1.5}', "ticks", "ticks must be a whole number, got 1.5"),
    (
        b'{"type": "set_speed", "factor": 16.5}',
        "factor",
        "factor must be 0 (as fast as possible) or from 0.25 to 16, got 16.5",
    ),
    (
        b'{"type": "set_speed", "factor": 0.1}',
        "factor",
        "factor must be 0 (as fast as possible) or from 0.25 to 16, got 0.1",
    ),
    (b'{"type": "step", "ticks": 0}', "ticks", "ticks must be at least 1, got 0"),
    (b'{"type": "set_mode", "mode": "fly"}', "mode", 'mode must be explore, manual or goal, got "fly"'),
    (b'{"type": "reset", "seed": -1}', "seed", "seed must be at least 0, got -1"),
    (b'{"type": "reset", "world": 3}', "world", "world must be text, got 3"),
    (b'{"type": "set_parameter", "name": "a", "value": [1]}', "value", "value must be a number, true, false or text"),
    (
        b'{"type": "set_parameter", "name": "%s", "value": 1}' % (b"n" * 90),
        "name",
        "name must have at most 64 characters",
    ),
    (b"[1, 2]", None, 'a command is a JSON object such as {"type": "pause"}, got [1,2]'),
    (b'{"type": "set_goal", "x": NaN, "y": 0}', None, "this is not JSON"),
    (b'{"type": "set_goal", "x": Infinity, "y": 0}', None, "this is not JSON"),
    (b'{"type": ', None, "this is not JSON"),
    (b"", None, "this is not JSON"),
    (b"\xff\xfe", None, "this is not JSON"),
    (b"[" * 5000, None, "this is not JSON"),
]


@pytest.mark.parametrize(("body", "field", "reason"), WRONG)
def test_what_is_wrong_is_said_with_field_value_and_remedy(body, field, reason):
    with pytest.raises(Malformed) as error:
        check(read_object(body))
    first = error.value.wrongs[0]
    assert first["field"] == field
    assert first["reason"].startswith(reason)
    assert str(error.value)


@pytest.mark.parametrize("levels", [20, 128, 254, 255, 1000, 1022, 1023, 9000])
@pytest.mark.parametrize("route", ["commands", "worlds/new", "worlds/open", "worlds/save", "worlds/delete"])
def test_what_is_nested_too_deeply_is_refused_on_every_route(server, levels, route):
    for body in (b'{"type": ' + b"[" * levels + b"]" * levels + b"}", b'{"a":' * levels + b"[]" + b"}" * levels):
        answer = server.client.post(f"/api/{route}", content=body, headers={"Content-Type": "application/json"})
        assert answer.status_code == 422
        reason = answer.json()["detail"][0]["reason"]
        assert reason.startswith(("nested too deeply; at most 20", *(["this is not JSON"] if levels > 1022 else [])))
    assert server.engine.commands == []


def test_a_body_of_brackets_alone_is_not_unpacked():
    with pytest.raises(Malformed, match=r"this has 200001 brackets \[ and \{; at most 100000 are allowed"):
        read_object(b"[" + b"[]," * 200_000)


def test_every_wrong_field_is_named(server):
    status, body = server.post(b'{"type": "drive", "speed": 3, "yaw_rate": "a", "z": 1}')
    assert status == 422
    assert [wrong["field"] for wrong in body["detail"]] == ["speed", "yaw_rate", "z"]
    assert server.engine.commands == []


def test_long_values_are_cut_and_odd_ones_are_text():
    with pytest.raises(Malformed) as error:
        check({"type": "set_goal", "x": "a" * 5000, "y": float("inf"), "z": 1 << 400})
    x, y, z = error.value.wrongs
    assert len(x["value"]) < 100
    assert y["reason"].startswith("y must be a finite number")
    assert z["value"].startswith("25822498780869085896")
    orjson.dumps(error.value.wrongs)


def test_an_unforeseen_message_is_still_a_sentence():
    with pytest.raises(Malformed) as error:
        check({"type": "reset", "seed": 2**80})
    assert "seed" in error.value.wrongs[0]["reason"]


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
fields = st.sampled_from(
    ["x", "y", "heading_rad", "speed", "yaw_rate", "mode", "ticks", "factor", "world", "seed", "name", "value"]
)


@settings(max_examples=300)
@given(
    st.dictionaries(fields, json_values, max_size=4),
    st.sampled_from([*MODELS, "nonsense"]) | json_values,
)
def test_anything_is_a_command_or_a_sentence(rest, kind):
    wrongs: list = []
    try:
        assert check({**rest, "type": kind}).type == kind
    except Malformed as error:
        wrongs = error.wrongs
        orjson.dumps(wrongs)
    assert all(wrong["reason"] for wrong in wrongs)


@pytest.mark.parametrize(
    "path", ["/nothing", "/static/../api.py", "/static/%2e%2e/api.py", "/viser/../api.py", "/viser/x"]
)
def test_there_is_nothing_else(server, path):
    answer = server.client.get(path)
    assert answer.status_code == 404
    assert answer.json()["detail"][0]["reason"].startswith("there is nothing at")


def test_a_wrong_method_is_said(server):
    answer = server.client.put("/api/state", headers={"Content-Type": "application/json"}, content=b"{}")
    assert answer.status_code == 405
    assert "PUT" in answer.json()["detail"][0]["reason"]
    assert answer.headers["allow"] == "GET"


@pytest.mark.parametrize(
    ("path", "holds"),
    [
        ("/", "<title>RatSLAM</title>"),
        ("/docs", "docs/docs.js"),
        ("/static/main.js", "Connection"),
        ("/favicon.ico", "<svg"),
    ],
)
def test_pages_are_there(server, path, holds):
    answer = server.client.get(path)
    assert answer.status_code == 200
    assert holds in answer.text


def test_nothing_in_the_pages_comes_from_elsewhere():
    for file in STATIC.rglob("*.*"):
        if "vendor" in file.parts:  # its licence and comments name addresses, which it does not ask
            continue
        text = file.read_text(encoding="utf-8").replace("http://www.w3.org/", "")
        assert "http://" not in text, file
        assert "https://" not in text, file
        assert "innerHTML" not in text, file


def test_openapi_knows_every_command(server):
    document = server.client.get("/openapi.json").json()
    schemas = document["components"]["schemas"]
    mapping = document["paths"]["/api/commands"]["post"]["requestBody"]["content"]["application/json"]["schema"][
        "discriminator"
    ]["mapping"]
    assert set(mapping) == set(MODELS)
    assert all(reference.split("/")[-1] in schemas for reference in mapping.values())
    assert "Problem" in schemas


def test_an_experience_is_told(server):
    report = fake_reports()["experience"]
    server.engine.answer = Accepted(5, report)
    answer = server.client.get("/api/experience/12")
    assert answer.status_code == 200
    told = answer.json()
    assert server.engine.commands == [ReadExperience(12)]
    assert (told["id"], told["view"], told["visits"]) == (12, 7, 4)
    assert told["links"][0] | {"distance_m": 1.5, "behaviour": "following the wall"} == told["links"][0]
    assert len(told["view_links"]["cells"]) == len(told["view_links"]["strength"]) == 3


def test_an_experience_that_is_not_there_is_refused(server):
    server.engine.answer = Refused("experience", 12, "experience must be from 0 to 3, got 12")
    answer = server.client.get("/api/experience/12")
    assert answer.status_code == 422
    assert answer.json()["detail"] == [
        {"field": "experience", "value": 12, "reason": "experience must be from 0 to 3, got 12"}
    ]
    assert server.client.get("/api/experience/-1").status_code == 422
