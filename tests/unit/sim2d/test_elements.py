"""Doors, lamps, boxes, people, slow zones and scripts in world files."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sim2d import WorldError, load_world, world_from_json, world_names, world_to_json
from sim2d.world.elements import Box, Daylight, Event, Lamp
from sim2d.world.json_lines import deeper_than, line_of

from .rooms import room_file

Spoil = Callable[[dict[str, Any]], object]


def living_file() -> dict[str, Any]:
    """The room of `room_file` with one of everything."""
    return room_file() | {
        "doors": [{"name": "lab", "hinge": [2.0, 2.0], "angle_deg": 90, "width": 0.9, "period_s": 20.0, "open_s": 5.0}],
        "lamps": [{"name": "ceiling", "x": 2.0, "y": 3.0}],
        "daylight": {"points": [[0, 0.4], [60, 1.0]], "repeat_s": 120.0},
        "boxes": [{"name": "crate", "x": 2.5, "y": 0.5, "width": 0.4, "depth": 0.3, "angle_deg": 30, "present": False}],
        "people": [{"name": "Ada", "path": [[0.5, 3.5], [3.5, 3.0]], "wait_s": [1.0, 2.0], "loop": False}],
        "slow_zones": [{"name": "carpet", "corners": [[0, 0], [1, 0], [1, 1]], "factor": 0.5}],
        "script": [{"at_s": 3, "do": "close_door", "name": "lab"}, {"at_s": 4, "do": "people_off"}],
    }


def read(data: dict[str, Any]) -> Any:
    return world_from_json(json.dumps(data, indent=1), "living.json")


def test_a_file_with_one_of_everything() -> None:
    world = read(living_file())
    assert world.doors[0].angle_rad == pytest.approx(math.pi / 2)
    assert (world.doors[0].open, world.doors[0].slides, world.doors[0].open_s) == (True, False, 5.0)
    assert world.lamps == (Lamp("ceiling", 2.0, 3.0, 4.0, 0.5),)
    assert world.daylight == Daylight((0, 60), (0.4, 1.0), 120.0)
    assert world.people[0].path == ((0.5, 3.5), (3.5, 3.0))
    assert world.slow_zones[0].factor == 0.5
    assert world.script == (Event(3, "close_door", "lab"), Event(4, "people_off"))


@pytest.mark.parametrize("name", [name for name, _ in world_names()])
def test_what_is_written_reads_the_same(name: str) -> None:
    world = load_world(name)
    assert world_from_json(world_to_json(world), "again.json") == world


def test_what_is_written_of_everything_reads_the_same() -> None:
    data = living_file()
    data["walls"].append(
        {"from": [1, 3], "to": [1.5, 3], "kind": "glass", "height": 2, "colour": "#AABBCC", "name": "pane"}
    )
    world = read(data)
    assert world_from_json(world_to_json(world), "again.json") == world


def test_daylight_runs_straight_and_repeats() -> None:
    day = Daylight((0.0, 60.0), (0.4, 1.0), 120.0)
    assert [day.at(t) for t in (0, 30, 60, 100, 150)] == pytest.approx([0.4, 0.7, 1.0, 1.0, 0.7])
    assert Daylight((10.0,), (0.5,)).at(0.0) == 0.5


def test_corners_of_a_box() -> None:
    corners = Box("b", 1.0, 2.0, 0.4, 0.2, angle_rad=math.pi / 2).corners
    assert corners == pytest.approx(np.array([[1.1, 1.8], [1.1, 2.2], [0.9, 2.2], [0.9, 1.8]]))


def twice(kind: str) -> Spoil:
    return lambda d: d[kind].append(dict(d[kind][0]))


BAD: dict[str, tuple[Spoil, str]] = {
    "two doors of one name": (twice("doors"), r"doors\[1\].name: 'lab' is taken by doors\[0\]; use another"),
    "two people of one name": (twice("people"), r"people\[1\].name: 'Ada' is taken by people\[0\]"),
    "door outside": (
        lambda d: d["doors"][0].update(hinge=[5, 1]),
        r"doors\[0\].hinge: the hinge \(5, 1\) is outside of",
    ),
    "lamp outside": (
        lambda d: d["lamps"][0].update(x=-1),
        r"lamps\[0\]: 'ceiling' \(-1, 3\) is outside of small, which",
    ),
    "path outside": (
        lambda d: d["people"][0]["path"].append([9, 9]),
        r"people\[0\].path\[2\]: a point of 'Ada' \(9, 9\) is outside",
    ),
    "waits": (
        lambda d: d["people"][0].update(wait_s=[1, 2, 3]),
        r"people\[0\].wait_s: has 3 times; must be one time, or one for each of the 2 points",
    ),
    "no such door": (
        lambda d: d["script"][0].update(name="lap"),
        r"script\[0\].name: no doors named 'lap'; expected one of: lab",
    ),
    "no lamps": (
        lambda d: (d.pop("lamps"), d["script"].append({"at_s": 1, "do": "lamp_off", "name": "x"})),
        r"script\[2\].name: no lamps named 'x'; expected one of: none, since the world has no lamps",
    ),
    "unknown action": (
        lambda d: d["script"][0].update(do="slam"),
        r"script\[0\].do: got 'slam'; input should be 'open",
    ),
    "day backwards": (
        lambda d: d["daylight"].update(points=[[5, 1], [5, 1]]),
        r"daylight.points\[1\]: is at 5 s; times must grow",
    ),
    "day too bright": (
        lambda d: d["daylight"].update(points=[[0, 4]]),
        r"daylight.points\[0\]: has level 4; must be from",
    ),
    "day too short": (
        lambda d: d["daylight"].update(repeat_s=30),
        r"daylight.repeat_s: 30 s must be 0 or at least .* 60 s",
    ),
    "open too long": (lambda d: d["doors"][0].update(open_s=30), r"doors\[0\].open_s: 30 s must be at most .* 20 s"),
    "slow is not still": (
        lambda d: d["slow_zones"][0].update(factor=0),
        r"slow_zones\[0\].factor: got 0; .* equal to 0.05",
    ),
    "no width": (lambda d: d["boxes"][0].update(width=0), r"boxes\[0\].width: got 0; input should be greater"),
    "box on the start": (
        lambda d: d["boxes"][0].update(x=1.3, y=1.0, present=True),
        r"starts\[0\] \(home\): .* is 0.060 m from box 'crate'; the robot needs 0.22 m",
    ),
    "a crowd": (lambda d: d.update(people=d["people"] * 51), r"people: list should have at most 50 items.*not 51"),
    "too many walls": (lambda d: d.update(walls=d["walls"] * 2001), r"walls: list should have at most 10000 items"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("spoil", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_things_say_what_is_wrong(spoil: Spoil, sentence: str) -> None:
    data = living_file()
    spoil(data)
    with pytest.raises(WorldError, match=rf"^living.json: {sentence}.* \(line \d+\)$"):
        read(data)


def test_the_line_is_the_items() -> None:
    text = '{"a": [1,\n {"b": "x]}\\"",\n  "c": [ ]},\n 3], "a b":\n {}\n}'
    at = {(): 1, ("a",): 1, ("a", 1): 2, ("a", 1, "c"): 3, ("a", 2): 4, ("a b",): 5}
    assert {path: line_of(text, path) for path in at} == at
    assert line_of(text, ("a", 1, "missing")) == 2  # as deep as the path exists
    assert line_of(text, ("a", 9)) == line_of(text, ("a", "b")) == 1
    assert line_of(text, (0,)) == 1


def test_a_bomb_of_brackets_is_refused() -> None:
    for text in ("[" * 100_000, '{"a":' * 21 + "[]" + "}" * 21):
        with pytest.raises(WorldError, match=r"deep.json: not a world: nested too deeply"):
            world_from_json(text, "deep.json")


def test_levels_are_counted() -> None:
    nested: list[object] = []
    for levels in range(1, 30):
        assert not deeper_than(levels, {"a": 1, "b": [2]} if levels == 2 else nested)
        assert deeper_than(levels - 1, nested)
        nested = [7, nested]
    assert not deeper_than(0, "text")
