"""The world as a file: read, downloaded and opened from dropped files. Errors name file, value and what is right."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim2d import world_from_json, world_to_json
from tests.unit.web.doubles import House
from tests.unit.web.house_of_worlds import OFFICE, files, house_of_worlds, plan_png, post, why
from web.http.security import Limits

pytestmark = pytest.mark.slow


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    with house_of_worlds(tmp_path, monkeypatch) as made:
        yield made


def test_the_world_is_read_with_its_edition(server: House) -> None:
    answer = server.client.get("/api/world").json()
    assert {key: answer[key] for key in ("edition", "undo", "redo", "saved")} == {
        "edition": 7, "undo": "wall drawn", "redo": "", "saved": False,
    }  # fmt: skip
    assert world_from_json(json.dumps(answer["world"]), "f") == OFFICE
    assert "office" in answer["ours"]


def test_the_world_is_a_file_to_keep(server: House) -> None:
    server.engine.answer.world = replace(OFFICE, name='a"b/ü')  # type: ignore[union-attr]
    answer = server.client.get("/api/world/file")
    assert answer.headers["content-disposition"] == 'attachment; filename="a-b--.json"'
    assert answer.text == world_to_json(replace(OFFICE, name='a"b/ü'))


def test_a_picture_becomes_a_world(server: House) -> None:
    status, answer = post(server, "/api/worlds/open", {"files": files(plan__png=plan_png()), "scale_m": 0.1})
    assert status == 200
    assert (answer["name"], answer["size_m"]) == ("plan", [8.0, 6.0])
    (opened,) = server.engine.answer.got  # type: ignore[union-attr]
    assert (len(opened.world.walls), len(opened.world.starts)) == (answer["walls"], answer["starts"])


def test_a_map_server_pair_becomes_a_world(server: House) -> None:
    yaml = b"image: p.png\nresolution: 0.05\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    pair = files(p__png=plan_png(), m__yaml=yaml)
    status, answer = post(server, "/api/worlds/open", {"files": pair})
    assert (status, answer["size_m"]) == (200, [4.0, 3.0])
    far = files(p__png=plan_png(), m__yaml=yaml.replace(b"p.png", b"/home/somebody/maps/p.png") + b"floor: 3\n")
    status, answer = post(server, "/api/worlds/open", {"files": far})
    assert (status, answer["size_m"]) == (200, [4.0, 3.0])
    assert [words.partition(":")[2].split()[0] for words in answer["said"]] == ["line", "image:"]  # what the page tells
    status, answer = post(server, "/api/worlds/open", {"files": pair[1:]})
    assert (status, "image: 'p.png' was not given with it; put both together" in why(answer)) == (422, True)


def test_worlds_and_vector_maps_are_opened(server: House) -> None:
    status, answer = post(server, "/api/worlds/open", {"files": files(office__json=world_to_json(OFFICE).encode())})
    assert (status, answer["walls"], answer["size_m"]) == (200, len(OFFICE.walls), [10.0, 8.0])
    segments = json.dumps([[0, 0, 5, 0], [5, 0, 5, 5], [5, 5, 0, 5], [0, 5, 0, 0]]).encode()
    status, answer = post(server, "/api/worlds/open", {"files": files(v__json=segments)})
    assert (status, answer["size_m"]) == (200, [5.6, 5.6])


@pytest.mark.parametrize("most", [1_000_000, 10_000_000])
def test_a_world_may_be_larger_than_any_other_json(server: House, most: int) -> None:
    """Both sides of both limits, in bytes; the surplus consists of spaces."""
    is_world = most > 1_000_000
    text = world_to_json(OFFICE).encode() if is_world else b"[[0, 0, 5, 0], [5, 0, 5, 5], [5, 5, 0, 5], [0, 5, 0, 0]]"
    for size, expected in ((most, 200), (most + 1, 422)):
        status, answer = post(server, "/api/worlds/open", {"files": files(p__json=text + b" " * (size - len(text)))})
        assert status == expected
        if status == 422:
            assert f"p.json: {size} bytes; at most {most}" in why(answer)
    assert len(server.engine.answer.got) == 1  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ({"files": files(p__png=plan_png())}, "p.png: a plain picture needs its scale, metres a pixel"),
        ({"files": files(p__png=plan_png()), "scale_m": -1}, "p.png: got a scale of -1; must be from 0.001 to 1"),
        ({"files": files(p__png=b"no picture"), "scale_m": 0.1}, "p.png: not a picture that can be read"),
        ({"files": files(p__json=b'{"format": 1,\n"name": }')}, "p.json: not JSON: line 2, column 9"),
        ({"files": files(p__txt=b"x")}, "p.txt: cannot be imported; expected .json"),
        ({"files": files(p__json=b" " * 1_000_001)}, "p.json: 1000001 bytes; at most 1000000"),
        ({"files": files(p__json=b"{" * 9_000_000)}, "p.json: not JSON: line 1, column 2"),
        ({"files": files(p__json=b'{"a":' * 1_500_000)}, "p.json: not a world: nested too deeply"),
        ({"files": files(a__png=b"1", b__png=b"2")}, "got 2 files, a.png, b.png; drop one plan at a time"),
        ({"files": [{"name": "p.png", "data": "?"}]}, "p.png: data must be base64"),
        ({"files": []}, "files: list should have at least 1 item"),
        ({"file": 1}, "files: field required; it takes files, scale_m, seed"),
        ({"files": files(p__png=plan_png()), "scale_m": "x"}, "scale_m: input should be a valid number"),
    ],
)
def test_what_cannot_be_opened_says_why_and_never_reaches_the_engine(server: House, body: Any, reason: str) -> None:
    status, answer = post(server, "/api/worlds/open", body)
    assert status == 422
    assert reason in why(answer)
    assert server.engine.answer.got == []  # type: ignore[union-attr]


def test_a_world_that_the_engine_refuses_is_told(server: House) -> None:
    server.engine.answer.refuses = True  # type: ignore[union-attr]
    status, answer = post(server, "/api/worlds/open", {"files": files(plan__png=plan_png()), "scale_m": 0.1})
    assert (status, why(answer)) == (422, "the robot cannot start there")


def test_names_of_files_are_no_paths(server: House) -> None:
    segments = b"[[0, 0, 5, 0], [5, 0, 5, 5], [5, 5, 0, 5], [0, 5, 0, 0]]"
    status, answer = post(server, "/api/worlds/open", {"files": [{**files(x=segments)[0], "name": "../a/w.json"}]})
    assert (status, answer["name"]) == (200, "w")


def test_uploads_may_be_larger_than_commands_but_not_endless(server: House) -> None:
    body = b'{"files": "' + b"x" * 100_000 + b'"}'
    kind = {"Content-Type": "application/json"}
    assert server.client.post("/api/worlds/open", content=body, headers=kind).status_code == 422
    assert server.client.post("/api/worlds/save", content=body, headers=kind).status_code == 413
    assert server.client.post("/api/commands", content=body, headers=kind).status_code == 413
    huge = b"x" * (24 * 1024 * 1024 + 1)
    assert server.client.post("/api/worlds/open", content=huge, headers=kind).status_code == 413

    def parts() -> Iterator[bytes]:
        yield from (huge[:10_000_000] for _ in range(3))

    assert server.client.post("/api/worlds/open", content=parts(), headers=kind).status_code == 413


CHANGES = [f"/api/worlds/{what}" for what in ("open", "new", "save", "delete", "restore")]


def test_only_json_from_our_own_pages(server: House) -> None:
    for path in CHANGES:
        assert server.client.get(path).status_code == 405
        cross_site = {"Content-Type": "application/json", "Sec-Fetch-Site": "cross-site"}
        assert server.client.post(path, content=b"{}", headers=cross_site).status_code == 403
        assert server.client.post(path, content=b"{}", headers={"Content-Type": "text/plain"}).status_code == 415
        foreign = {"Content-Type": "application/json", "Origin": "http://evil.example"}
        assert server.client.post(path, content=b"{}", headers=foreign).status_code == 403


def test_too_many_wishes_are_429(server: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Limits, "refusal", lambda _self, _kind: "wait a moment")
    bodies = ({"files": files(x__json=b"[]")}, {"name": "hall", "width_m": 9, "depth_m": 9}, *[{"name": "mine"}] * 3)
    for path, body in zip(CHANGES, bodies, strict=True):
        status, answer = post(server, path, body)
        assert (status, why(answer)) == (429, "wait a moment")
    assert server.engine.answer.got == []  # type: ignore[union-attr]
