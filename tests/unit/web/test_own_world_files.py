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
from web.http.security import Limits
from web.messages import ReadWorld, WorldDeleted, WorldRestored

pytestmark = pytest.mark.slow


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    monkeypatch.setattr(Limits, "refusal", lambda *_: None)
    with house_of_worlds(tmp_path, monkeypatch) as made:
        yield made


@pytest.fixture
def office(server: House) -> Engine:
    """The engine behind the server, which answers from the world `office`."""
    assert isinstance(server.engine.answer, Engine)
    return server.engine.answer


def saves(server: House, name: str, **more: Any) -> bool:
    return post(server, "/api/worlds/save", {"name": name, **more})[0] == 200


def refusal(server: House, what: str, name: str, **more: Any) -> str:
    status, answer = post(server, f"/api/worlds/{what}", {"name": name, **more})
    assert status == 422
    return why(answer)


def filed(name: str = "mine", **changes: str) -> Path:
    """An own world that is there already."""
    return own_worlds.save(name, world_to_json(replace(OFFICE, name=name, **changes)))


def test_a_saved_world_is_there_and_the_one_before_is_kept(server: House, office: Engine) -> None:
    status, answer = post(server, "/api/worlds/save", {"name": "mine", "title": "Mine"})
    assert (status, answer["name"], office.world.name) == (200, "mine", "mine")
    assert load_world("mine") == replace(OFFICE, name="mine", title="Mine")
    path = Path(answer["file"])
    first = path.read_text("utf-8")
    office.world = replace(OFFICE, name="mine", title="Mine", about="other")
    assert saves(server, "mine")
    assert load_world("mine").about == "other"
    assert path.with_name("mine.json.before").read_text("utf-8") == first
    assert sorted(p.name for p in path.parent.iterdir()) == ["mine.json", "mine.json.before"]
    assert own_worlds.names() == (("mine", "Mine"),)


def test_two_dashboards_do_not_overwrite_each_other_unasked(server: House, office: Engine) -> None:
    with house() as other:
        other.engine.answer = theirs = Engine()
        assert saves(server, "mine", title="Mine")
        theirs.world = theirs.filed["mine"] = load_world("mine")
        assert saves(server, "mine")  # nobody else has been there
        office.world = replace(load_world("mine"), about="theirs")
        assert saves(server, "mine")
        status, answer = post(other, "/api/worlds/save", {"name": "mine"})
        assert (status, answer["detail"][0]["field"]) == (422, "replace")
        assert "somebody else has saved 'mine' since it was read here; replace what is there or" in why(answer)
        assert load_world("mine").about == "theirs"
        assert saves(other, "mine", replace=True)
        assert load_world("mine").about == OFFICE.about
        assert (saves(other, "mine"), saves(server, "mine")) == (True, False)


def test_a_file_written_by_hand_counts_by_what_it_says(server: House, office: Engine) -> None:
    own_worlds.save("mine", json.dumps(json.loads(world_to_json(replace(OFFICE, name="mine"))), indent=7))
    office.world = office.filed["mine"] = load_world("mine")
    assert saves(server, "mine")
    (own_worlds.folder() / "mine.json").write_text("{")
    assert not saves(server, "mine")


def test_a_name_is_no_path_and_worlds_that_are_there_are_not_lost(server: House) -> None:
    for name in ("../evil", "a/b", "..", ".x", "a b", "x" * 41, "c:x", "ü"):
        assert "a name has 1 to 40 letters" in refusal(server, "save", name)
    assert not own_worlds.folder().exists()
    assert "comes with the program" in refusal(server, "save", "office")
    filed()
    words = "there is a world 'mine' already; replace it or choose another name"
    assert words in refusal(server, "save", "mine")
    assert saves(server, "mine", replace=True)


def test_an_empty_world_is_begun(server: House, office: Engine) -> None:
    size = {"width_m": 12.5, "depth_m": 6}
    assert post(server, "/api/worlds/new", {"name": "hall", "title": "Hall", **size}) == (
        200,
        {"name": "hall", "title": "Hall", "walls": 4, "starts": 1, "size_m": [12.5, 6.0], "said": []},
    )
    assert post(server, "/api/worlds/new", {"name": "other", **size})[1]["title"] == "other"
    assert not own_worlds.folder().exists()
    assert [opened.filed for opened in office.got] == [False, False]
    world, other = (opened.world for opened in office.got)
    check_world(world, 0.2)
    assert world_from_json(world_to_json(world), "f") == world
    assert all(wall.outer and len(wall.panels) > 3 for wall in world.walls)
    assert [(k.x, k.y) for k in (*world.starts, *world.lamps)] == [(3.125, 3.0), (6.25, 3.0)]
    assert other.walls != world.walls  # looks of its own


def test_an_empty_world_that_cannot_be_says_why(server: House, office: Engine, subtests) -> None:
    filed()
    for change, reason in (
        ({"name": "office"}, "office comes with the program and stays as it is; choose another name"),
        ({"name": "mine"}, "there is a world 'mine' already; choose another name"),
        ({"name": "../evil"}, "a name has 1 to 40 letters"),
        ({"width_m": 1.9}, "width: got 1.9 m; must be from 2 to 200 m"),
        ({"depth_m": 201}, "depth: got 201 m; must be from 2 to 200 m"),
        ({"depth_m": "x"}, "depth_m: input should be a valid number"),
        ({"title": ""}, "title: string should have at least 1 character"),
    ):
        with subtests.test(**change):
            assert reason in refusal(server, "new", **{"name": "hall", "width_m": 9, "depth_m": 9, **change})
    assert office.got == []


def test_a_deleted_world_can_be_brought_back(server: House, office: Engine) -> None:
    path = filed(title="Mine")
    text = path.read_text("utf-8")
    assert server.client.get("/api/worlds").json()["yours"] == {"mine": "Mine"}
    status, answer = post(server, "/api/worlds/delete", {"name": "mine"})
    assert (status, answer["file"], path.exists()) == (200, f"{path}.deleted", False)
    assert server.client.get("/api/worlds").json()["yours"] == {}
    nothing = "no saved world 'mine'; expected one of: none, since nothing has been saved"
    assert refusal(server, "delete", "mine") == nothing
    assert post(server, "/api/worlds/restore", {"name": "mine"}) == (200, {"name": "mine", "title": "Mine"})
    assert path.read_text("utf-8") == text
    assert office.got == [WorldDeleted("mine"), WorldRestored("mine", "Mine")]
    assert refusal(server, "restore", "mine") == "no world 'mine' has been deleted"
    post(server, "/api/worlds/delete", {"name": "mine"})
    filed(title="Second")
    assert "there is another world 'mine' by now" in refusal(server, "restore", "mine")
    assert own_worlds.names() == (("mine", "Second"),)


def test_only_ones_own_worlds_are_deleted(server: House, office: Engine) -> None:
    filed()
    folder = own_worlds.folder()
    (folder / "sub").mkdir()
    for other in (folder.parent / "outside.json", folder / "sub" / "mine.json"):
        other.write_text("{}")
    there = sorted(folder.parent.rglob("*"))
    for name in ("office", "../outside", "outside", "..", "mine.json", "x" * 41, "sub/mine"):
        for what in ("delete", "restore"):
            assert refusal(server, what, name)
        assert sorted(folder.parent.rglob("*")) == there, name
    assert load_world("office") == OFFICE
    assert all(isinstance(request, ReadWorld) for request in office.got)


def test_saving_under_another_name_can_rename(server: House, office: Engine) -> None:
    assert saves(server, "mine")
    assert saves(server, "yours", rename=True)
    assert own_worlds.names() == (("yours", "yours"),)
    assert office.got[-1] == WorldDeleted("mine")
    words = "'yours' is no other world that you have saved; leave rename away"
    assert refusal(server, "save", "yours", rename=True) == words
    office.world = OFFICE
    assert not saves(server, "third", rename=True)
    assert own_worlds.names() == (("yours", "yours"),)


def test_a_folder_that_cannot_be_written_is_told(
    server: House, office: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path / "file" / "worlds"))
    assert "cannot be written" in refusal(server, "save", "mine")
    assert office.world is OFFICE


def test_a_spoilt_file_is_listed_as_such(server: House) -> None:
    own_worlds.save("bad", "[]")
    own_worlds.save("worse", "{")
    assert own_worlds.names() == (("bad", "bad (cannot be read)"), ("worse", "worse (cannot be read)"))
    assert server.client.get("/api/world").json()["yours"] == dict(own_worlds.names())
