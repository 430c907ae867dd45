"""Pages that only look on: the server refuses all that is more than a look, by whatever way it comes."""

from __future__ import annotations

import msgspec
import orjson
import pytest

from tests.unit.web.doubles import OURS, StubViewer, house, viser_double
from tests.unit.web.frames import until
from tests.unit.web.test_security import routes
from web.http.commands import MODELS
from web.http.watching import LOOKS, is_look

WATCHER = "watch-" + "w" * 22
WATCHED = f"/api/stream?page={WATCHER}"


@pytest.fixture
def server():
    with house() as made:
        yield made


def test_every_message_that_is_more_than_a_look_is_refused(subtests, server):
    for kind in [*MODELS, "switch", "replay", "click", "present", "anything", None]:
        with subtests.test(kind=kind):
            with server.stream(WATCHED) as socket:
                socket.send_text(orjson.dumps({"type": kind, "id": 1}).decode())
                answer = until(socket, "answer")
            assert (answer["accepted"], answer["status"]) == (False, 403)
            assert answer["detail"][0]["reason"] == "this page only looks on; whoever has the main page steers"
            assert server.engine.commands == []


def test_its_own_view_theme_and_tabs_are_its_own(server):
    looks = [
        {"type": "view", "name": "map"},
        {"type": "follow", "on": True},
        {"type": "theme", "name": "light"},
        {"type": "tabs", "names": ["Truth"]},
        {"type": "camera", "name": "map", "at": {"position": [1, 2, 3], "look_at": [0, 0, 0], "fov_rad": 0.5}},
        {"type": "got"},
    ]
    assert {look["type"] for look in looks} == set(LOOKS)
    with server.stream(WATCHED) as socket:
        for number, look in enumerate(looks):
            socket.send_text(orjson.dumps(look | {"id": number}).decode())
            assert until(socket, "answer", id=number)["accepted"]
    assert server.engine.commands == []


def test_no_request_with_its_id_changes_anything(server):
    changed = 0
    for path, methods in routes(server).items():
        for method in methods - {"GET", "HEAD"}:
            headers = {"Content-Type": "application/json", "X-Page": WATCHER}
            answer = server.client.request(method, path, content=b'{"type": "pause"}', headers=headers)
            assert answer.status_code == 403, (method, path)
            assert "only looks on" in answer.json()["detail"][0]["reason"]
            changed += 1
    assert changed >= 4
    assert server.engine.commands == []


def said(kind: str) -> bytes:
    return msgspec.msgpack.encode({"type": kind, "origin": [0, 0, 1]})


UNHEARD = [
    said("ScenePointerMessage"),
    said("SceneNodeClickMessage"),
    said("SceneNodeDragMessage"),
    said("GuiUpdateMessage"),
    msgspec.msgpack.encode(["ViewerCameraMessage"]),
    msgspec.msgpack.encode({"type": ["ViewerCameraMessage"]}),
    b"\x82\xa4type\xb3ViewerCameraMessage\xa4type\xb3ScenePointerMessage",  # a name twice: the last one counts, as for viser
    b"\xc1",
    b"",
]


def test_viser_hears_where_its_camera_stands_and_no_click_or_drag():
    stage, camera = StubViewer(), said("ViewerCameraMessage")
    with viser_double(stage) as got, house(stage=stage) as server:
        path = f"/viser/ws/{WATCHER}"
        with server.client.websocket_connect(path, subprotocols=["viser-v1.1.1"], headers=dict(OURS)) as socket:
            for message in [*UNHEARD, camera]:
                socket.send_bytes(message)
            assert socket.receive_bytes() == camera
    assert got == [camera]


def test_a_look_is_read_as_viser_reads_it():
    assert is_look(said("ViewerCameraMessage"))
    assert not any(map(is_look, UNHEARD))


def test_the_page_knows_that_it_only_looks_on(server):
    assert '<body data-watch="true">' in server.client.get("/?watch").text
    assert "data-watch" not in server.client.get("/").text


def test_it_is_told_when_the_main_page_is_presented(server):
    with server.stream(WATCHED) as watcher:
        assert until(watcher, "presenting")["on"] is False
        with server.stream() as teacher:
            teacher.send_text('{"type": "present", "on": true, "id": 1}')
            assert until(teacher, "answer")["accepted"]
            assert until(watcher, "presenting")["on"] is True
        assert until(watcher, "presenting")["on"] is False  # whoever presented has gone
