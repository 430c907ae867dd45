"""Who may talk to the server: Host, Origin, JSON, sizes, and the headers that bind a browser."""

from __future__ import annotations

import re
from itertools import product

import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketDisconnect

from tests.unit.web.doubles import ORIGIN, OURS, PAGE, PORT, house
from web.http import asking, brain_download, security
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


@pytest.fixture(scope="module")
def server():
    with house() as made:
        yield made


@pytest.mark.parametrize("host", ["127.0.0.1:8000", "localhost:8000", "[::1]:8000"])
def test_our_own_names_enter(server, host):
    assert server.client.get("/healthz", headers={"Host": host, "Origin": f"http://{host}"}).status_code == 200


@pytest.mark.parametrize("host", [*FOREIGN_HOSTS, ""])
def test_any_other_host_is_refused(server, host):
    answer = server.client.get("/healthz", headers={"Host": host})
    assert answer.status_code == 403
    assert "127.0.0.1:8000" in answer.json()["detail"][0]["reason"]


def test_who_comes_through_a_tunnel_with_another_port_reads_what_is_possible(server):
    """A browser asks for text/html and shows what it gets as text; a program gets JSON."""
    host = {"Host": "localhost:9000"}
    answer = server.client.get("/", headers=host | {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"})
    assert (answer.status_code, answer.headers["content-type"]) == (403, "text/plain; charset=utf-8")
    assert "`ssh -L 8000:localhost:8000 MACHINE`, and then http://localhost:8000/." in answer.text
    program = server.client.get("/", headers=host | {"Accept": "*/*"})
    assert program.json()["detail"][0]["reason"] == answer.text.strip()


def test_any_other_origin_is_refused(subtests, server):
    for origin, path in product([*FOREIGN_ORIGINS, ""], ["/api/state", "/", "/viser/"]):
        with subtests.test(origin=origin, path=path):
            assert server.client.get(path, headers={"Origin": origin}).status_code == 403


@pytest.mark.parametrize("origin", [*FOREIGN_ORIGINS, ""])
def test_a_foreign_origin_changes_nothing(server, origin):
    before = len(server.engine.commands)
    status, _ = server.post(b'{"type": "pause"}', Origin=origin)
    assert status == 403
    assert len(server.engine.commands) == before


def test_a_websocket_is_refused_before_it_is_accepted(subtests, server):
    for origin, path in product([*FOREIGN_ORIGINS, None], [f"/api/stream?page={PAGE}", f"/viser/ws/{PAGE}"]):
        with subtests.test(origin=origin, path=path):
            headers = {"Host": OURS["Host"]} | ({} if origin is None else {"Origin": origin})
            with (
                pytest.raises(WebSocketDenialResponse) as refused,
                server.client.websocket_connect(path, headers=headers),
            ):
                pass
            assert refused.value.status_code == 403


def test_a_websocket_without_denial_responses_is_closed():
    import asyncio

    sent = []

    async def run():
        async def send(message):
            sent.append(message)

        headers = [(b"host", b"evil.example")]
        await Guard(None, PORT)({"type": "websocket", "headers": headers, "path": "/"}, None, send)

    asyncio.run(run())
    assert sent[0]["type"] == "websocket.close"
    assert sent[0]["code"] == 1008


@pytest.mark.parametrize(
    "headers", [[("Host", "127.0.0.1:8000"), ("Host", "127.0.0.1:8000")], [("Origin", ORIGIN), ("Origin", ORIGIN)]]
)
def test_repeated_headers_are_malformed(server, headers):
    assert server.client.get("/healthz", headers=headers).status_code == 400


def test_curl_may_post_json_without_an_origin(server):
    assert server.post(b'{"type": "pause"}')[0] == 200


@pytest.mark.parametrize("site", ["cross-site", "same-site", "nonsense"])
def test_a_cross_site_change_is_refused(server, site):
    assert server.post(b'{"type": "pause"}', **{"Sec-Fetch-Site": site})[0] == 403


@pytest.mark.parametrize(
    "kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "", "application/jsonp"]
)
def test_only_json_changes_something(server, kind):
    assert server.post(b'{"type": "pause"}', **{"Content-Type": kind})[0] == 415


def test_charset_is_allowed(server):
    assert server.post(b'{"type": "pause"}', **{"Content-Type": "application/json; charset=utf-8"})[0] == 200


@pytest.mark.parametrize(("length", "status"), [("70000", 413), ("1" * 30, 413), ("-1", 400), ("x", 400), ("²", 400)])
def test_content_length_is_bounded_and_a_number(server, length, status):
    assert server.post(b"{}", **{"Content-Length": length.encode("latin-1")})[0] == status


def test_a_body_without_length_is_bounded_too(server):
    parts = (b" " * 10_000 for _ in range(20))
    answer = server.client.post("/api/commands", content=parts, headers={"Content-Type": "application/json"})
    assert answer.status_code == 413


@pytest.mark.parametrize("path", ["/", "/docs", "/static/main.js", "/api/state", "/nothing"])
def test_every_answer_binds_the_browser(server, path):
    headers = server.client.get(path).headers
    assert "default-src 'none'" in headers["content-security-policy"]
    assert "frame-ancestors 'self'" in headers["content-security-policy"]
    assert "unsafe" not in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert "access-control-allow-origin" not in headers


def test_get_cannot_command(server):
    before = len(server.engine.commands)
    assert server.client.get("/api/commands").status_code == 405
    assert len(server.engine.commands) == before


def routes(server) -> dict[str, set[str]]:
    """Every path of the API, with its parameters filled in, and the methods that it takes."""
    paths = server.client.get("/openapi.json").json()["paths"]
    return {
        path.replace("{number}", "0").replace("{name}", "mine"): {*map(str.upper, kinds)}
        for path, kinds in paths.items()
    }


@pytest.mark.slow
def test_whatever_is_only_looked_at_changes_nothing(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.01)
    monkeypatch.setattr(brain_download, "COPY_TIMEOUT_S", 0.01)
    with house() as server:
        server.engine.answer = None
        looked = [path for path, methods in routes(server).items() if "GET" in methods]
        for path in [
            *looked,
            "/",
            "/docs",
            "/viser/",
            "/openapi.json",
            "/healthz?type=kidnap",
            "/api/state?type=reset",
        ]:
            for method in ("GET", "HEAD"):
                server.client.request(method, path, headers={"Content-Type": "application/json"})
        assert len(looked) >= 4
        assert {type(asked).__name__ for asked in server.engine.commands} <= {
            "ReadBrain",
            "ReadExperience",
            "ReadWorld",
        }
    assert not list(tmp_path.iterdir())


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
def test_no_way_to_change_something_is_open_to_others(server, headers, status):
    before = len(server.engine.commands)
    changed = 0
    for path, methods in routes(server).items():
        for method in methods - {"GET", "HEAD"}:
            kind = "application/octet-stream" if path == "/api/brain" else "application/json"
            answer = server.client.request(method, path, content=b"{}", headers={"Content-Type": kind} | headers)
            assert answer.status_code == status, (method, path)
            changed += 1
    assert changed >= 4
    assert len(server.engine.commands) == before


def test_the_page_never_makes_markup_of_text():
    wrong = re.compile(
        r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|srcdoc|javascript:"
    )
    for file in STATIC.rglob("*.*"):
        if "vendor" in file.parts:
            continue
        assert not wrong.search(file.read_text()), file.name


def test_on_port_80_browsers_leave_the_port_out():
    assert "127.0.0.1" in own_hosts(80)
    assert "127.0.0.1" not in own_hosts(81)


def test_drive_60_a_second_and_others_10(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(security.time, "monotonic", lambda: now[0])
    limits = Limits()
    assert sum(limits.refusal("drive") is None for _ in range(100)) == 60
    assert sum(limits.refusal("pause") is None for _ in range(100)) == 10
    assert "60 drive" in str(limits.refusal("drive"))
    assert "10 commands" in str(limits.refusal("pause"))
    now[0] = 0.5
    assert sum(limits.refusal("drive") is None for _ in range(100)) == 30
    assert sum(limits.refusal("pause") is None for _ in range(100)) == 5


def test_a_bucket_does_not_save_up(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(security.time, "monotonic", lambda: now[0])
    bucket = Bucket(10)
    now[0] = 100.0
    assert sum(bucket.take() for _ in range(50)) == 10


def test_too_many_commands_get_429():
    with house() as crowded:
        statuses = [crowded.post(b'{"type": "pause"}')[0] for _ in range(14)]
        assert statuses.count(200) < 14
        assert statuses[-1] == 429


def test_lifespan_passes_the_guard_and_disconnects_are_quiet(server):
    with server.stream() as socket:
        socket.send_bytes(b"binary is not spoken here")
        with pytest.raises(WebSocketDisconnect):
            drain(socket)


def drain(socket):
    while True:
        socket.receive_text()
