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
from tests.unit.web.doubles import PAGE, PORT, StubEngine, StubViewer, StubViewers, viser_double
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
# What a class may do. A route that is new stays closed to it until somebody writes it here and in the door.
OPEN = {
    ("GET", "/"),
    ("GET", "/favicon.ico"),
    ("GET", "/static"),
    ("GET", "/viser/"),
    ("GET", "/api/state"),
    ("GET", "/api/world"),
    ("GET", "/api/lessons"),
    ("GET", "/api/lessons/{name}"),
    ("GET", "/api/class"),
    ("GET", "/api/class.svg"),
    ("GET", "/api/stage.svg"),
    ("POST", "/api/vote"),
    ("websocket", "/api/stream"),
    ("websocket", "/viser/ws/{page}"),
}
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE")


@dataclass
class Built:
    engine: StubEngine
    stage: StubViewer
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
def built(stage: StubViewer | None = None) -> Iterator[Built]:
    engine, stage, latest = StubEngine(), stage or StubViewer(), Latest()
    latest.put(fake_snapshot(12))
    guard = create_app(latest, engine.submit, StubViewers(stage), PORT, classroom=CLASSROOM)
    routes = guard.app.routes  # type: ignore[attr-defined]
    door = TestClient(ClassDoor(guard.app, CLASSROOM), base_url=ORIGIN, raise_server_exceptions=False)
    with TestClient(guard, base_url=MAIN_ORIGIN) as main:
        door.portal = main.portal  # one loop, as behind two listeners
        yield Built(engine, stage, routes, main, door)


@pytest.fixture
def school(monkeypatch):
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
    path = {"/static": "/static/page.css", "/viser/ws/{page}": f"/viser/ws/{WATCHER}"}.get(path, path)
    return re.sub(r"{\w+(:\w+)?}", "1", path)


def test_of_all_routes_only_those_of_the_table_are_open(school):
    ways = set(every_way(school.routes))
    assert ways >= OPEN
    assert len(ways) > 150
    for method, path in sorted(ways):
        if method == "websocket":
            if (method, path) not in OPEN:
                assert school.refusal(filled(path))[0] == 403, path
            continue
        sent = {"Origin": ORIGIN, "Content-Type": "application/json"}
        answer = school.client.request(method, filled(path), headers=sent, content=b"{}" if method == "POST" else None)
        refused = answer.status_code == 403
        assert refused != ((method, path) in OPEN), (method, path, answer.status_code)
        if refused and method != "HEAD":
            assert "for the main page alone" in answer.json()["detail"][0]["reason"]
    assert {type(asked).__name__ for asked in school.engine.commands} <= {"ReadWorld"}


@pytest.mark.parametrize(
    "path",
    ["/docs", "/openapi.json", "/healthz", "/api/commands", "/api/brain", "/api/state/", "//api/state", "/api/lessons/a/b",
     "/static/", "/API/STATE", "/api/state;x", "/nothing", "/api/experience/1", "/api/export", "/api/situation"],
)  # fmt: skip
def test_what_is_not_listed_is_refused(school, path):
    for method in ("GET", "POST"):
        assert school.client.request(method, path, headers={"Origin": ORIGIN}).status_code == 403


def test_no_path_climbs_out_of_what_is_served(school):
    for path in ("/static/../api/brain", "/static/%2e%2e/%2e%2e/pyproject.toml", "/api/lessons/..%2fbrain"):
        assert school.client.get(path).status_code in (403, 404)


@pytest.mark.parametrize(
    "host",
    ["192.168.1.5", "192.168.1.5:8000", "127.0.0.1:8001", "127.0.0.1:8000", "localhost:8001", "evil.example:8001", "",
     "192.168.1.5:8001.evil.example", "192.168.1.5:8001@evil.example", "192.168.1.6:8001", "0300.168.1.5:8001"],
)  # fmt: skip
def test_any_other_host_is_refused(school, host):
    assert school.client.get("/api/state", headers={"Host": host}).status_code == 403
    assert school.vote(Host=host).status_code == 403
    assert school.refusal(f"/api/stream?page={WATCHER}", Host=host)[0] == 403
    assert school.engine.commands == []


@pytest.mark.parametrize(
    "origin",
    ["null", "http://evil.example", "https://192.168.1.5:8001", "http://192.168.1.5", "http://192.168.1.5:8000",
     MAIN_ORIGIN, "http://localhost:8001", "http://192.168.1.5:8001.evil.example", ""],
)  # fmt: skip
def test_any_other_origin_is_refused(school, origin):
    assert school.client.get("/api/state", headers={"Origin": origin}).status_code == 403
    assert school.vote(Origin=origin).status_code == 403
    assert school.refusal(f"/viser/ws/{WATCHER}", Origin=origin)[0] == 403
    assert school.engine.commands == []


def test_a_vote_says_where_it_comes_from(school):
    answer = school.client.post("/api/vote", content=orjson.dumps(BALLOT), headers={"Content-Type": "application/json"})
    assert answer.status_code == 403
    assert ORIGIN in answer.json()["detail"][0]["reason"]


def test_a_vote_counts_at_both_doors(school):
    assert school.vote().json() == {"accepted": True, "tick": 5}
    headers = {"Origin": MAIN_ORIGIN, "Content-Type": "application/json"}
    assert school.main.post("/api/vote", content=orjson.dumps(BALLOT), headers=headers).status_code == 200
    assert school.engine.commands == [Vote(type="vote", sender="testclient", **BALLOT)] * 2


@pytest.mark.parametrize(
    ("ballot", "headers", "status"),
    [
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
    ],
)
def test_nothing_but_a_vote_is_taken(school, ballot, headers, status):
    assert school.vote(ballot, **headers).status_code == status
    assert {(asked.type, asked.sender) for asked in school.engine.commands} <= {("vote", "testclient")}


def test_who_asks_too_often_is_told_so_and_the_others_go_on(monkeypatch):
    monkeypatch.setattr(class_door.Bucket, "take", lambda bucket: spent.append(bucket) or len(spent) <= RATE_HZ)
    spent: list[object] = []
    with built() as school:
        statuses = [school.client.get("/api/class").status_code for _ in range(int(RATE_HZ) + 5)]
        assert statuses.count(429) == 5
        assert len(set(map(id, spent))) == 1
        assert school.main.get("/api/state").status_code == 200
        assert school.client.get("/static/page.css").status_code == 200


def test_websockets_only_look_on(school):
    assert "only looks on" in school.refusal(f"/api/stream?page={PAGE}")[1]
    assert "only looks on" in school.refusal("/api/stream")[1]
    assert "only looks on" in school.refusal(f"/viser/ws/{PAGE}")[1]
    assert "only looks on" in school.refusal(f"/api/stream?page={WATCHER}&page={PAGE}")[1]
    with school.connect(f"/api/stream?page={WATCHER}") as stream:
        stream.send_text('{"type": "kidnap", "id": 1}')
        while (told := orjson.loads(stream.receive().get("text") or '{"type": ""}'))["type"] != "answer":
            pass
        assert told["status"] == 403
    assert school.engine.commands == []


def test_no_click_reaches_the_stage():
    stage, camera = StubViewer(), said("ViewerCameraMessage")
    with viser_double(stage) as got, built(stage) as school:
        with school.connect(f"/viser/ws/{WATCHER}") as viewer:
            viewer.send_bytes(said("ScenePointerMessage"))
            viewer.send_bytes(camera)
            assert viewer.receive_bytes() == camera
        assert got == [camera]


def test_a_class_takes_no_place_from_the_main_page(school):
    with contextlib.ExitStack() as open_:
        for _ in range(MOST_WATCHERS):
            open_.enter_context(school.connect(f"/api/stream?page={WATCHER}"))
        assert school.refusal(f"/api/stream?page={WATCHER}") == (503, "8 pages look on already; close one")
        headers = {"Host": f"127.0.0.1:{PORT}", "Origin": MAIN_ORIGIN}
        with school.main.websocket_connect(f"/api/stream?page={PAGE}", headers=headers):
            pass
    with school.connect(f"/api/stream?page={WATCHER}"):
        pass


def test_its_pages_are_those_for_a_class(school):
    assert 'id="vote-page"' in school.client.get("/").text
    assert 'id="vote-page"' in school.client.get("/?vote").text
    assert 'data-watch="true"' in school.client.get("/?watch").text
    headers = school.client.get("/").headers
    assert f"ws://{HOST}" in headers["content-security-policy"]
    assert "unsafe" not in headers["content-security-policy"]
    assert (headers["x-content-type-options"], headers["cross-origin-resource-policy"]) == ("nosniff", "same-origin")
    assert "cross-origin-opener-policy" not in headers  # without https browsers only complain of it


def test_the_address_and_its_code(school):
    for client in (school.main, school.client):
        assert client.get("/api/class").json() == {"vote": f"{ORIGIN}/", "watch": f"{ORIGIN}/?watch"}
        assert client.get("/api/class.svg").headers["content-type"] == "image/svg+xml"
    assert Classroom("fd00::2", 80).url == "http://[fd00::2]/"


def test_without_a_class_there_is_no_address():
    guard = create_app(Latest(), StubEngine().submit, StubViewers(), PORT)
    with TestClient(guard, base_url=MAIN_ORIGIN) as client:
        assert client.get("/api/class").json() == {"vote": None, "watch": None}
        assert "ratslam run --class" in client.get("/api/class.svg").json()["detail"][0]["reason"]
