"""The door of a class: a table says what comes through, and everything else that the application has is refused."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import orjson
import pytest
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.testclient import TestClient, WebSocketDenialResponse

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import ORIGIN as MAIN_ORIGIN
from tests.unit.web.doubles import OURS, PAGE, PORT, StubEngine, StubViewer, StubViewers, viser_double
from tests.unit.web.test_watching import WATCHER, said
from web.http import class_door
from web.http.api import create_app
from web.http.class_door import MOST_WATCHERS, RATE_HZ, ClassDoor, Classroom
from web.latest import Latest
from web.messages import Vote

pytestmark = pytest.mark.slow

CLASSROOM = Classroom("192.168.1.5", 8001)
HOST, ORIGIN = "192.168.1.5:8001", "http://192.168.1.5:8001"
BALLOT = {"lesson": "packet", "voter": "somebody", "choice": 1}
STREAM, STAGE = f"/api/stream?page={WATCHER}", f"/viser/ws/{WATCHER}"
# What a class may do. A route that is new stays closed to it until somebody writes it here and in the door.
LOOKS = """/ /favicon.ico /static /viser/ /api/state /api/world /api/lessons /api/lessons/{name} /api/class /api/class.svg
    /api/stage.svg"""
OPEN = {("POST", "/api/vote"), ("websocket", "/api/stream"), ("websocket", "/viser/ws/{page}")} | {
    ("GET", path) for path in LOOKS.split()
}
UNLISTED = """/docs /openapi.json /healthz /api/commands /api/brain /api/state/ //api/state /api/lessons/a/b /static/
    /API/STATE /api/state;x /nothing /api/experience/1 /api/export /api/situation"""
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE")


@dataclass
class Built:
    engine: Any
    routes: list[Any]
    main: TestClient
    client: TestClient

    def vote(self, ballot: object = BALLOT, **headers: str) -> Any:
        sent = {"Origin": ORIGIN, "Content-Type": "application/json"} | headers
        return self.client.post("/api/vote", content=orjson.dumps(ballot), headers=sent)

    def connect(self, path: str, **headers: str) -> Any:
        sent = {"Host": HOST, "Origin": ORIGIN} | headers
        return self.client.websocket_connect(path, subprotocols=["viser-v1.1.1"], headers=sent)

    def refusal(self, path: str, **headers: str) -> tuple[int, str]:
        with pytest.raises(WebSocketDenialResponse) as refused, self.connect(path, **headers):
            pass
        return refused.value.status_code, refused.value.json()["detail"][0]["reason"]


@contextlib.contextmanager
def built(stage: StubViewer | None = None, classroom: Classroom | None = CLASSROOM) -> Iterator[Built]:
    engine, latest = StubEngine(), Latest()
    latest.put(fake_snapshot(12))
    guard = create_app(latest, engine.submit, StubViewers(stage), PORT, classroom=classroom)
    routes = guard.app.routes  # type: ignore[attr-defined]
    door = TestClient(ClassDoor(guard.app, CLASSROOM), base_url=ORIGIN, raise_server_exceptions=False)
    with TestClient(guard, base_url=MAIN_ORIGIN) as main:
        door.portal = main.portal  # one loop, as behind two listeners
        yield Built(engine, routes, main, door)


@pytest.fixture
def school(monkeypatch) -> Iterator[Built]:
    monkeypatch.setattr(class_door, "RATE_HZ", 1e6)
    with built() as made:
        yield made


def every_way(routes: list[Any]) -> Iterator[tuple[str, str]]:
    """Each route of the application with each method there is, and websockets."""
    for route in routes:
        if isinstance(route, WebSocketRoute):
            yield "websocket", route.path
        else:
            assert isinstance(route, Route | Mount), f"what is {route}?"
            yield from ((method, route.path) for method in METHODS)


def filled(path: str) -> str:
    path = {"/static": "/static/page.css", "/viser/ws/{page}": STAGE}.get(path, path)
    return re.sub(r"{\w+(:\w+)?}", "1", path)


def test_of_all_routes_only_those_of_the_table_are_open(school: Built) -> None:
    ways = set(every_way(school.routes))
    assert ways >= OPEN
    assert len(ways) > 150
    for method, path in sorted(ways):
        if method == "websocket":
            assert (method, path) in OPEN or school.refusal(filled(path))[0] == 403, path
            continue
        sent = {"Origin": ORIGIN, "Content-Type": "application/json"}
        answer = school.client.request(method, filled(path), headers=sent, content=b"{}" if method == "POST" else None)
        refused = answer.status_code == 403
        assert refused != ((method, path) in OPEN), (method, path, answer.status_code)
        if refused and method != "HEAD":
            assert "for the main page alone" in answer.json()["detail"][0]["reason"]
    assert {type(asked).__name__ for asked in school.engine.commands} <= {"ReadWorld"}


def test_what_is_not_listed_is_refused_and_no_path_climbs_out_of_what_is_served(school: Built, subtests) -> None:
    for path in UNLISTED.split():
        with subtests.test(path=path):
            answers = [school.client.request(way, path, headers={"Origin": ORIGIN}) for way in ("GET", "POST")]
            assert [answer.status_code for answer in answers] == [403, 403]
    for path in ("/static/../api/brain", "/static/%2e%2e/%2e%2e/pyproject.toml", "/api/lessons/..%2fbrain"):
        assert school.client.get(path).status_code in (403, 404)


HOSTS = """192.168.1.5 192.168.1.5:8000 127.0.0.1:8001 127.0.0.1:8000 localhost:8001 evil.example:8001
    192.168.1.5:8001.evil.example 192.168.1.5:8001@evil.example 192.168.1.6:8001 0300.168.1.5:8001"""
ORIGINS = f"""null http://evil.example https://192.168.1.5:8001 http://192.168.1.5 http://192.168.1.5:8000 {MAIN_ORIGIN}
    http://localhost:8001 http://192.168.1.5:8001.evil.example"""


def test_any_other_host_and_any_other_origin_is_refused(school: Built, subtests) -> None:
    for header, values in (("Host", HOSTS.split()), ("Origin", ORIGINS.split())):
        for value in (*values, ""):
            with subtests.test(header=header, value=value):
                said = {header: value}
                assert school.client.get("/api/state", headers=said).status_code == 403
                assert school.vote(**said).status_code == 403
                assert [school.refusal(path, **said)[0] for path in (STREAM, STAGE)] == [403, 403]
    assert school.engine.commands == []


def test_a_vote_says_where_it_comes_from_and_counts_at_both_doors(school: Built) -> None:
    sent = {"content": orjson.dumps(BALLOT), "headers": {"Content-Type": "application/json"}}
    answer = school.client.post("/api/vote", **sent)
    assert (answer.status_code, ORIGIN in answer.json()["detail"][0]["reason"]) == (403, True)
    assert school.vote().json() == {"accepted": True, "tick": 5}
    sent["headers"] |= {"Origin": MAIN_ORIGIN}
    assert school.main.post("/api/vote", **sent).status_code == 200
    assert school.engine.commands == [Vote(type="vote", sender="testclient", **BALLOT)] * 2


def test_nothing_but_a_vote_is_taken(school: Built, subtests) -> None:
    for ballot, headers, status in (
        ({"type": "kidnap"}, {}, 422),
        ({**BALLOT, "type": "reset"}, {}, 200),  # it is a vote, whatever it calls itself
        ({**BALLOT, "sender": "another phone"}, {}, 200),  # and from here, whatever it says
        ({**BALLOT, "voter": "me"}, {}, 422),
        ({**BALLOT, "seed": 1}, {}, 422),
        ([BALLOT], {}, 422),
        ({**BALLOT, "voter": "v" * 5000}, {}, 413),
        (BALLOT, {"Content-Type": "text/plain"}, 415),
        (BALLOT, {"Content-Type": "application/x-www-form-urlencoded"}, 415),
        (BALLOT, {"Sec-Fetch-Site": "cross-site"}, 403),
    ):
        with subtests.test(ballot=str(ballot)[:60], **headers):
            assert school.vote(ballot, **headers).status_code == status
    assert [(asked.type, asked.sender) for asked in school.engine.commands] == [("vote", "testclient")] * 2


def test_who_asks_too_often_is_told_so_and_the_others_go_on(monkeypatch) -> None:
    spent: list[object] = []
    monkeypatch.setattr(class_door.Bucket, "take", lambda bucket: spent.append(bucket) or len(spent) <= RATE_HZ)
    with built() as school:
        statuses = [school.client.get("/api/class").status_code for _ in range(int(RATE_HZ) + 5)]
        assert statuses.count(429) == 5
        assert len(set(map(id, spent))) == 1
        assert school.main.get("/api/state").status_code == 200
        assert school.client.get("/static/page.css").status_code == 200


def test_websockets_only_look_on(school: Built) -> None:
    steering = (f"/api/stream?page={PAGE}", "/api/stream", f"/viser/ws/{PAGE}", f"{STREAM}&page={PAGE}")
    assert all("only looks on" in school.refusal(path)[1] for path in steering)
    with school.connect(STREAM) as stream:
        stream.send_text('{"type": "kidnap", "id": 1}')
        while (told := orjson.loads(stream.receive().get("text") or '{"type": ""}'))["type"] != "answer":
            pass
        assert told["status"] == 403
    assert school.engine.commands == []


def test_no_click_reaches_the_stage() -> None:
    stage, camera = StubViewer(), said("ViewerCameraMessage")
    with viser_double(stage) as got, built(stage) as school:
        with school.connect(STAGE) as viewer:
            viewer.send_bytes(said("ScenePointerMessage"))
            viewer.send_bytes(camera)
            assert viewer.receive_bytes() == camera
        assert got == [camera]


def test_a_class_takes_no_place_from_the_main_page(school: Built) -> None:
    with contextlib.ExitStack() as open_:
        for _ in range(MOST_WATCHERS):
            open_.enter_context(school.connect(STREAM))
        assert school.refusal(STREAM) == (503, "8 pages look on already; close one")
        with school.main.websocket_connect(f"/api/stream?page={PAGE}", headers=dict(OURS)):
            pass
    with school.connect(STREAM):
        pass


def test_its_pages_are_those_for_a_class_and_have_its_address(school: Built) -> None:
    for path, holds in (("/", 'id="vote-page"'), ("/?vote", 'id="vote-page"'), ("/?watch", 'data-watch="true"')):
        assert holds in school.client.get(path).text
    headers = school.client.get("/").headers
    assert f"ws://{HOST}" in headers["content-security-policy"]
    assert "unsafe" not in headers["content-security-policy"]
    assert (headers["x-content-type-options"], headers["cross-origin-resource-policy"]) == ("nosniff", "same-origin")
    assert "cross-origin-opener-policy" not in headers  # without https browsers only complain of it
    for client in (school.main, school.client):
        assert client.get("/api/class").json() == {"vote": f"{ORIGIN}/", "watch": f"{ORIGIN}/?watch"}
        assert client.get("/api/class.svg").headers["content-type"] == "image/svg+xml"
    assert Classroom("fd00::2", 80).url == "http://[fd00::2]/"
    with built(classroom=None) as alone:
        assert alone.main.get("/api/class").json() == {"vote": None, "watch": None}
        assert "ratslam run --class" in alone.main.get("/api/class.svg").json()["detail"][0]["reason"]
