"""An edit is a list of steps on a world. All are done or none, and the refusal says what is wrong."""

from __future__ import annotations

from typing import Any

import pytest

from app.session import Session
from app.world_editor import WorldEditor, edited
from sim2d import world_from_json, world_to_json
from sim2d.world.world_check import check_world

from .offices import ITEMS, RADIUS, Taken, office, order


def test_every_kind_is_added_changed_and_deleted(subtests: pytest.Subtests) -> None:
    world = office()
    for kind, item in ITEMS.items():
        with subtests.test(msg=kind):
            count = len(getattr(world, kind) or ())
            added = edited(world, order(("add", kind, None, item)).steps)
            check_world(added, RADIUS)
            assert kind == "daylight" or len(getattr(added, kind)) == count + 1
            assert world_from_json(world_to_json(added), "f") == added
            changed = edited(added, order(("change", kind, count, item)).steps)
            assert changed == added
            assert edited(changed, order(("delete", kind, count, None)).steps) == world
            assert world == office()


def add(kind: str, **item: Any) -> tuple[Any, ...]:
    """The usual item of its kind, but for what is given."""
    return ("add", kind, None, {**ITEMS[kind], **item})


REFUSED = [
    ([("add", "walls", None, None)], r"steps\[0\]: item: is missing; must be a wall as in a world file"),
    ([("add", "walls", 3, ITEMS["walls"])], r"number: got 3; what is added takes none"),
    ([("delete", "doors", 0, None)], r"number: got 0; there is no such door, there are none"),
    ([("delete", "walls", 4, None)], r"number: got 4; there is no such wall, must be from 0 to 3"),
    ([("delete", "walls", None, None)], r"number: got None"),
    ([("delete", "walls", 0, ITEMS["walls"])], r"item: what is deleted takes none"),
    ([("delete", "starts", 0, None)], r"this is the only start; the robot needs one"),
    ([("delete", "walls", 0, None)], r"walls\[2\]: the outline is open: it ends at \(0, 0\)|walls\[\d\]: .*open"),
    ([add("lamps", reach=-1)], r"lamp: reach: got -1; input should be"),
    ([add("lamps", glow=1)], r"lamp: glow: got 1; unknown key"),
    ([add("boxes", x=99)], r"boxes\[0\]: 'b' \(99, 1\) is outside of room"),
    ([add("boxes", x=3.0, y=3.0)], r"\(3, 3\) is 0.000 m from box 'b'; the robot needs 0.2 m"),
    ([add("walls", **{"from": [2, 3], "to": [4, 3]})], r"starts\[0\] \(home\): .* from walls\[4\] \(wall\)"),
    ([add("walls", **{"from": [1, 1], "to": [1, 1]})], r"walls\[4\]: no length"),
    ([add("doors")] * 2, r"doors\[1\].name: 'd' is taken by doors\[0\]"),
    ([add("walls"), ("delete", "walls", 9, None)], r"steps\[1\]: number: got 9"),
    ([("add", "script", None, {"at_s": -1, "do": "people_on"})], r"line of the script: at_s: got -1; input should be"),
    ([("add", "script", None, {"at_s": 1, "do": "sing"})], r"line of the script: do: got 'sing'; input should be"),
    ([("add", "script", None, {"at_s": 1, "do": "open_door", "name": "x"})], r"script\[0\].name: no doors named 'x'"),
    ([add("daylight")] * 2, r"list: there are 1 daylight; at most 1"),
    ([("add", "daylight", None, {"points": [[9, 1], [3, 1]]})], r"daylight.points\[1\]: is at 3 s; times must grow"),
    ([("add", "daylight", None, {"points": [[0, 4]]})], r"daylight.points\[0\]: has level 4; must be from 0 to 3"),
    ([("change", "daylight", 0, ITEMS["daylight"])], r"number: got 0; there is no such daylight, there are none"),
]


def test_a_bad_edit_says_what_is_wrong_and_changes_nothing(subtests: pytest.Subtests) -> None:
    session = Session(office(), 3)
    editor, before = WorldEditor(session.world), session.state_hash()
    for steps, reason in REFUSED:
        with subtests.test(msg=reason):
            with pytest.raises(ValueError, match=reason):
                editor.edit(order(*steps), RADIUS, session.edit_world)
            assert session.state_hash() == before
            assert session.world is editor.world is session.simulator.world
            assert editor.edition.number == 1


def test_a_wall_gets_looks_of_its_own() -> None:
    steps = order(
        ("add", "walls", None, {"from": [0.5, 0.5], "to": [4.5, 0.5]}),
        ("add", "walls", None, {"from": [0.5, 1.5], "to": [4.5, 1.5]}),
        ("add", "walls", None, {"from": [0.5, 5.0], "to": [4.5, 5.0], "kind": "glass"}),
        ("add", "walls", None, {"from": [0.5, 2.0], "to": [2.0, 2.0], "colour": "#102030", "height": 1.0}),
    ).steps
    world = edited(office(), steps)
    first, second, glass, plain = world.walls[4:]
    assert {panel.side for panel in first.panels} == {"left", "right"}
    assert first.panels != second.panels
    assert glass.panels == plain.panels == ()
    assert (plain.colour, plain.height) == ((16, 32, 48), 1.0)
    assert edited(office(), steps) == world
    check_world(world, RADIUS)


def test_what_many_steps_did_is_told_by_what_was_drawn() -> None:
    editor, steps = WorldEditor(office()), [add("walls"), add("doors"), ("change", "walls", 4, ITEMS["walls"])]
    assert editor.edit(order(*steps), RADIUS, Taken()) == "door drawn and 2 more changes"
