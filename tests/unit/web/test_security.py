"""Who may talk to the server: Host, Origin, JSON, sizes, and the headers that bind a browser."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketDisconnect

from tests.unit.web.doubles import ORIGIN, OURS, PAGE, PORT, House, house
from web.http import asking, brains, security
from web.http.api import STATIC
from web.http.security import Bucket, Guard, Limits, own_hosts

_HOSTS = """
    evil.example:8000 127.0.0.1 127.0.0.1:8001 127.0.0.1:80000 localhost 127.0.0.1.evil.example:8000 LOCALHOST:8000
    [::1] 0.0.0.0:8000 192.168.0.1:8000 127.0.0.1:8000,evil.example 127.1:8000 127.0.0.1:8000@evil.example
"""
_ORIGINS = """
    null http://evil.example https://127.0.0.1:8000 http://127.0.0.1:8001 http://127.0.0.1 file:// HTTP://127.0.0.1:8000
    http://127.0.0.1:8000.evil.example http://evil.example/http://127.0.0.1:8000 http://127.0.0.1:8000/
    http://localhost:8000 http://192.168.0.1:8000
"""
FOREIGN_HOSTS, FOREIGN_ORIGINS = _HOSTS.split(), _ORIGINS.split()
PAUSE = b'{"type": "pause"}'


@pytest.fixture(scope="module")
def server() -> Iterator[House]:
    with house() as made:
        yield made


def routes(server: House) -> dict[str, set[str]]:
    """Every path of the API, with its parameters filled in, and the methods that it takes."""
    paths = server.client.get("/openapi.json").json()["paths"]
    return {
        path.replace("{number}", "0").replace("{name}", "mine"): {*map(str.upper, kinds)}
        for path, kinds in paths.items()
    }


def test_our_own_names_enter_and_any_other_host_is_refused(server: House, subtests: pytest.Subtests) -> None:
    for host in ("127.0.0.1:8000", "localhost:8000", "[::1]:8000"):
        assert server.client.get("/healthz", headers={"Host": host, "Origin": f"http://{host}"}).status_code == 200
    for host in [*FOREIGN_HOSTS, ""]:
        with subtests.test(host=host):
            answer = server.client.get("/healthz", headers={"Host": host})
            assert answer.status_code == 403
            assert "127.0.0.1:8000" in answer.json()["detail"][0]["reason"]
    for twice in (("Host", "127.0.0.1:8000"), ("Origin", ORIGIN)):
        assert server.client.get("/healthz", headers=[twice, twice]).status_code == 400
    assert "127.0.0.1" in own_hosts(80)  # browsers leave that port out
    assert "127.0.0.1" not in own_hosts(81)


def test_who_comes_through_a_tunnel_with_another_port_reads_what_is_possible(server: House) -> None:
    """A browser asks for text/html and shows what it gets as text; a program gets JSON."""
    host = {"Host": "localhost:9000"}
    answer = server.client.get("/", headers=host | {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"})
    assert (answer.status_code, answer.headers["content-type"]) == (403, "text/plain; charset=utf-8")
    assert "`ssh -L 8000:localhost:8000 MACHINE`, and then http://localhost:8000/." in answer.text
    program = server.client.get("/", headers=host | {"Accept": "*/*"})
    assert program.json()["detail"][0]["reason"] == answer.text.strip()


def test_any_other_origin_is_refused(server: House, subtests: pytest.Subtests) -> None:
    for origin, path in product([*FOREIGN_ORIGINS, ""], ["/api/state", "/", "/viser/"]):
        with subtests.test(origin=origin, path=path):
            assert server.client.get(path, headers={"Origin": origin}).status_code == 403


def test_a_websocket_is_refused_before_it_is_accepted(server: House, subtests: pytest.Subtests) -> None:
    for origin, path in product([*FOREIGN_ORIGINS, None], [f"/api/stream?page={PAGE}", f"/viser/ws/{PAGE}"]):
        with subtests.test(origin=origin, path=path):
            headers = {"Host": OURS["Host"]} | ({} if origin is None else {"Origin": origin})
            connecting = server.client.websocket_connect(path, headers=headers)
            with pytest.raises(WebSocketDenialResponse) as refused, connecting:
                pass
            assert refused.value.status_code == 403


def test_a_websocket_without_denial_responses_is_closed() -> None:
    sent: list[Any] = []

    async def send(message: Any) -> None:
        sent.append(message)

    scope: Any = {"type": "websocket", "headers": [(b"host", b"evil.example")], "path": "/"}
    nothing: Any = None
    asyncio.run(Guard(nothing, PORT)(scope, nothing, send))
    assert (sent[0]["type"], sent[0]["code"]) == ("websocket.close", 1008)


def drain(socket: Any) -> None:
    while True:
        socket.receive_text()


def test_what_our_server_does_not_speak_ends_the_stream_quietly(server: House) -> None:
    with server.stream() as socket:
        socket.send_bytes(b"binary is not spoken here")
        with pytest.raises(WebSocketDisconnect):
            drain(socket)


CHANGES: list[tuple[dict[str, Any], int]] = [
    ({}, 200),  # curl may post JSON without an origin
    ({"Content-Type": "application/json; charset=utf-8"}, 200),
    *(({"Origin": origin}, 403) for origin in [*FOREIGN_ORIGINS, ""]),
    *(({"Sec-Fetch-Site": site}, 403) for site in ("cross-site", "same-site", "nonsense")),
    *(({"Content-Type": kind}, 415)
      for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "", "application/jsonp")),
    *(({"Content-Length": length.encode("latin-1")}, status)
      for length, status in (("70000", 413), ("1" * 30, 413), ("-1", 400), ("x", 400), ("²", 400))),
]  # fmt: skip


def test_a_change_is_json_of_a_bounded_length_from_our_own_pages(subtests: pytest.Subtests) -> None:
    with house() as server:
        for headers, status in CHANGES:
            with subtests.test(msg=str(headers)):
                assert server.post(PAUSE, **headers)[0] == status
        parts = (b" " * 10_000 for _ in range(20))  # without a length
        answer = server.client.post("/api/commands", content=parts, headers={"Content-Type": "application/json"})
        assert answer.status_code == 413
        assert server.client.get("/api/commands").status_code == 405
        assert len(server.engine.commands) == 2


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Host": "evil.example"}, 403),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
        ({"Content-Type": "text/plain"}, 415),
        ({"Content-Type": "multipart/form-data; boundary=b"}, 415),
        ({"Content-Length": "9" * 12}, 413),
    ],
)
def test_no_way_to_change_something_is_open_to_others(server: House, headers: dict[str, str], status: int) -> None:
    before, tried = len(server.engine.commands), 0
    for path, methods in routes(server).items():
        for method in methods - {"GET", "HEAD"}:
            kind = "application/octet-stream" if path == "/api/brain" else "application/json"
            answer = server.client.request(method, path, content=b"{}", headers={"Content-Type": kind} | headers)
            assert answer.status_code == status, (method, path)
            tried += 1
    assert tried >= 4
    assert len(server.engine.commands) == before


@pytest.mark.slow
def test_whatever_is_only_looked_at_changes_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.01)
    monkeypatch.setattr(brains, "COPY_TIMEOUT_S", 0.01)
    others = ["/", "/docs", "/viser/", "/openapi.json", "/healthz?type=kidnap", "/api/state?type=reset"]
    with house() as server:
        server.engine.answer = None
        looked = [path for path, methods in routes(server).items() if "GET" in methods]
        for path, method in product([*looked, *others], ("GET", "HEAD")):
            server.client.request(method, path, headers={"Content-Type": "application/json"})
        assert len(looked) >= 4
        asked = {type(command).__name__ for command in server.engine.commands}
        assert asked <= {"ReadBrain", "ReadExperience", "ReadWorld"}
    assert not list(tmp_path.iterdir())


def test_every_answer_binds_the_browser(server: House, subtests: pytest.Subtests) -> None:
    for path in ("/", "/docs", "/static/main.js", "/api/state", "/nothing"):
        with subtests.test(path=path):
            headers = server.client.get(path).headers
            policy = headers["content-security-policy"]
            assert "default-src 'none'" in policy
            assert "frame-ancestors 'self'" in policy
            assert "unsafe" not in policy
            assert (headers["x-content-type-options"], headers["referrer-policy"]) == ("nosniff", "no-referrer")
            assert "access-control-allow-origin" not in headers


def test_the_page_never_makes_markup_of_text() -> None:
    wrong = re.compile(
        r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|srcdoc|javascript:"
    )
    files = [file for file in STATIC.rglob("*.*") if "vendor" not in file.parts]
    assert [file.name for file in files if wrong.search(file.read_text())] == []


def test_drive_60_a_second_and_others_10_and_nothing_is_saved_up(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(security, "time", SimpleNamespace(monotonic=lambda: now[0]))
    limits, bucket = Limits(), Bucket(10)

    def passed() -> list[int]:
        return [sum(limits.refusal(kind) is None for _ in range(100)) for kind in ("drive", "pause")]

    assert passed() == [60, 10]
    assert "60 drive" in str(limits.refusal("drive"))
    assert "10 commands" in str(limits.refusal("pause"))
    now[0] = 0.5
    assert passed() == [30, 5]
    now[0] = 100.0
    assert sum(bucket.take() for _ in range(50)) == 10
    with house() as crowded:
        assert [crowded.post(PAUSE)[0] for _ in range(14)] == 10 * [200] + 4 * [429]
