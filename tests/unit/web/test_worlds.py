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
from tests.unit.web.house_of_worlds import OFFICE, Engine, files, house_of_worlds, plan_png, post, why
from web.http.security import Limits

pytestmark = pytest.mark.slow

OPEN = "/api/worlds/open"
CHANGES = [OPEN, *(f"/api/worlds/{what}" for what in ("new", "save", "delete", "restore"))]
SEGMENTS = b"[[0, 0, 5, 0], [5, 0, 5, 5], [5, 5, 0, 5], [0, 5, 0, 0]]"
WORLD = world_to_json(OFFICE).encode()
PICTURE = files(p__png=plan_png())
JSON = {"Content-Type": "application/json"}


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    with house_of_worlds(tmp_path, monkeypatch) as made:
        yield made


@pytest.fixture
def engine(server: House) -> Engine:
    assert isinstance(server.engine.answer, Engine)
    return server.engine.answer


def test_the_world_is_read_with_its_edition_and_is_a_file_to_keep(server: House, engine: Engine) -> None:
    answer = server.client.get("/api/world").json()
    edition = {key: answer[key] for key in ("edition", "undo", "redo", "saved")}
    assert edition == {"edition": 7, "undo": "wall drawn", "redo": "", "saved": False}
    assert world_from_json(json.dumps(answer["world"]), "f") == OFFICE
    assert "office" in answer["ours"]
    engine.world = replace(OFFICE, name='a"b/ü')
    kept = server.client.get("/api/world/file")
    assert kept.headers["content-disposition"] == 'attachment; filename="a-b--.json"'
    assert kept.text == world_to_json(engine.world)


def test_a_picture_becomes_a_world_unless_the_engine_refuses_it(server: House, engine: Engine) -> None:
    picture = {"files": files(plan__png=plan_png()), "scale_m": 0.1}
    status, answer = post(server, OPEN, picture)
    assert (status, answer["name"], answer["size_m"]) == (200, "plan", [8.0, 6.0])
    (opened,) = engine.got
    assert (len(opened.world.walls), len(opened.world.starts)) == (answer["walls"], answer["starts"])
    engine.refuses = True
    status, answer = post(server, OPEN, picture)
    assert (status, why(answer)) == (422, "the robot cannot start there")


def test_a_map_server_pair_becomes_a_world(server: House) -> None:
    yaml = b"image: p.png\nresolution: 0.05\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    far = yaml.replace(b"p.png", b"/home/somebody/maps/p.png") + b"floor: 3\n"
    for text, told in ((yaml, []), (far, ["line", "image:"])):
        status, answer = post(server, OPEN, {"files": [*PICTURE, *files(m__yaml=text)]})
        assert (status, answer["size_m"]) == (200, [4.0, 3.0])
        assert [words.partition(":")[2].split()[0] for words in answer["said"]] == told  # what the page tells
    status, answer = post(server, OPEN, {"files": files(m__yaml=yaml)})
    assert (status, "image: 'p.png' was not given with it; put both together" in why(answer)) == (422, True)


def test_worlds_and_vector_maps_are_opened_whatever_path_their_name_has(server: House) -> None:
    for name, text, walls, size_m in (
        ("office.json", WORLD, len(OFFICE.walls), [10.0, 8.0]),
        ("../a/w.json", SEGMENTS, 8, [5.6, 5.6]),  # with four around them
    ):
        status, answer = post(server, OPEN, {"files": [{**files(x=text)[0], "name": name}]})
        assert (status, answer["walls"], answer["size_m"]) == (200, walls, size_m)
        assert answer["name"] == Path(name).stem


@pytest.mark.parametrize(("text", "most"), [(SEGMENTS, 1_000_000), (WORLD, 10_000_000)])
def test_a_world_may_be_larger_than_any_other_json(server: House, engine: Engine, text: bytes, most: int) -> None:
    """Both sides of both limits, in bytes; the surplus consists of spaces."""
    assert post(server, OPEN, {"files": files(p__json=text.ljust(most))})[0] == 200
    status, answer = post(server, OPEN, {"files": files(p__json=text.ljust(most + 1))})
    assert status == 422
    assert f"p.json: {most + 1} bytes; at most {most}" in why(answer)
    assert len(engine.got) == 1


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"files": PICTURE}, "p.png: a plain picture needs its scale, metres a pixel"),
    ({"files": PICTURE, "scale_m": -1}, "p.png: got a scale of -1; must be from 0.001 to 1"),
    ({"files": PICTURE, "scale_m": "x"}, "scale_m: input should be a valid number"),
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
]


def test_what_cannot_be_opened_says_why_and_never_reaches_the_engine(
    server: House, engine: Engine, subtests: pytest.Subtests, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patient:
        patient.setattr(Limits, "refusal", lambda _self, _kind: None)
        for body, reason in WRONG:
            with subtests.test(msg=reason):
                status, answer = post(server, OPEN, body)
                assert status == 422
                assert reason in why(answer)
    monkeypatch.setattr(Limits, "refusal", lambda _self, _kind: "wait a moment")
    bodies = ({"files": files(x__json=b"[]")}, {"name": "hall", "width_m": 9, "depth_m": 9}, *[{"name": "mine"}] * 3)
    for path, body in zip(CHANGES, bodies, strict=True):
        status, answer = post(server, path, body)
        assert (status, why(answer)) == (429, "wait a moment")
    assert engine.got == []


def test_uploads_may_be_larger_than_commands_but_not_endless(server: House) -> None:
    body, huge = b'{"files": "' + b"x" * 100_000 + b'"}', b"x" * (24 * 1024 * 1024 + 1)
    parts = (huge[:10_000_000] for _ in range(3))
    for path, content, status in (
        (OPEN, body, 422),
        ("/api/worlds/save", body, 413),
        ("/api/commands", body, 413),
        (OPEN, huge, 413),
        (OPEN, parts, 413),
    ):
        assert server.client.post(path, content=content, headers=JSON).status_code == status
    for path in CHANGES:
        assert server.client.get(path).status_code == 405
