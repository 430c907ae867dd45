"""A person's own worlds: saved, begun empty, renamed, deleted and brought back, and none lost unasked."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim2d import load_world, own_worlds, world_from_json, world_to_json
from sim2d.world.world_check import check_world
from tests.unit.web.doubles import House, house
from tests.unit.web.house_of_worlds import OFFICE, Engine, house_of_worlds, post, why
from web.messages import ReadWorld, WorldDeleted, WorldRestored

pytestmark = pytest.mark.slow


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    with house_of_worlds(tmp_path, monkeypatch) as made:
        yield made


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
    assert status == 200
    assert answer == {"name": "hall", "title": "Hall", "walls": 4, "starts": 1, "size_m": [12.5, 6.0], "said": []}
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
