"""Pages that only look on: the server refuses all that is more than a look, by whatever way it comes."""

from __future__ import annotations

from typing import Any

import msgspec
import orjson
import pytest

from tests.unit.web.doubles import OURS, House, StubViewer, house, viser_double
from tests.unit.web.frames import until
from tests.unit.web.test_security import routes
from web.http.commands import MODELS
from web.http.security import LOOKS
from web.viewer.viser_server import is_look

WATCHER = "watch-" + "w" * 22
WATCHED = f"/api/stream?page={WATCHER}"
NO = "this page only looks on; whoever has the main page steers"


def ask(socket: Any, **message: object) -> dict[str, Any]:
    socket.send_text(orjson.dumps(message | {"id": 1}).decode())
    return until(socket, "answer")


def test_every_message_that_is_more_than_a_look_is_refused(served: House, subtests: pytest.Subtests) -> None:
    for kind in [*MODELS, "switch", "replay", "click", "present", "anything", None]:
        with subtests.test(kind=kind), served.stream(WATCHED) as socket:
            answer = ask(socket, type=kind)
            assert (answer["status"], answer["detail"][0]["reason"]) == (403, NO)
    assert served.engine.commands == []


def test_its_own_view_theme_and_tabs_are_its_own(served: House) -> None:
    looks: list[dict[str, Any]] = [
        {"type": "view", "name": "map"},
        {"type": "follow", "on": True},
        {"type": "theme", "name": "light"},
        {"type": "tabs", "names": ["Truth"]},
        {"type": "camera", "name": "map", "at": {"position": [1, 2, 3], "look_at": [0, 0, 0], "fov_rad": 0.5}},
        {"type": "got"},
    ]
    assert {look["type"] for look in looks} == set(LOOKS)
    with served.stream(WATCHED) as socket:
        assert [ask(socket, **look)["accepted"] for look in looks] == [True] * len(looks)
    assert served.engine.commands == []


def test_no_request_with_its_id_changes_anything(served: House) -> None:
    headers = {"Content-Type": "application/json", "X-Page": WATCHER}
    changes = [(path, kind) for path, kinds in routes(served).items() for kind in kinds - {"GET", "HEAD"}]
    for path, method in changes:
        answer = served.client.request(method, path, content=b'{"type": "pause"}', headers=headers)
        assert (answer.status_code, answer.json()["detail"][0]["reason"]) == (403, NO), (method, path)
    assert len(changes) >= 4
    assert served.engine.commands == []


def said(kind: str) -> bytes:
    return msgspec.msgpack.encode({"type": kind, "origin": [0, 0, 1]})


UNHEARD = [
    *map(said, ("ScenePointerMessage", "SceneNodeClickMessage", "SceneNodeDragMessage", "GuiUpdateMessage")),
    msgspec.msgpack.encode(["ViewerCameraMessage"]),
    msgspec.msgpack.encode({"type": ["ViewerCameraMessage"]}),
    b"\x82\xa4type\xb3ViewerCameraMessage\xa4type\xb3ScenePointerMessage",  # a name twice: the last one counts, as for viser
    b"\xc1",
    b"",
]


def test_viser_hears_where_its_camera_stands_and_no_click_or_drag() -> None:
    assert not any(map(is_look, UNHEARD))
    stage, camera = StubViewer(), said("ViewerCameraMessage")
    talk: dict[str, Any] = {"subprotocols": ["viser-v1.1.1"], "headers": dict(OURS)}
    with (
        viser_double(stage) as got,
        house(stage=stage) as server,
        server.client.websocket_connect(f"/viser/ws/{WATCHER}", **talk) as socket,
    ):
        for message in [*UNHEARD, camera]:
            socket.send_bytes(message)
        assert socket.receive_bytes() == camera
    assert got == [camera]


def test_the_page_knows_that_it_only_looks_on_and_is_told_when_the_main_page_is_presented(served: House) -> None:
    assert '<body data-watch="true">' in served.client.get("/?watch").text
    assert "data-watch" not in served.client.get("/").text
    with served.stream(WATCHED) as watcher:
        assert until(watcher, "presenting")["on"] is False
        with served.stream() as teacher:
            assert ask(teacher, type="present", on=True)["accepted"]
            assert until(watcher, "presenting")["on"] is True
        assert until(watcher, "presenting")["on"] is False  # whoever presented has gone
