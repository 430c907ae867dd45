"""World files: those that come with the program, what is written and read, what is refused, and where one's own are kept."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim2d import DEFAULT_WORLD, FreeSpace, World, WorldError, load_world, own_worlds, world_from_json, world_names
from sim2d.world.json_lines import deeper_than, line_of
from sim2d.world.world import Box, Daylight, Event, Lamp
from sim2d.world.world_file import SCHEMA, WORLDS, schema_text
from sim2d.world.world_schema import world_to_json
from sim2d.worlds.make import MADE
from tests.unit.disk.full import full_after

from .rooms import living_file

DOCS = Path(__file__).parents[3] / "docs"
NAMES = [name for name, _ in world_names()]

# ------------------------------------------------------------ those that come with the program


def test_default_comes_first_and_all_are_titled() -> None:
    assert NAMES[0] == DEFAULT_WORLD == load_world().name
    assert {"office", "loop", "floor"} <= set(NAMES)
    assert all(title for _, title in world_names())


@pytest.mark.slow
def test_shipped_worlds(subtests: pytest.Subtests) -> None:
    page = (DOCS / "worlds.md").read_text("utf-8")
    for name in NAMES:
        with subtests.test(name):
            world = load_world(name)
            assert world.name == name
            assert load_world(str(WORLDS / f"{name}.json")) == world
            assert world_from_json(world_to_json(world), "again.json") == world
            free, home = FreeSpace(world, 0.22), world.starts[0]
            assert all(free.shortest_m((home.x, home.y), (p.x, p.y)) < 60 for p in world.places)
            walls = [w for w in world.walls if w.kind == "wall"]
            assert sum(len(w.panels) for w in walls) / sum(w.length for w in walls) >= 0.6  # findings: fewer look alike
            seeds = [p.seed for w in world.walls for p in w.panels]
            assert len(set(seeds)) == len(seeds) or name == "twins"
            assert world.about.endswith(".")
            assert f"![{world.title}](pictures/worlds/{name}.png)" in page
            assert (DOCS / "pictures" / "worlds" / f"{name}.png").is_file()


@pytest.mark.parametrize("make", MADE)
def test_a_made_world_is_what_its_maker_makes(make: Callable[[], World]) -> None:
    world = make()
    assert (WORLDS / f"{world.name}.json").read_text("utf-8") == world_to_json(world)


def test_twin_corridors_look_alike() -> None:
    """Each wall and picture of the lower corridor appears again, 4.8 m further up."""
    pair = [w for w in load_world("twins").walls if w.y1 == w.y2 and 0.0 < w.y1 < 8.6 and w.panels and w.kind == "wall"]
    looks = {(w.x1, w.x2, w.y1, w.y2, w.panels) for w in pair}
    lower = {look for look in looks if look[2] < 4}
    assert len(lower) == 2
    assert {(x1, x2, y1 + 4.8, y2 + 4.8, panels) for x1, x2, y1, y2, panels in lower} == looks - lower


def test_sizes_are_the_papers() -> None:
    def inner(world: World) -> np.ndarray:
        return np.ptp([(w.x1, w.y1) for w in world.walls if not w.outer], axis=0)

    ring, loop, office, goals = (load_world(name) for name in ("corridors", "loop", "office", "two-goals"))
    assert float((np.ptp(ring.outline, axis=0) + inner(ring)).sum()) == pytest.approx(70.0)  # round the middle line
    assert np.ptp(loop.outline, axis=0) + inner(loop) == pytest.approx([9.0, 9.0])  # twice the centre line's side
    assert load_world("campus").bounds == (0, 0, 45, 13)
    assert load_world("floor").bounds == (0, 0, 43, 13)
    assert np.prod(load_world("open-plan").bounds[2:]) == 80
    assert office.bounds == (0.0, 0.0, 10.0, 8.0)
    assert len({(at.x > 5, at.y > 4) for at in (office.starts[0], *office.places)}) == 4
    assert sum(w.kind == "screen" for w in office.walls) >= 4
    home, one, two = ((p.x, p.y) for p in (goals.starts[0], *sorted(goals.places, key=lambda place: place.name)[:2]))
    free = FreeSpace(goals, 0.22)
    assert free.shortest_m(home, one) == pytest.approx(16.5, abs=0.6)
    assert free.shortest_m(one, two) == pytest.approx(21.0, abs=1.0)


def test_schema_is_published() -> None:
    assert SCHEMA.read_text("utf-8") == schema_text()
    assert "schema" not in NAMES


# ------------------------------------------------------------ what is read


def read(data: object) -> World:
    return world_from_json(json.dumps(data, indent=1), "small.json")


def test_a_file_with_one_of_everything_is_read_and_written_the_same() -> None:
    data = living_file()
    pane = {"from": [1, 3], "to": [1.5, 3], "kind": "glass", "height": 2, "colour": "#AABBCC", "name": "pane"}
    data["walls"].append(pane)
    world = read(data)
    assert (world.name, world.title, world.floor_colour) == ("small", "Small", (96, 96, 96))
    assert world.starts[0].heading_rad == pytest.approx(math.pi / 2)
    assert (world.walls[4].panels[0].colour, world.walls[4].length) == ((230, 159, 0), 1.0)
    door = world.doors[0]
    assert (door.angle_rad, door.open, door.slides, door.open_s) == (pytest.approx(math.pi / 2), True, False, 5.0)
    assert world.lamps == (Lamp("ceiling", 2.0, 3.0, 4.0, 0.5),)
    assert world.daylight == Daylight((0, 60), (0.4, 1.0), 120.0)
    assert (world.people[0].path, world.slow_zones[0].factor) == (((0.5, 3.5), (3.5, 3.0)), 0.5)
    assert world.script == (Event(3, "close_door", "lab"), Event(4, "people_off"))
    assert world_from_json(world_to_json(world), "again.json") == world


def test_daylight_runs_straight_and_repeats_and_boxes_turn() -> None:
    day = Daylight((0.0, 60.0), (0.4, 1.0), 120.0)
    assert [day.at(t) for t in (0, 30, 60, 100, 150)] == pytest.approx([0.4, 0.7, 1.0, 1.0, 0.7])
    assert Daylight((10.0,), (0.5,)).at(0.0) == 0.5
    corners = Box("b", 1.0, 2.0, 0.4, 0.2, angle_rad=math.pi / 2).corners
    assert corners == pytest.approx(np.array([[1.1, 1.8], [1.1, 2.2], [0.9, 2.2], [0.9, 1.8]]))


GONE, FILE = object(), living_file()
WALLS, OUTER = FILE["walls"], FILE["walls"][:4]
A_WALL = {"height": 2.6, "colour": "#C0C0C0"}


def scaled(factor: float) -> list[Any]:
    return [{**w, **{end: [factor * v for v in w[end]] for end in ("from", "to")}} for w in OUTER] + WALLS[4:]


# What is set where (a path of keys), and what is then said.
BAD: tuple[tuple[dict[str, Any], str], ...] = (
    ({"walls.2.to": [0, 3.5]},
     r"walls\[2\]: the outline is open: it ends at \(0, 3.5\) but walls\[3\] begins at \(0, 4\); each"),
    ({"walls.3.to": [0, 0.5]}, r"walls\[3\]: the outline is open: it ends at \(0, 0.5\) but walls\[0\] begins"),
    ({"walls": [{**w, "from": w["to"], "to": w["from"]} for w in OUTER[::-1]] + WALLS[4:]},
     r"walls\[0\]: the outline encloses -16 m\^2; it must run counter-clockwise"),
    ({f"walls.{k}.outer": GONE for k in range(4)}, r"walls: 0 are outer; at least 3 must close the outline"),
    ({"walls": [WALLS[4], *OUTER]}, r"walls\[4\]: is outer but comes after inner ones"),
    ({"walls.1.bottom": 1.0}, r"walls\[1\]: bottom 1 must be 0 in the outer"),
    ({"walls.4.to": [3, 1], "walls.4.panels": []},
     r"walls\[4\]: no length: runs from \(3, 1\) to \(3, 1\); its ends must be at least 0.01 m apart"),
    ({"walls.1.from.0": math.nan}, r"walls\[1\].from\[0\]: got nan; .*finite"),
    ({"starts.0.x": math.inf}, r"starts\[0\].x: got inf; .*finite"),
    ({"walls.3.colr": 1}, r"walls\[3\].colr: got 1; unknown key; take it out or"),
    ({"lifts": []}, r"lifts: got \[\]; unknown key"),
    ({"walls.0.height": GONE}, r"walls\[0\].height: field required"),
    ({"walls.0.colour": "red"}, r"walls\[0\].colour: got 'red'; string should match"),
    ({"walls.4.panels.0.texture": "noise"}, r"walls\[4\].panels\[0\].texture: got 'noise'; input should be .*'poster'"),
    ({"format": 2}, r"format: got 2; input should be 1"),
    ({"walls.0.height": -1}, r"walls\[0\].height: got -1; .*greater than 0"),
    ({"walls.4.bottom": 1.4}, r"walls\[4\]: bottom 1.4 must be below its height 1.4"),
    ({"walls.4.bottom": 0.3}, r"walls\[4\]: bottom 0.3 must be 0 or at least 0.6 m, above"),
    ({"walls.4.panels.0.at": 0.7}, r"walls\[4\].panels\[0\]: reaches to 1.2 m; the wall is 1 m long"),
    ({"walls.4.panels.0.top": 1.5},
     r"walls\[4\].panels\[0\]: from 0.3 up to 1.5 m; must be upright and between the wall's 0 and 1.4 m"),
    ({"starts.0.x": 2.9, "starts.0.y": 1.5},
     r"starts\[0\] \(home\): \(2.9, 1.5\) is 0.100 m from walls\[4\] \(partition\); the robot needs 0.22 m"),
    ({"starts.0.x": -2.0}, r"starts\[0\] \(home\): \(-2, 1\) is outside of small, which spans 0 to 4 by 0 to 4 m"),
    ({"places.0.y": 9}, r"places\[0\] \(corner\): \(3.5, 9\) is outside of small"),
    ({"walls": [*WALLS, {"from": [2, 0], "to": [2, 4], **A_WALL}]},
     r"places\[0\] \(corner\): \(3.5, 3.5\) is closed in: no way leads .* home"),
    ({"walls": scaled(1000)}, r"walls: the outline spans 4000 by 4000 m; at most 3000 m each way"),
    ({"walls": scaled(400)}, r"walls: 2560000 m\^2 of floor in all; at most 2e\+06"),
    ({"walls": [*WALLS, {"from": [-9000, 9], "to": [9000, 9], **A_WALL, "height": 12}]},
     r"walls: 216043 m\^2 of wall in all; at most 200000"),
    ({"walls": WALLS * 2001}, r"walls: list should have at most 10000 items"),
    ({"starts": []}, r"starts: got \[\]; list should have at least 1 item"),
    ({"doors": FILE["doors"] * 2}, r"doors\[1\].name: 'lab' is taken by doors\[0\]; use another"),
    ({"people": FILE["people"] * 2}, r"people\[1\].name: 'Ada' is taken by people\[0\]"),
    ({"people": FILE["people"] * 51}, r"people: list should have at most 50 items.*not 51"),
    ({"doors.0.hinge": [5, 1]}, r"doors\[0\].hinge: the hinge \(5, 1\) is outside of"),
    ({"doors.0.open_s": 30}, r"doors\[0\].open_s: 30 s must be at most .* 20 s"),
    ({"lamps.0.x": -1}, r"lamps\[0\]: 'ceiling' \(-1, 3\) is outside of small, which"),
    ({"people.0.path": [[0.5, 3.5], [3.5, 3.0], [9, 9]]}, r"people\[0\].path\[2\]: a point of 'Ada' \(9, 9\) is outside"),
    ({"people.0.wait_s": [1, 2, 3]}, r"people\[0\].wait_s: has 3 times; must be one time, or one for each of the 2 points"),
    ({"script.0.name": "lap"}, r"script\[0\].name: no doors named 'lap'; expected one of: lab"),
    ({"lamps": GONE, "script": [*FILE["script"], {"at_s": 1, "do": "lamp_off", "name": "x"}]},
     r"script\[2\].name: no lamps named 'x'; expected one of: none, since the world has no lamps"),
    ({"script.0.do": "slam"}, r"script\[0\].do: got 'slam'; input should be 'open"),
    ({"daylight.points": [[5, 1], [5, 1]]}, r"daylight.points\[1\]: is at 5 s; times must grow"),
    ({"daylight.points": [[0, 4]]}, r"daylight.points\[0\]: has level 4; must be from"),
    ({"daylight.repeat_s": 30}, r"daylight.repeat_s: 30 s must be 0 or at least .* 60 s"),
    ({"slow_zones.0.factor": 0}, r"slow_zones\[0\].factor: got 0; .* equal to 0.05"),
    ({"boxes.0.width": 0}, r"boxes\[0\].width: got 0; input should be greater"),
    ({"boxes.0.x": 1.3, "boxes.0.y": 1.0, "boxes.0.present": True},
     r"starts\[0\] \(home\): .* is 0.060 m from box 'crate'; the robot needs 0.22 m"),
)  # fmt: skip


def spoilt(changes: dict[str, Any]) -> dict[str, Any]:
    data = living_file()
    for path, value in changes.items():
        *way, last = (int(key) if key.isdigit() else key for key in path.split("."))
        holder: Any = reduce(getitem, way, data)
        if value is GONE:
            del holder[last]
        else:
            holder[last] = value
    return data


def test_bad_worlds_say_what_is_wrong_and_where(subtests: pytest.Subtests) -> None:
    for changes, sentence in BAD:
        with subtests.test(sentence), pytest.raises(WorldError, match=rf"^small.json: {sentence}.* \(line \d+\)$"):
            read(spoilt(changes))


def test_a_bad_file_is_named_without_its_folder(tmp_path: Path) -> None:
    path = tmp_path / "small.json"
    for data, sentence in (
        (b"{oops", r"not JSON: line 1, column 2: "),
        (b"[]", r"file: input should be a valid dictionary"),
        (b"\xff\xfe\xff", r"cannot be read"),
        (json.dumps(spoilt({"format": 2})).encode(), r"format: got 2"),
        (b"[" * 100_000, r"not a world: nested too deeply"),
        (b'{"a":' * 21 + b"[]" + b"}" * 21, r"not a world: nested too deeply"),
    ):
        path.write_bytes(data)
        with pytest.raises(WorldError, match=f"^small.json: {sentence}") as caught:
            load_world(path)
        assert str(tmp_path) not in str(caught.value)
    path.write_text(json.dumps(spoilt({"starts.0.x": 0.3})), "utf-8")
    assert load_world(path).starts[0].x == 0.3
    with pytest.raises(WorldError, match=r"is 0.300 m from walls\[3\] \(wall\); the robot needs 0.4 m"):
        load_world(path, robot_radius_m=0.4)
    for name in ("ofice", "../office", "office.json", "", str(WORLDS)):
        with pytest.raises(WorldError, match=r"no world .*; expected one of: office, .*loop.*; or the path of a .json"):
            load_world(name)


def test_the_line_is_the_items() -> None:
    text = '{"a": [1,\n {"b": "x]}\\"",\n  "c": [ ]},\n 3], "a b":\n {}\n}'
    at = {(): 1, ("a",): 1, ("a", 1): 2, ("a", 1, "c"): 3, ("a", 2): 4, ("a b",): 5}
    assert {path: line_of(text, path) for path in at} == at
    assert line_of(text, ("a", 1, "missing")) == 2  # as deep as the path exists
    assert line_of(text, ("a", 9)) == line_of(text, ("a", "b")) == line_of(text, (0,)) == 1


def test_levels_are_counted() -> None:
    nested: list[object] = []
    for levels in range(1, 30):
        assert not deeper_than(levels, nested)
        assert deeper_than(levels - 1, nested)
        nested = [7, nested]
    assert not deeper_than(2, {"a": 1, "b": [2]})
    assert deeper_than(1, {"a": 1, "b": [2]})
    assert not deeper_than(0, "text")


# ------------------------------------------------------------ one's own


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    return tmp_path


def test_the_copy_from_before_is_never_half(folder: Path) -> None:
    for text in ("first", "second" * 1000):
        path = own_worlds.save("mine", text)
    before = path.with_name("mine.json.before")
    with full_after(1000), pytest.raises(ValueError, match=r"mine.json: cannot be written: File too large"):
        own_worlds.save("mine", "third")
    assert (path.read_text(), before.read_text()) == ("second" * 1000, "first")
    own_worlds.save("mine", "third")
    with full_after(1000), pytest.raises(ValueError, match="cannot be written"):
        own_worlds.save("mine", "fourth" * 1000)
    assert (path.read_text(), before.read_text()) == ("third", "third")
    assert sorted(os.listdir(folder)) == ["mine.json", "mine.json.before"]


def test_what_a_crash_left_is_tidied_up(folder: Path) -> None:
    old, young = folder / ".saving-k2x8q1", folder / ".saving-ratslam-01"
    for file in (old, young):
        file.write_text("{")
    os.utime(old, (0, 0))
    own_worlds.tidy()
    assert os.listdir(folder) == [young.name]
    os.utime(young, (0, 0))
    own_worlds.save("mine", "{}")
    assert os.listdir(folder) == ["mine.json"]
