"""Two brains on one stage: every plate has its place and its owner's name, and a click on the first one's map is a goal."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.http.state import state, to_json
from web.messages import BesideView, BrainFigures, Changed, Difference, MapLayer, SetGoal, Snapshot
from web.viewer.camera_views import SHEET, VIEWS, camera_for, seen_by
from web.viewer.fits import MapFit, refit
from web.viewer.pointer import Click

pytestmark = pytest.mark.slow

PLATES = ("office", "pose_cells", "map", "pose_cells_2", "map_2")


def two(tick: int = 430, of: int = 300) -> Snapshot:
    """The second brain is as the first was some time before."""
    one, other = fake_snapshot(tick), fake_snapshot(of)
    first = BrainFigures("ours", 200, 150, 160, 1, 0.2, 0.1, False)
    view = BesideView(
        first, replace(first, name="8 x 8 cells", off_m=None, error_map_m=math.inf), 0.0, 0.9,
        (Difference("view", 12, 1.2, "view #3 is seen as no view"),), (Changed("local_view.enabled", True, False),),
        other.pose_cells, other.map, other.times, other.estimate, (), other.goal, 0.3,
    )  # fmt: skip
    return replace(one, beside=view)


@pytest.fixture
def bench(shared: Bench) -> Bench:
    """One that shows one brain."""
    shared.show(fake_snapshot(430), 10.0)
    shared.settle()
    shared.engine.commands.clear()
    return shared


def at(bench: Bench, plate: str) -> np.ndarray:
    return np.array(bench.node(f"/{plate}")["position"])


def corners(bench: Bench, plate: str) -> np.ndarray:
    width, depth, y = SHEET
    around = [(sx * width / 2, y + sy * depth / 2, 0.0) for sx in (-1, 1) for sy in (-1, 1)]
    return at(bench, plate) * (1, 1, 0) + around


def test_no_plate_stands_on_another_and_all_are_in_the_view_of_both(bench: Bench) -> None:
    bench.show(two())
    stand = [corners(bench, plate) for plate in PLATES]
    for one, other in combinations(stand, 2):
        assert ((one.min(0) >= other.max(0)) | (other.min(0) >= one.max(0)))[:2].any()
    tops = [at(bench, cells) + np.array((x, 3.5, 4.6)) for cells in PLATES if "cells" in cells for x in (-3.5, 3.5)]
    for aspect in (0.5, 1.0, 1.4, 2.2):
        camera = camera_for("all", aspect, two=True)
        half = math.tan(camera.fov_rad / 2) * float(np.linalg.norm(camera.look_at - camera.position))
        seen, _ = seen_by(camera, np.vstack([*stand, *tops]))
        assert (np.abs(seen).max(0) < (half * aspect, half)).all()
    assert all(camera_for(view, 1.4, office, two=True) for view in VIEWS for office in (True, False))


def test_both_are_drawn_each_with_its_own_and_end_without_a_trace(bench: Bench) -> None:
    def where(layer: MapLayer, turn_rad: float) -> np.ndarray:
        return refit(MapFit(), layer.extent_xy, turn_rad).to_plate(layer.xy)

    before = [at(bench, plate).tolist() for plate in PLATES[:3]]
    title = bench.node("/map/title")["_data"]
    snapshot = two()
    bench.show(snapshot)
    bench.settle()
    other = snapshot.beside
    assert other is not None
    assert np.allclose(bench.dots()[:, :2], where(snapshot.map, snapshot.map_turn_rad), atol=0.02)
    assert np.allclose(bench.dots(plate="map_2")[:, :2], where(other.map, other.map_turn_rad), atol=0.02)
    for name in ("pose_cells_2/voxels", "map_2/arrow/body", "map_2/route", "pose_cells/voxels"):
        assert bench.visible(f"/{name}")
    assert bench.node("/map/title")["_data"] != title
    bench.show(fake_snapshot(431))
    assert [at(bench, plate).tolist() for plate in PLATES[:3]] == before
    assert not any(bench.visible(node) for node in ("/map_2/arrow/body", "/pose_cells_2/voxels"))
    assert bench.node("/map/title")["_data"] == title
    bench.show(two(440, 200))
    bench.settle()
    assert bench.visible("/map_2/arrow/body")


def test_it_costs_at_most_as_much_again(bench: Bench) -> None:
    """Bytes of what is sent for some seconds of driving, with one brain and with two that are as busy."""

    def size(message: object) -> int:
        told = getattr(message, "updates", None) or getattr(getattr(message, "props", None), "__dict__", {})
        return 60 + sum(getattr(v, "nbytes", len(v) if isinstance(v, bytes) else 8) for v in told.values())

    def bytes_for(beside: bool) -> int:
        bench.show(two(500, 500) if beside else fake_snapshot(500))
        bench.settle()
        before = len(bench.sent)
        for tick in range(501, 541):
            bench.show(two(tick, tick) if beside else fake_snapshot(tick), 0.1)
        return sum(size(message) for message in bench.sent[before:])

    both, alone = bytes_for(True), bytes_for(False)
    assert both < 2 * alone, (both, alone)


def test_the_first_ones_map_is_for_goals_and_the_other_one_says_so(bench: Bench) -> None:
    def click_on(plate: str) -> None:
        x, y, _ = at(bench, plate).tolist()
        bench.viewer.click(Click((x + 1.0, y, 20.0), (0.0, 0.0, -1.0), bench.told.append))
        bench.show(None)

    bench.show(two())
    click_on("map_2")
    assert bench.engine.commands == []
    assert bench.told[-1] == "No goal set: this is the other brain's map; the robot goes by the first one's"
    click_on("map")
    assert [type(command) for command in bench.engine.commands] == [SetGoal]


def test_without_an_office_the_boxes_stand_closer(bench: Bench) -> None:
    bench.show(replace(two(), world=None))
    assert abs(at(bench, "pose_cells")[0]) < 6.0
    bench.show(replace(fake_snapshot(431), world=None))
    assert at(bench, "map")[0] == -at(bench, "pose_cells")[0] == 5.85


def test_the_page_is_told_of_both_and_never_of_infinity() -> None:
    told = state(two())["beside"]
    assert (told["first"]["name"], told["second"]["off_m"]) == ("ours", None)
    assert told["differences"] == [{"kind": "view", "tick": 12, "time_s": 1.2, "words": "view #3 is seen as no view"}]
    assert b'"error_map_m":null' in to_json(told)
    assert told["changed"] == [{"name": "local_view.enabled", "first": True, "second": False}]
    assert state(fake_snapshot(3))["beside"] is None
