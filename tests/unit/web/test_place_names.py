"""The names of places can be clicked on both plates: the robot goes there if its map knows the place, else a sentence tells."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Accepted, KnownPlace, RunUntil, SetGoal, SetMode, Snapshot
from web.viewer.marks.names import HEIGHT, REACH
from web.viewer.marks.robot import SMALLEST
from web.viewer.primitives.palette import USUAL

KITCHEN = KnownPlace("kitchen", 2.0, 6.0, (1.5, -0.5))
ATTIC = KnownPlace("attic", 8.0, 2.0, None)
NAMED = replace(fake_snapshot(430, goal=False), places=(KITCHEN, ATTIC))


@pytest.fixture
def moment() -> Snapshot:
    return NAMED


def press(stage: Bench, node: str) -> None:
    stage.click(stage.at(node))
    stage.show(None, 0.05)


@pytest.mark.parametrize("plate", ["office", "map"])
def test_a_click_on_a_name_sends_the_robot_where_the_map_has_the_place(stage: Bench, plate: str) -> None:
    press(stage, f"/{plate}/name_0")
    assert stage.engine.commands == [SetGoal(type="set_goal", x=1.5, y=-0.5)]
    assert stage.visible("/map/clicked")


def test_a_place_that_the_map_does_not_know_is_explored_for(stage: Bench) -> None:
    press(stage, "/office/name_1")
    assert stage.engine.commands == [SetMode(type="set_mode", mode="explore")]
    stage.answer(Accepted(5))
    assert stage.engine.commands[1] == RunUntil(type="run_until", what="place", place="attic")
    assert stage.shown("/map/name_") == ["/map/name_0"]
    for places, shown in (((KITCHEN, replace(ATTIC, map_xy=(0.0, 0.0))), ["/map/name_0", "/map/name_1"]), ((), [])):
        stage.show(replace(NAMED, places=places), 5)
        stage.settle()
        assert stage.shown("/map/name_") == shown
    assert stage.shown("/office/name_") == []


def test_names_and_robot_keep_their_size_in_a_world_of_a_hundred_metres(stage: Bench) -> None:
    small = stage.node("/office/name_0")["render_height"]
    assert NAMED.world is not None
    stage.show(replace(NAMED, world=replace(NAMED.world, bounds=(0.0, 0.0, 100.0, 80.0))), 5)
    stage.settle()
    assert stage.node("/office/name_0")["render_height"] == small == pytest.approx(HEIGHT * USUAL)
    assert stage.node("/office/robot/body")["scale"] >= SMALLEST
    stage.show(NAMED, 5)
    stage.settle()


@settings(max_examples=15)
@given(st.lists(st.tuples(st.floats(0, 10), st.floats(0, 8)), min_size=1, max_size=7))
def test_no_name_leaves_the_plate(shared: Bench, places: list[tuple[float, float]]) -> None:
    shared.show(
        replace(NAMED, places=tuple(KnownPlace(f"place {k}", x, y, None) for k, (x, y) in enumerate(places))), 5
    )
    names, nodes = shared.shown("/office/name_"), shared.nodes()
    assert len(names) == len(places)
    for name in names:
        assert abs(nodes[name]["position"][0]) + nodes[name]["render_width"] / 2 <= REACH + 1e-6
