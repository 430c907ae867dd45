from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim2d import DEFAULT_WORLD, FreeSpace, World, WorldError, load_world, world_names, world_to_json
from sim2d.world.world_file import SCHEMA, WORLDS, schema_text
from sim2d.worlds.make import MADE

from .rooms import room_file

DOCS = Path(__file__).parents[3] / "docs"
NAMES = [name for name, _ in world_names()]
Spoil = Callable[[dict[str, Any]], object]


def load(tmp_path: Path, data: object) -> World:
    path = tmp_path / "small.json"
    path.write_text(data if isinstance(data, str) else json.dumps(data), "utf-8")
    return load_world(path)


def test_default_comes_first_and_all_are_titled() -> None:
    assert NAMES[0] == DEFAULT_WORLD == load_world().name
    assert {"office", "loop", "floor"} <= set(NAMES)
    assert all(title for _, title in world_names())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.slow
def test_shipped_worlds(name: str) -> None:
    world = load_world(name)
    assert world.name == name
    assert load_world(str(WORLDS / f"{name}.json")) == world
    free = FreeSpace(world, 0.22)
    home = world.starts[0]
    assert all(free.shortest_m((home.x, home.y), (p.x, p.y)) < 60 for p in world.places)
    walls = [w for w in world.walls if w.kind == "wall"]
    assert sum(len(w.panels) for w in walls) / sum(w.length for w in walls) >= 0.6  # findings: fewer look alike
    seeds = [p.seed for w in world.walls for p in w.panels]
    assert len(set(seeds)) == len(seeds) or name == "twins"
    assert world.about.endswith(".")
    assert f"![{world.title}](pictures/worlds/{name}.png)" in (DOCS / "worlds.md").read_text("utf-8")
    assert (DOCS / "pictures" / "worlds" / f"{name}.png").is_file()


@pytest.mark.parametrize("make", MADE)
def test_a_made_world_is_what_its_maker_makes(make: Callable[[], World]) -> None:
    world = make()
    assert (WORLDS / f"{world.name}.json").read_text("utf-8") == world_to_json(world)


def test_twin_corridors_look_alike() -> None:
    """Each wall and picture of the lower corridor appears again, 4.8 m further up."""
    pair = [w for w in load_world("twins").walls if w.y1 != w.y2 or 0.0 < w.y1 < 8.6]
    looks = {(w.x1, w.x2, w.y1, w.y2, w.panels) for w in pair if w.panels and w.kind == "wall" and w.y1 == w.y2}
    lower = {look for look in looks if look[2] < 4}
    assert len(lower) == 2
    assert {(x1, x2, y1 + 4.8, y2 + 4.8, panels) for x1, x2, y1, y2, panels in lower} == looks - lower


def test_sizes_are_the_papers() -> None:
    ring = load_world("corridors")
    outer, inner = np.ptp(ring.outline, axis=0), np.ptp([(w.x1, w.y1) for w in ring.walls if not w.outer], axis=0)
    assert float((outer + inner).sum()) == pytest.approx(70.0)  # round the middle line
    assert load_world("campus").bounds == (0, 0, 45, 13)
    assert load_world("floor").bounds == (0, 0, 43, 13)
    assert np.prod(load_world("open-plan").bounds[2:]) == 80
    goals = {p.name: p for p in load_world("two-goals").places}
    free = FreeSpace(load_world("two-goals"), 0.22)
    home = load_world("two-goals").starts[0]
    assert free.shortest_m((home.x, home.y), (goals["goal 1"].x, goals["goal 1"].y)) == pytest.approx(16.5, abs=0.6)
    ends = [(goals[name].x, goals[name].y) for name in ("goal 1", "goal 2")]
    assert free.shortest_m(*ends) == pytest.approx(21.0, abs=1.0)


def test_schema_is_published() -> None:
    assert SCHEMA.read_text("utf-8") == schema_text()
    assert "schema" not in NAMES


def test_office_is_the_papers() -> None:
    world = load_world("office")
    assert world.bounds == (0.0, 0.0, 10.0, 8.0)
    corners = [(world.starts[0].x, world.starts[0].y), *((p.x, p.y) for p in world.places)]
    assert len({(x > 5, y > 4) for x, y in corners}) == 4
    assert sum(w.kind == "screen" for w in world.walls) >= 4


def test_loop_is_18_m_round() -> None:
    outline = load_world("loop").outline
    inner = np.array([(w.x1, w.y1) for w in load_world("loop").walls if not w.outer])
    assert np.ptp(outline, axis=0) + np.ptp(inner, axis=0) == pytest.approx([9.0, 9.0])  # twice the centre line's side


def test_a_file_becomes_a_world(tmp_path: Path) -> None:
    world = load(tmp_path, room_file())
    assert (world.name, world.title, world.floor_colour) == ("small", "Small", (96, 96, 96))
    assert world.starts[0].heading_rad == pytest.approx(math.pi / 2)
    assert world.walls[4].panels[0].colour == (230, 159, 0)
    assert world.walls[4].length == 1.0


def outer_open(d: dict[str, Any]) -> None:
    d["walls"][2]["to"] = [0, 3.5]


def last_open(d: dict[str, Any]) -> None:
    d["walls"][3]["to"] = [0, 0.5]


def clockwise(d: dict[str, Any]) -> None:
    for wall in d["walls"][:4]:
        wall["from"], wall["to"] = wall["to"], wall["from"]
    d["walls"][:4] = d["walls"][3::-1]


BAD: dict[str, tuple[Spoil, str]] = {
    "open outline": (
        outer_open,
        r"small.json: walls\[2\]: the outline is open: it ends at \(0, 3.5\) but walls\[3\] begins at \(0, 4\); each",
    ),
    "open at its end": (last_open, r"walls\[3\]: the outline is open: it ends at \(0, 0.5\) but walls\[0\] begins"),
    "clockwise": (clockwise, r"walls\[0\]: the outline encloses -16 m\^2; it must run counter-clockwise"),
    "no outline": (
        lambda d: [w.pop("outer") for w in d["walls"][:4]],
        r"small.json: walls: 0 are outer; at least 3 must close the outline",
    ),
    "outer after inner": (
        lambda d: d["walls"].insert(0, d["walls"].pop()),
        r"walls\[4\]: is outer but comes after inner ones",
    ),
    "floating outer wall": (lambda d: d["walls"][1].update(bottom=1.0), r"walls\[1\]: bottom 1 must be 0 in the outer"),
    "no length": (
        lambda d: d["walls"][4].update(to=[3, 1], panels=[]),
        r"walls\[4\]: no length: runs from \(3, 1\) to \(3, 1\); its ends must be at least 0.01 m apart",
    ),
    "nan": (lambda d: d["walls"][1]["from"].__setitem__(0, math.nan), r"walls\[1\].from\[0\]: got nan; .*finite"),
    "inf": (lambda d: d["starts"][0].update(x=math.inf), r"starts\[0\].x: got inf; .*finite"),
    "unknown key": (lambda d: d["walls"][3].update(colr=1), r"walls\[3\].colr: got 1; unknown key; take it out or"),
    "unknown top key": (lambda d: d.update(lifts=[]), r"small.json: lifts: got \[\]; unknown key"),
    "missing key": (lambda d: d["walls"][0].pop("height"), r"walls\[0\].height: field required"),
    "bad colour": (lambda d: d["walls"][0].update(colour="red"), r"walls\[0\].colour: got 'red'; string should match"),
    "bad texture": (
        lambda d: d["walls"][4]["panels"][0].update(texture="noise"),
        r"walls\[4\].panels\[0\].texture: got 'noise'; input should be .*'poster'",
    ),
    "other format": (lambda d: d.update(format=2), r"format: got 2; input should be 1"),
    "negative height": (lambda d: d["walls"][0].update(height=-1), r"walls\[0\].height: got -1; .*greater than 0"),
    "upside down": (lambda d: d["walls"][4].update(bottom=1.4), r"walls\[4\]: bottom 1.4 must be below its height 1.4"),
    "hangs too low": (lambda d: d["walls"][4].update(bottom=0.3), r"bottom 0.3 must be 0 or at least 0.6 m, above"),
    "panel too long": (
        lambda d: d["walls"][4]["panels"][0].update(at=0.7),
        r"walls\[4\].panels\[0\]: reaches to 1.2 m; the wall is 1 m long",
    ),
    "panel too high": (
        lambda d: d["walls"][4]["panels"][0].update(top=1.5),
        r"walls\[4\].panels\[0\]: from 0.3 up to 1.5 m; must be upright and between the wall's 0 and 1.4 m",
    ),
    "start in a wall": (
        lambda d: d["starts"][0].update(x=2.9, y=1.5),
        r"starts\[0\] \(home\): \(2.9, 1.5\) is 0.100 m from walls\[4\] \(partition\); the robot needs 0.22 m",
    ),
    "start outside": (
        lambda d: d["starts"][0].update(x=-2.0),
        r"starts\[0\] \(home\): \(-2, 1\) is outside of small, which spans 0 to 4 by 0 to 4 m",
    ),
    "place outside": (lambda d: d["places"][0].update(y=9), r"places\[0\] \(corner\): \(3.5, 9\) is outside of small"),
    "too large": (
        lambda d: [w.update({k: [1000 * v for v in w[k]] for k in ("from", "to")}) for w in d["walls"][:4]],
        r"small.json: walls: the outline spans 4000 by 4000 m; at most 3000 m each way \(line",
    ),
    "too much floor": (
        lambda d: [w.update({k: [400 * v for v in w[k]] for k in ("from", "to")}) for w in d["walls"][:4]],
        r"small.json: walls: 2560000 m\^2 of floor in all; at most 2e\+06",
    ),
    "too much wall": (
        lambda d: d["walls"].extend([{"from": [-9000, 9], "to": [9000, 9], "height": 12, "colour": "#000000"}]),
        r"small.json: walls: 216043 m\^2 of wall in all; at most 200000",
    ),
    "no start": (lambda d: d.update(starts=[]), r"starts: got \[\]; list should have at least 1 item"),
}


@pytest.mark.parametrize(("spoil", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_worlds_say_what_is_wrong(tmp_path: Path, spoil: Spoil, sentence: str) -> None:
    data = room_file()
    spoil(data)
    with pytest.raises(WorldError, match=sentence) as caught:
        load(tmp_path, data)
    assert str(caught.value).startswith("small.json: ")
    assert str(tmp_path) not in str(caught.value)


def test_place_that_cannot_be_reached(tmp_path: Path) -> None:
    data = room_file()
    data["walls"].append({"from": [2, 0], "to": [2, 4], "height": 2.6, "colour": "#C0C0C0"})
    with pytest.raises(WorldError, match=r"places\[0\] \(corner\): \(3.5, 3.5\) is closed in: no way leads .* home"):
        load(tmp_path, data)


def test_the_robots_size_counts(tmp_path: Path) -> None:
    data = room_file()
    data["starts"][0].update(x=0.3)
    load(tmp_path, data)
    with pytest.raises(WorldError, match=r"is 0.300 m from walls\[3\] \(wall\); the robot needs 0.4 m"):
        load_world(tmp_path / "small.json", robot_radius_m=0.4)


def test_files_that_are_no_worlds(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match=r"small.json: not JSON: line 1, column 2: "):
        load(tmp_path, "{oops")
    with pytest.raises(WorldError, match=r"small.json: file: input should be a valid dictionary"):
        load(tmp_path, [])
    (tmp_path / "small.json").write_bytes(b"\xff\xfe\xff")
    with pytest.raises(WorldError, match=r"small.json: cannot be read"):
        load_world(tmp_path / "small.json")


@pytest.mark.parametrize("name", ["ofice", "../office", "office.json", "", str(WORLDS)])
def test_missing_worlds_name_those_that_exist(name: str) -> None:
    with pytest.raises(WorldError, match=r"no world .*; expected one of: office, .*loop.*; or the path of a .json"):
        load_world(name)
