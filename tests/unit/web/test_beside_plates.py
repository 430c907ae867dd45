"""Two brains on one stage: every plate has its place and its owner's name, and a click on the first one's map is a goal."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.http.state import state, to_json
from web.messages import BesideView, BrainFigures, Changed, Difference, SetGoal, Snapshot
from web.viewer.camera_views import VIEWS, camera_for, seen_by
from web.viewer.plates import map_plate, office_plate, pose_cell_plate
from web.viewer.plates.plate import Plate
from web.viewer.pointer import Click

pytestmark = pytest.mark.slow

CHANGED = (Changed("local_view.enabled", True, False),)


def two(tick: int = 430, of: int = 300) -> Snapshot:
    """The second brain is as the first was some time before."""
    one, other = fake_snapshot(tick), fake_snapshot(of)
    first = BrainFigures("ours", 200, 150, 160, 1, 0.2, 0.1, False)
    view = BesideView(
        first, replace(first, name="8 x 8 cells", off_m=None, error_map_m=math.inf), 0.0, 0.9,
        (Difference("view", 12, 1.2, "view #3 is seen as no view"),), CHANGED, other.pose_cells, other.map, other.times,
        other.estimate, (), other.goal, 0.3,
    )  # fmt: skip
    return replace(one, beside=view)


def plates(bench: Bench) -> dict[str, Plate]:
    scenery, beside = bench.viewer._scenery, bench.viewer._beside
    found: dict[str, Plate] = {"office": scenery.office, "pose_cells": scenery.cells, "map": scenery.map}
    if beside.two:
        assert beside.cells is not None
        assert beside.map is not None
        found |= {"pose_cells_2": beside.cells, "map_2": beside.map}
    return found


SHEETS = {"office": office_plate.SHEET, "pose_cells": pose_cell_plate.SHEET, "map": map_plate.SHEET}


def corners(name: str, plate: Plate) -> np.ndarray:
    width, depth, y, _ = SHEETS[name.removesuffix("_2")]
    x0, y0, _ = plate.origin
    return np.array([(x0 + sx * width / 2, y0 + y + sy * depth / 2, 0.0) for sx in (-1, 1) for sy in (-1, 1)])


def click_on(bench: Bench, plate: Plate) -> None:
    x, y, _ = plate.origin
    bench.viewer.click(Click((x + 1.0, y, 20.0), (0.0, 0.0, -1.0), bench.told.append))
    bench.show(None)


def test_no_plate_stands_on_another_and_all_are_in_the_view_of_both(bench: Bench) -> None:
    bench.show(two())
    stand = {name: corners(name, plate) for name, plate in plates(bench).items()}
    assert len(stand) == 5
    boxes = [(c[:, :2].min(0), c[:, :2].max(0)) for c in stand.values()]
    for k, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[k + 1 :]:
            assert (low >= other_high).any() or (high <= other_low).any()
    for aspect in (0.5, 1.0, 1.4, 2.2):
        camera = camera_for("all", aspect, two=True)
        half = math.tan(camera.fov_rad / 2) * float(np.linalg.norm(camera.look_at - camera.position))
        cells = [plate.origin for name, plate in plates(bench).items() if "cells" in name]
        top = [np.array(at) + np.array((side * 3.5, 3.5, 4.6)) for at in cells for side in (-1, 1)]
        seen, _ = seen_by(camera, np.vstack([*stand.values(), *top]))
        assert np.abs(seen[:, 0]).max() < half * aspect
        assert np.abs(seen[:, 1]).max() < half
    assert all(camera_for(view, 1.4, office, two=True) for view in VIEWS for office in (True, False))


def test_both_are_drawn_each_with_its_own_and_end_without_a_trace(bench: Bench) -> None:
    before = {name: plate.origin for name, plate in plates(bench).items()}
    snapshot = two()
    bench.show(snapshot)
    bench.settle()
    assert snapshot.beside is not None
    scenery, beside = bench.viewer._scenery, bench.viewer._beside
    assert beside.map is not None
    assert (scenery.map._layer, beside.map._layer) == (snapshot.map, snapshot.beside.map)
    for name in ("pose_cells_2/voxels", "map_2/arrow/body", "map_2/route", "pose_cells/voxels"):
        assert bench.visible(f"/{name}")
    bench.show(fake_snapshot(431))
    assert {name: plate.origin for name, plate in plates(bench).items()} == before
    assert not bench.visible("/map_2/arrow/body")
    assert not bench.visible("/pose_cells_2/voxels")
    assert bench.viewer._scenery.map._brain is None
    bench.show(two(440, 200))
    bench.settle()
    assert bench.visible("/map_2/arrow/body")


def test_it_costs_at_most_as_much_again(bench: Bench) -> None:
    """Bytes of what is sent for ten seconds of driving, with one brain and with two that are as busy."""

    def bytes_for(beside: bool) -> int:
        bench.show(two(500, 500) if beside else fake_snapshot(500))
        bench.settle()
        before = len(bench.sent)
        for tick in range(501, 601):
            bench.show(two(tick, tick) if beside else fake_snapshot(tick), 0.1)
        return sum(_bytes(message) for message in bench.sent[before:])

    assert bytes_for(True) < 2 * bytes_for(False), (bytes_for(True), bytes_for(False))


def _bytes(message: object) -> int:
    told = getattr(message, "updates", None) or getattr(getattr(message, "props", None), "__dict__", {})
    return 60 + sum(
        v.nbytes if isinstance(v, np.ndarray) else len(v) if isinstance(v, bytes) else 8 for v in told.values()
    )


def test_the_first_ones_map_is_for_goals_and_the_other_one_says_so(bench: Bench) -> None:
    bench.show(two())
    stand = plates(bench)
    click_on(bench, stand["map_2"])
    assert bench.engine.commands == []
    assert bench.told[-1] == "No goal set: this is the other brain's map; the robot goes by the first one's"
    click_on(bench, stand["map"])
    assert [type(command) for command in bench.engine.commands] == [SetGoal]


def test_without_an_office_the_boxes_stand_closer(bench: Bench) -> None:
    bench.show(replace(two(), world=None))
    assert abs(plates(bench)["pose_cells"].origin[0]) < 6.0
    bench.show(replace(fake_snapshot(431), world=None))
    assert plates(bench)["map"].origin[0] == 0.0


def test_the_page_is_told_of_both_and_never_of_infinity() -> None:
    told = state(two())["beside"]
    assert (told["first"]["name"], told["second"]["off_m"]) == ("ours", None)
    assert told["differences"] == [{"kind": "view", "tick": 12, "time_s": 1.2, "words": "view #3 is seen as no view"}]
    assert b'"error_map_m":null' in to_json(told)
    assert told["changed"] == [{"name": "local_view.enabled", "first": True, "second": False}]
    assert state(fake_snapshot(3))["beside"] is None
