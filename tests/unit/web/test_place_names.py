"""The names of places can be clicked on both plates: the robot goes there if its map knows the place, else a sentence tells."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import KnownPlace, SetGoal, Snapshot
from web.viewer.camera_views import CELLS_AT, LOW_ASPECT, MAP_AT, OFFICE_AT, VIEWS, camera_for
from web.viewer.marks.place_names import HEIGHT, REACH, Z
from web.viewer.marks.robot_model import SMALLEST
from web.viewer.plates import map_plate, office_plate, pose_cell_plate

KITCHEN = KnownPlace("kitchen", 2.0, 6.0, (1.5, -0.5))
ATTIC = KnownPlace("attic", 8.0, 2.0, None)


@pytest.fixture
def bench(shared: Bench) -> Bench:
    shared.show(named(), 10.0)
    shared.settle()
    shared.engine.commands.clear()
    shared.told.clear()
    return shared


def named() -> Snapshot:
    return replace(fake_snapshot(430, goal=False), places=(KITCHEN, ATTIC))


def press(bench: Bench, plate: str, name: str) -> None:
    scenery = bench.viewer._scenery
    of = scenery.office if plate == "office" else scenery.map
    ((_, x, y, _),) = [box for box in of.names._boxes if box[0] == name]
    bench.click((of.origin[0] + x, of.origin[1] + y, of.origin[2] + Z))
    bench.show(None, 0.05)


@pytest.mark.parametrize("plate", ["office", "map"])
def test_a_click_on_a_name_sends_the_robot_where_the_map_has_the_place(bench: Bench, plate: str) -> None:
    press(bench, plate, "kitchen")
    assert bench.engine.commands == [SetGoal(type="set_goal", x=1.5, y=-0.5)]
    assert bench.visible("/map/clicked")


def test_of_a_place_that_the_map_does_not_know_a_sentence_says_so(bench: Bench) -> None:
    press(bench, "office", "attic")
    assert bench.engine.commands == []
    assert bench.told == ["No goal set: the map does not know the attic: the robot has not been there"]
    assert [box[0] for box in bench.viewer._scenery.map.names._boxes] == ["kitchen"]


def test_a_place_that_becomes_known_gets_its_name_on_the_map(bench: Bench) -> None:
    bench.show(replace(named(), places=(KITCHEN, replace(ATTIC, map_xy=(0.0, 0.0)))), 5)
    bench.settle()
    assert [box[0] for box in bench.viewer._scenery.map.names._boxes] == ["kitchen", "attic"]
    assert bench.visible("/map/name_1")
    bench.show(replace(named(), places=()), 5)
    bench.settle()
    assert not bench.visible("/map/name_0")
    assert not bench.visible("/office/name_1")


def test_names_and_robot_keep_their_size_in_a_world_of_a_hundred_metres(bench: Bench) -> None:
    small, snapshot = bench.node("/office/name_0")["render_height"], named()
    assert snapshot.world is not None
    wide = replace(snapshot, world=replace(snapshot.world, bounds=(0.0, 0.0, 100.0, 80.0)))
    bench.show(wide, 5)
    bench.settle()
    assert bench.node("/office/name_0")["render_height"] == small == pytest.approx(HEIGHT)
    assert bench.viewer._scenery.office.robot.radius >= SMALLEST
    bench.show(snapshot, 5)
    bench.settle()


numbers = st.floats(-5, 5)


@settings(max_examples=25)
@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=7))
def test_no_name_leaves_the_plate(shared: Bench, places: list[tuple[float, float]]) -> None:
    names = shared.viewer._scenery.office.names
    names.show([f"place {k}" for k in range(len(places))], [True] * len(places), np.array(places))
    for _, x, _, width in names._boxes:
        assert abs(x) + width / 2 <= REACH + 1e-6


# ---------------------------------------------------------------- the room of the window


def test_the_plates_fill_the_window_and_stay_in_it(subtests: pytest.Subtests) -> None:
    """Every corner of the plates in view is seen, and two opposite sides are reached, whatever the window's shape."""
    for view, aspect in product(VIEWS, [0.46, 0.75, 1.0, 1.35, 1.63, 2.2, 3.0]):
        with subtests.test(view=view, aspect=aspect):
            plates = {
                "office": (office_plate, OFFICE_AT),
                "map": (map_plate, MAP_AT),
                "pose": (pose_cell_plate, CELLS_AT),
            }
            camera = camera_for(view, aspect)  # type: ignore[arg-type]
            corners = []
            for name, (plate, at) in plates.items():
                assert plate.ORIGIN[:2] == at
                width, depth, centre_y, _ = plate.SHEET
                if view in ("all", name):
                    corners += [
                        (at[0] + a * width / 2, at[1] + centre_y + b * depth / 2, 0.0) for a in (-1, 1) for b in (-1, 1)
                    ]
            ahead = camera.look_at - camera.position
            ahead /= np.linalg.norm(ahead)
            right = np.cross(ahead, (0.0, 0.0, 1.0))
            right /= np.linalg.norm(right)
            offset = np.array(corners) - camera.position
            half = np.tan(camera.fov_rad / 2)
            x = offset @ right / (offset @ ahead) / half / aspect
            y = offset @ np.cross(right, ahead) / (offset @ ahead) / half
            assert np.abs(x).max() < 1
            assert np.abs(y).max() < 1
            filled = max(x.max() - x.min(), y.max() - y.min() if view in ("office", "map") else 2 * abs(y.min()))
            assert filled > (
                1.5 if aspect > LOW_ASPECT else 1.65
            )  # of 2; the rest is for buttons above and for what is said below
