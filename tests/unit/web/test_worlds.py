"""The world as a file: read, downloaded, saved, opened from dropped files. Errors name file, value and what is right."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from sim2d import World, load_world, own_worlds, world_from_json, world_to_json
from sim2d.world.world_check import check_world
from tests.unit.web.doubles import House, house
from web.http.security import Limits
from web.messages import (
    Accepted,
    OfficeEdition,
    OpenWorld,
    ReadFiled,
    ReadWorld,
    Refused,
    WorldDeleted,
    WorldRestored,
    WorldSaved,
)

OFFICE = load_world("office")
EDITION = OfficeEdition(7, "wall drawn", "", False)


class Engine:
    """Answers as the engine would, from one world."""

    def __init__(self) -> None:
        self.world: World = OFFICE
        self.filed: dict[str, World] = {}
        self.got: list[Any] = []
        self.refuses = False

    def __call__(self, request: Any) -> Accepted | Refused:
        self.got.append(request)
        if self.refuses and not isinstance(request, ReadWorld):
            return Refused("world", "plan", "the robot cannot start there")
        match request:
            case ReadWorld():
                return Accepted(5, (self.world, EDITION))
            case ReadFiled(name):
                return Accepted(5, self.filed.get(name))
            case OpenWorld(world, _):
                return Accepted(5, world.name)
            case WorldSaved(_, world):
                self.world = self.filed[world.name] = world
        return Accepted(5)


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path / "worlds"))
    with house() as made:
        made.engine.answer = Engine()
        yield made


def post(server: House, path: str, body: Any) -> tuple[int, Any]:
    answer = server.client.post(path, content=json.dumps(body), headers={"Content-Type": "application/json"})
    return answer.status_code, answer.json()


def files(**given: bytes) -> list[dict[str, str]]:
    return [{"name": name.replace("__", "."), "data": base64.b64encode(data).decode()} for name, data in given.items()]


def plan_png() -> bytes:
    """A room of 80 x 60 pixels with a wall in it."""
    picture = np.zeros((70, 90), np.uint8)
    picture[5:65, 5:85] = 255
    picture[5:40, 44:47] = 0
    return cv2.imencode(".png", picture)[1].tobytes()


def why(answer: Any) -> str:
    return answer["detail"][0]["reason"]


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


def test_a_saved_world_is_there_and_the_one_before_is_kept(server: House) -> None:
    status, answer = post(server, "/api/worlds/save", {"name": "mine", "title": "Mine"})
    assert (status, answer["name"]) == (200, "mine")
    path = Path(answer["file"])
    assert load_world("mine") == replace(OFFICE, name="mine", title="Mine")
    assert server.engine.answer.world.name == "mine"  # type: ignore[union-attr]
    first = path.read_text("utf-8")
    server.engine.answer.world = replace(OFFICE, name="mine", title="Mine", about="other")  # type: ignore[union-attr]
    assert post(server, "/api/worlds/save", {"name": "mine"})[0] == 200
    assert load_world("mine").about == "other"
    assert path.with_name("mine.json.before").read_text("utf-8") == first
    assert sorted(p.name for p in path.parent.iterdir()) == ["mine.json", "mine.json.before"]
    assert own_worlds.names() == (("mine", "Mine"),)


def test_two_dashboards_do_not_overwrite_each_other_unasked(server: House) -> None:
    with house() as other:
        other.engine.answer = Engine()
        assert post(server, "/api/worlds/save", {"name": "mine", "title": "Mine"})[0] == 200
        other.engine.answer.world = other.engine.answer.filed["mine"] = load_world("mine")
        assert post(server, "/api/worlds/save", {"name": "mine"})[0] == 200  # nobody else has been there
        server.engine.answer.world = replace(load_world("mine"), about="theirs")  # type: ignore[union-attr]
        assert post(server, "/api/worlds/save", {"name": "mine"})[0] == 200
        for name, reason in {"mine": "somebody else has saved 'mine' since it was read here; replace what is there or",
                             "office": "office comes with the program"}.items():  # fmt: skip
            status, answer = post(other, "/api/worlds/save", {"name": name})
            assert (status, reason in why(answer)) == (422, True)
            assert load_world("mine").about == "theirs"
        assert post(other, "/api/worlds/save", {"name": "mine"})[1]["detail"][0]["field"] == "replace"
        assert post(other, "/api/worlds/save", {"name": "mine", "replace": True})[0] == 200
        assert load_world("mine").about == OFFICE.about
        assert post(other, "/api/worlds/save", {"name": "mine"})[0] == 200
        assert post(server, "/api/worlds/save", {"name": "mine"})[0] == 422


def test_a_file_written_by_hand_counts_by_what_it_says(server: House) -> None:
    own_worlds.save("mine", json.dumps(json.loads(world_to_json(replace(OFFICE, name="mine"))), indent=7))
    engine = server.engine.answer
    engine.world = engine.filed["mine"] = load_world("mine")  # type: ignore[union-attr]
    assert post(server, "/api/worlds/save", {"name": "mine"})[0] == 200
    (own_worlds.folder() / "mine.json").write_text("{")
    assert post(server, "/api/worlds/save", {"name": "mine"})[0] == 422


@pytest.mark.parametrize("name", ["../evil", "a/b", "..", ".x", "a b", "x" * 41, "c:x", "ü"])
def test_a_name_is_no_path(server: House, name: str) -> None:
    status, answer = post(server, "/api/worlds/save", {"name": name})
    assert status == 422
    assert "a name has 1 to 40 letters" in why(answer)
    assert not own_worlds.folder().exists()


def test_worlds_that_are_there_are_not_lost(server: House) -> None:
    status, answer = post(server, "/api/worlds/save", {"name": "office"})
    assert (status, "comes with the program" in why(answer)) == (422, True)
    own_worlds.save("mine", world_to_json(replace(OFFICE, name="mine")))
    status, answer = post(server, "/api/worlds/save", {"name": "mine"})
    assert status == 422
    assert "there is a world 'mine' already; replace it or choose another name" in why(answer)
    assert post(server, "/api/worlds/save", {"name": "mine", "replace": True})[0] == 200


def test_an_empty_world_is_begun(server: House) -> None:
    body = {"name": "hall", "title": "Hall", "width_m": 12.5, "depth_m": 6}
    status, answer = post(server, "/api/worlds/new", body)
    assert (status, answer) == (200, {"name": "hall", "title": "Hall", "walls": 4, "starts": 1, "size_m": [12.5, 6.0]})
    (opened,) = server.engine.answer.got  # type: ignore[union-attr]
    assert opened.filed is False
    world = opened.world
    check_world(world, 0.2)
    assert world_from_json(world_to_json(world), "f") == world
    assert all(wall.outer and len(wall.panels) > 3 for wall in world.walls)
    assert [(k.x, k.y) for k in (*world.starts, *world.lamps)] == [(3.125, 3.0), (6.25, 3.0)]
    assert not own_worlds.folder().exists()
    assert post(server, "/api/worlds/new", {"name": "other", "width_m": 12.5, "depth_m": 6})[1]["title"] == "other"
    other = server.engine.answer.got[-1].world  # type: ignore[union-attr]
    assert other.walls != world.walls  # looks of its own


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"name": "office"}, "office comes with the program and stays as it is; choose another name"),
        ({"name": "mine"}, "there is a world 'mine' already; choose another name"),
        ({"name": "../evil"}, "a name has 1 to 40 letters"),
        ({"width_m": 1.9}, "width: got 1.9 m; must be from 2 to 200 m"),
        ({"depth_m": 201}, "depth: got 201 m; must be from 2 to 200 m"),
        ({"depth_m": "x"}, "depth_m: input should be a valid number"),
        ({"title": ""}, "title: string should have at least 1 character"),
    ],
)
def test_an_empty_world_that_cannot_be_says_why(server: House, change: Any, reason: str) -> None:
    own_worlds.save("mine", world_to_json(replace(OFFICE, name="mine")))
    status, answer = post(server, "/api/worlds/new", {"name": "hall", "width_m": 9, "depth_m": 9, **change})
    assert (status, reason in why(answer)) == (422, True)
    assert server.engine.answer.got == []  # type: ignore[union-attr]


def test_a_deleted_world_can_be_brought_back(server: House) -> None:
    path = own_worlds.save("mine", world_to_json(replace(OFFICE, name="mine", title="Mine")))
    text = path.read_text("utf-8")
    assert server.client.get("/api/worlds").json()["yours"] == {"mine": "Mine"}
    status, answer = post(server, "/api/worlds/delete", {"name": "mine"})
    assert (status, answer["file"]) == (200, f"{path}.deleted")
    assert server.client.get("/api/worlds").json()["yours"] == {}
    assert not path.exists()
    status, answer = post(server, "/api/worlds/delete", {"name": "mine"})
    assert (status, why(answer)) == (422, "no saved world 'mine'; expected one of: none, since nothing has been saved")
    assert post(server, "/api/worlds/restore", {"name": "mine"}) == (200, {"name": "mine", "title": "Mine"})
    assert path.read_text("utf-8") == text
    assert server.engine.answer.got == [WorldDeleted("mine"), WorldRestored("mine", "Mine")]  # type: ignore[union-attr]
    status, answer = post(server, "/api/worlds/restore", {"name": "mine"})
    assert (status, why(answer)) == (422, "no world 'mine' has been deleted")
    post(server, "/api/worlds/delete", {"name": "mine"})
    own_worlds.save("mine", world_to_json(replace(OFFICE, name="mine", title="Second")))
    status, answer = post(server, "/api/worlds/restore", {"name": "mine"})
    assert (status, "there is another world 'mine' by now" in why(answer)) == (422, True)
    assert own_worlds.names() == (("mine", "Second"),)


@pytest.mark.parametrize("name", ["office", "../outside", "outside", "..", "mine.json", "x" * 41, "sub/mine"])
def test_only_ones_own_worlds_are_deleted(server: House, name: str) -> None:
    own_worlds.save("mine", world_to_json(replace(OFFICE, name="mine")))
    folder = own_worlds.folder()
    (folder / "sub").mkdir()
    for other in (folder.parent / "outside.json", folder / "sub" / "mine.json"):
        other.write_text("{}")
    there = sorted(folder.parent.rglob("*"))
    for what in ("delete", "restore"):
        assert post(server, f"/api/worlds/{what}", {"name": name})[0] == 422
    assert sorted(folder.parent.rglob("*")) == there
    assert load_world("office") == OFFICE
    assert all(isinstance(request, ReadWorld) for request in server.engine.answer.got)  # type: ignore[union-attr]


def test_saving_under_another_name_can_rename(server: House) -> None:
    post(server, "/api/worlds/save", {"name": "mine"})
    assert post(server, "/api/worlds/save", {"name": "yours", "rename": True})[0] == 200
    assert own_worlds.names() == (("yours", "yours"),)
    assert server.engine.answer.got[-1] == WorldDeleted("mine")  # type: ignore[union-attr]
    status, answer = post(server, "/api/worlds/save", {"name": "yours", "rename": True})
    assert (status, why(answer)) == (422, "'yours' is no other world that you have saved; leave rename away")
    server.engine.answer.world = OFFICE  # type: ignore[union-attr]
    assert post(server, "/api/worlds/save", {"name": "third", "rename": True})[0] == 422
    assert own_worlds.names() == (("yours", "yours"),)


def test_a_folder_that_cannot_be_written_is_told(
    server: House, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path / "file" / "worlds"))
    status, answer = post(server, "/api/worlds/save", {"name": "mine"})
    assert status == 422
    assert "cannot be written" in why(answer)
    assert server.engine.answer.world is OFFICE  # type: ignore[union-attr]


def test_a_spoilt_file_is_listed_as_such(server: House) -> None:
    own_worlds.save("bad", "[]")
    own_worlds.save("worse", "{")
    assert own_worlds.names() == (("bad", "bad (cannot be read)"), ("worse", "worse (cannot be read)"))
    assert server.client.get("/api/world").json()["yours"] == dict(own_worlds.names())


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
