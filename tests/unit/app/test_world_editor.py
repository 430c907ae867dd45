"""Edits are undone and redone, and the office goes on under the running robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.session import Session
from app.world_editor import MOST_UNDOS, WorldEditor, edited
from sim2d import Place, World
from sim2d.world.world_check import check_world

from .offices import ITEMS, RADIUS, SIDE, Taken, office, order
from .worlds import room


def placed(kind: str, name: str, x: float, y: float) -> dict[str, Any]:
    if kind == "walls":
        return {**ITEMS[kind], "from": [x, y], "to": [x + 0.3, y + 0.2]}
    moved = {**ITEMS[kind], "name": name}
    return moved | {"x": x, "y": y} if kind in ("lamps", "boxes", "places") else moved


@st.composite
def some_edits(draw: st.DrawFn) -> list[Any]:
    """Edits, good and bad, with undo and redo between them."""
    place = st.floats(-1.0, SIDE + 1.0, allow_nan=False)
    step = st.builds(
        lambda do, kind, number, name, x, y: (
            do, kind, None if do == "add" else number, None if do == "delete" else placed(kind, name, x, y)
        ),
        st.sampled_from(["add", "change", "delete"]), st.sampled_from(list(ITEMS)), st.integers(0, 6),
        st.sampled_from("abcd"), place, place,
    )  # fmt: skip
    edit = st.lists(step, min_size=1, max_size=3).map(lambda steps: order(*steps))
    return draw(st.lists(st.one_of(edit, edit, st.sampled_from(["undo", "redo"])), max_size=12))


@settings(max_examples=60)
@given(some_edits(), st.lists(st.booleans(), min_size=12, max_size=12))
def test_undo_goes_back_to_the_first_world_and_redo_to_the_last(edits: list[Any], refuses: list[bool]) -> None:
    first = office()
    editor, taken = WorldEditor(first), Taken()
    worlds = [first]  # the expected results of undo: all worlds in a plain list
    at = 0
    for edit, taken.refuses in zip(edits, refuses, strict=False):
        before, edition = editor.world, editor.edition
        try:
            if edit == "undo":
                editor.undo(taken)
                at -= 1
            elif edit == "redo":
                editor.redo(taken)
                at += 1
            else:
                editor.edit(edit, RADIUS, taken)
                worlds, at = [*worlds[: at + 1], editor.world], at + 1
        except ValueError:
            assert editor.world is before
            assert editor.edition == edition
            continue
        assert editor.world is worlds[at] is taken.world
        assert editor.edition.number > edition.number
        check_world(editor.world, RADIUS)
    taken.refuses = False
    for _ in range(at):
        editor.undo(taken)
    assert editor.world is first
    assert first == office()
    assert editor.edition.saved
    with pytest.raises(ValueError, match="nothing to undo"):
        editor.undo(taken)
    for _ in worlds[1:]:
        editor.redo(taken)
    assert editor.world is worlds[-1]
    with pytest.raises(ValueError, match="nothing to redo"):
        editor.redo(taken)


def drawn(editor: WorldEditor, take: Callable[[World], None], *kinds: str) -> None:
    """Add one thing of each kind."""
    for kind in kinds:
        editor.edit(order(("add", kind, None, ITEMS[kind])), RADIUS, take)


def test_what_would_cover_the_robot_is_refused(subtests: pytest.Subtests) -> None:
    session = Session(office(), 3)
    session.simulator.teleport(1.0, 1.0, 0.0)
    editor, before = WorldEditor(session.world), session.state_hash()
    for kind, item, reason in (
        ("walls", {"from": [0.5, 1.0], "to": [1.5, 1.0]}, r"walls\[4\] \(wall\) would cover the robot"),
        ("boxes", {**ITEMS["boxes"], "x": 1.0, "y": 1.0}, r"box 'b' would cover the robot"),
        ("doors", {**ITEMS["doors"], "hinge": [0.9, 0.5]}, r"doors\[0\] \(d\) would cover the robot"),
    ):
        with subtests.test(kind):
            with pytest.raises(ValueError, match=reason):
                editor.edit(order(("add", kind, None, item)), RADIUS, session.edit_world)
            assert session.state_hash() == before
            assert session.simulator.world is session.world is editor.world


def test_a_person_drawn_onto_the_robot_waits_until_it_is_gone() -> None:
    session = Session(office(), 3)
    WorldEditor(session.world).edit(
        order(("add", "people", None, {"name": "q", "path": [[3.0, 3.0]]})), RADIUS, session.edit_world
    )
    assert not session.simulator.actors.walkers.present.any()


def test_an_edit_of_an_older_edition_is_refused() -> None:
    editor, taken = WorldEditor(office()), Taken()
    editor.edit(order(("add", "walls", None, ITEMS["walls"]), edition=1), RADIUS, taken)
    with pytest.raises(ValueError, match="somebody has changed the office since"):
        editor.edit(order(("delete", "walls", 4, None), edition=1), RADIUS, taken)
    assert len(editor.world.walls) == 5


def test_what_others_do_to_the_office_is_a_step_of_its_own() -> None:
    session = Session(office(), 3)
    editor = WorldEditor(session.world)
    drawn(editor, session.edit_world, "boxes")
    session.simulator.remove_box("b")
    editor.follow(session.simulator.world)
    assert editor.edition.undo == "box put down or taken away"
    editor.undo(session.edit_world)
    assert [box.name for box in session.simulator.world.boxes] == ["b"]
    assert editor.edition.undo == "box drawn"


def test_a_reset_keeps_the_edits_and_another_world_has_none() -> None:
    editor, taken = WorldEditor(office()), Taken()
    drawn(editor, taken, "walls")
    mine = editor.world
    editor.begin(mine)
    assert editor.edition.undo == "wall drawn"
    editor.follow(edited(mine, order(("add", "boxes", None, ITEMS["boxes"])).steps))
    editor.begin(mine)  # a reset takes the box away
    assert editor.world is mine
    assert (editor.edition.undo, editor.edition.saved) == ("wall drawn", False)
    editor.begin(room(start=(2.0, 2.0, 0.0)))
    assert (editor.edition.undo, editor.edition.redo, editor.edition.saved) == ("", "", True)


def test_a_saved_world_has_its_name_from_then_on() -> None:
    editor, taken = WorldEditor(office()), Taken()
    first = editor.world
    drawn(editor, taken, "places")
    was, named = editor.world, replace(editor.world, name="mine", title="Mine")
    editor.named(was, named, taken)
    assert editor.edition.saved
    assert taken.world is editor.world is named
    editor.undo(taken)
    assert (editor.world, editor.edition.saved) == (replace(first, name="mine", title="Mine"), False)
    editor.redo(taken)
    assert editor.world is named
    assert editor.edition.saved
    editor.undo(taken)
    editor.named(was, named, taken)  # it was edited again while it was being written
    assert not editor.edition.saved


def test_what_is_in_no_file_counts_as_unsaved() -> None:
    editor, taken = WorldEditor(office()), Taken()
    other = room(start=(2.0, 2.0, 0.0))
    for does, saved in (
        (lambda: editor.unfiled("room"), False),  # deleted
        (lambda: editor.filed("room"), True),  # brought back
        (lambda: editor.unfiled("room"), False),
        (lambda: editor.begin(replace(other, name="else")), True),
        (lambda: editor.begin(replace(other, name="room")), False),
        (lambda: editor.filed("room"), False),  # what came back is another world
        (lambda: editor.named(editor.world, editor.world, taken), True),
    ):
        does()
        assert editor.edition.saved is saved


def test_undo_reaches_a_long_way_back_but_not_for_ever() -> None:
    editor, taken = WorldEditor(office()), Taken()
    for k in range(MOST_UNDOS + 5):
        step = ("change", "places", 0) if k else ("add", "places", None)
        editor.edit(order((*step, {"name": f"p{k}", "x": 1, "y": 1})), RADIUS, taken)
    for _ in range(MOST_UNDOS):
        editor.undo(taken)
    assert editor.world.places == (Place("p4", 1.0, 1.0),)


def test_a_line_of_the_script_is_added_and_fires_in_its_tick_alone() -> None:
    """Of two lines drawn at 1 s, one lies in the past and one in the future. The first waits for a restart."""

    def levels(session: Session, ticks: int) -> list[float]:
        told = []
        for _ in range(ticks):
            session.tick()
            told.append(session.simulator.actors.daylight)
        return told

    session = Session(office(), 3)
    assert levels(session, 10) == [1.0] * 10
    editor = WorldEditor(session.world)
    dim, dark = {"at_s": 0.5, "do": "daylight", "level": 0.7}, {"at_s": 1.5, "do": "daylight", "level": 0.2}
    words = editor.edit(order(("add", "script", None, dark), ("add", "script", None, dim)), RADIUS, session.edit_world)
    assert words == "line of the script added and 1 more change"
    assert levels(session, 10) == [1.0] * 4 + [0.2] * 6
    assert levels(Session(editor.world, 3), 20) == [1.0] * 4 + [0.7] * 10 + [0.2] * 6
    editor.undo(session.edit_world)  # no line is left that has set it
    assert levels(session, 1) == [1.0]
