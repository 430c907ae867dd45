"""Commands over HTTP and over the page's websocket, to the whole server with a real engine behind it."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from random import Random
from typing import Any

from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from app.config import Config
from app.engine_thread import EngineThread
from sim2d import load_world
from tests.fuzz.inputs import command, upload
from tests.fuzz.mutators import text_of, tree_spoilt
from tests.unit.web.doubles import ORIGIN, OURS, PAGE, PORT, StubViewers
from web.http import security
from web.http.api import create_app
from web.http.commands import Malformed, read_object

BATCH = 100  # messages of one case
STATUSES = {200, 404, 405, 413, 415, 422, 429, 503}
ROUTES = ("/api/worlds/open", "/api/worlds/new", "/api/worlds/save", "/api/worlds/delete", "/api/worlds/restore")


@cache
def client() -> TestClient:
    """One client for as long as the process lives, without limits of rate, since the content of messages is tested here."""
    os.environ["RATSLAM_WORLDS"] = _own_worlds().name
    security.Bucket.take = lambda _: True  # type: ignore[method-assign]
    engine = EngineThread(load_world("loop"), 1, Config(), speed=4.0)
    engine.start()
    return TestClient(create_app(engine.latest, engine.submit, StubViewers(), PORT), base_url=ORIGIN).__enter__()


@cache
def _own_worlds() -> tempfile.TemporaryDirectory[str]:
    """Removed when the process ends; when it is killed, by who started it."""
    return tempfile.TemporaryDirectory(prefix="ratslam-fuzz-")


def http(rng: Random) -> str:
    """A batch of requests. Each must be answered, and none with a server error."""
    for _ in range(BATCH):
        if rng.random() < 0.8:
            path, body = "/api/commands", command(rng)
        else:
            path = rng.choice(ROUTES)
            wish = (
                upload(rng)
                if path.endswith("open")
                else {"name": "mine", "title": "Mine", "width_m": 5.0, "depth_m": 4.0}
            )
            body = text_of(tree_spoilt(wish, rng)).encode("utf-8", "surrogatepass")
        answer = client().post(path, content=body, headers={"Content-Type": "application/json"})
        _require_answer(answer.status_code, answer.content, body)
    return "taken"


def _require_answer(status: int, content: bytes, body: bytes) -> None:
    if status not in STATUSES or (status != 200 and not json.loads(content)["detail"][0]["reason"]):
        raise AssertionError(f"{status} {content[:500]!r} to {body[:500]!r}")


def stream(rng: Random) -> str:
    """A batch of messages over one socket. Each that has an id or cannot be read must be answered."""
    with client().websocket_connect(f"/api/stream?page={PAGE}", headers=dict(OURS)) as socket:
        waiting, unread = {"last"}, 0
        for k in range(BATCH):
            text = command(rng).decode("utf-8", "replace")
            try:
                document = read_object(text)
                if rng.random() < 0.9:
                    text = json.dumps(document | {"id": f"message {k}"})
                    waiting.add(f"message {k}")
            except Malformed:
                unread += 1
            socket.send_text(text)
        socket.send_text(json.dumps({"type": "nothing", "id": "last"}))
        with contextlib.suppress(WebSocketDisconnect):
            for answer in _answers(socket):
                waiting.discard(str(answer["id"]))
                unread -= answer["id"] is None
                if answer.get("status", 200) not in STATUSES:
                    raise AssertionError(str(answer)[:500])
                if not waiting and unread <= 0:
                    return "taken"
    raise AssertionError(f"the socket closed, and {len(waiting)} messages had no answer")


def _answers(socket: Any) -> Iterator[dict[str, Any]]:
    while True:
        message = socket.receive_json()
        if message["type"] == "answer":
            yield message


MESSAGES: dict[str, Callable[[Random], str]] = {"requests": http, "messages": stream}
