"""What is laid over office and map for people alone: the wheels' ghost, the true walls, error and doubt."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.crowded import FRAME, judged
from web.messages import Pose, Snapshot, TimeView
from web.viewer.fits import DEPTH, WIDTH, MapFit, OfficeFit, compose, into_map, placed, refit
from web.viewer.marks.judged import clipped

NOW: Any = judged()
GHOST, WORLD, TRUTH = NOW.ghost, NOW.world, NOW.truth
FIT = refit(MapFit(), NOW.map.extent_xy, NOW.map_turn_rad)
OFFICE_FIT = OfficeFit(WORLD.bounds)


@pytest.fixture
def bench(shared: Bench) -> Bench:
    for name in ("ghost", "outline", "doubt"):
        shared.switches.turn(name, True)
    shared.show(NOW, 10.0)
    shared.settle()
    return shared


def test_walls_and_error_lie_where_the_fit_puts_them_and_the_ellipse_has_the_axes_of_the_doubt(bench: Bench) -> None:
    walls = into_map(np.asarray(WORLD.walls, np.float64).reshape(-1, 2), FRAME)
    inside = clipped(FIT.to_plate(walls).reshape(-1, 4), (WIDTH / 2, DEPTH / 2))
    drawn = bench.drawn("/map/outline")[:, :, :2].reshape(-1, 4)
    assert len(drawn) == len(inside) > 10
    assert np.abs(drawn - inside).max() < 1 / 256

    (line,) = bench.drawn("/map/error")
    ends = np.vstack([(NOW.estimate.x, NOW.estimate.y), into_map(np.array([[TRUTH.x, TRUTH.y]]), FRAME)])
    assert np.abs(line[:, :2] - FIT.to_plate(ends)).max() < 1 / 128
    assert bench.visible("/map/true_place")

    node = bench.node("/map/doubt")
    half = math.atan2(node["wxyz"][3], node["wxyz"][0])
    assert node["scale"][:2] == pytest.approx((2 * 0.5 * FIT.scale, 2 * 0.25 * FIT.scale), abs=0.01)
    assert math.remainder(2 * half - 0.3 - FIT.turn_rad, math.tau) == pytest.approx(0.0, abs=0.01)


def test_the_ghost_stands_in_the_office_and_on_the_map_and_leaves_its_name_at_the_edge(bench: Bench) -> None:
    in_office = compose(GHOST.office_start, GHOST.pose)
    for node, (at,) in (
        ("/office/ghost", OFFICE_FIT.to_plate(np.array([[in_office.x, in_office.y]]))),
        ("/map/ghost", FIT.to_plate(placed(np.array([[3.0, 0.0]]), GHOST.map_start))),
    ):
        assert bench.visible(f"{node}/body")
        assert bench.node(node)["position"][:2] == pytest.approx(at.tolist(), abs=1e-5)
    assert len(bench.drawn("/office/ghost_path")) > 3

    bench.show(replace(NOW, ghost=replace(GHOST, pose=Pose(500.0, 0.0, 0.0))), 5)
    bench.settle()
    assert [bench.visible(f"/office/{node}") for node in ("ghost/body", "ghost_label")] == [False, True]
    x, y, _ = bench.node("/office/ghost_label")["position"]
    assert (abs(x) <= WIDTH / 2, abs(y) <= DEPTH / 2 + 1) == (True, True)


def test_each_has_its_switch_and_where_nobody_knows_the_truth_nothing_of_it_is_drawn(bench: Bench) -> None:
    frames = {
        "ghost": ("/office/ghost", "/office/ghost_label", "/map/ghost", "/map/ghost_label"),
        "doubt": ("/map/doubt", "/map/true_place", "/map/error_label"),
    }
    lines = {"ghost": ("/office/ghost_path", "/map/ghost_path"), "doubt": ("/map/error",), "outline": ("/map/outline",)}

    def shown(name: str) -> set[bool]:
        drawn = {len(bench.drawn(node)) > 0 for node in lines[name]}
        return drawn | {bench.visible(node) for node in frames.get(name, ())}

    for name in ("ghost", "outline", "doubt"):
        assert shown(name) == {True}
        bench.switch(name, False)
        assert shown(name) == {False}
    for name in ("ghost", "outline", "doubt"):
        bench.switch(name, True)
        assert shown(name) == {True}
    bench.show(replace(fake_snapshot(430), truth=None, map_in_office=None, ghost=None, spread=None), 5)
    bench.settle()
    assert shown("ghost") | shown("doubt") | shown("outline") == {False}


numbers = st.floats(-20, 20)


@settings(max_examples=100)
@given(st.lists(st.tuples(numbers, numbers, numbers, numbers), min_size=1, max_size=5), st.floats(0, 1))
def test_what_is_cut_off_is_what_lies_beside_the_floor(walls: list[tuple[float, ...]], share: float) -> None:
    """Any point of a wall that is well within the floor is on one of the pieces, and no piece leaves the floor."""
    half, whole = np.array((5.0, 4.0)), np.array(walls, np.float64)
    pieces = clipped(whole, (5.0, 4.0))
    assert (np.abs(pieces.reshape(-1, 2)) <= half + 1e-9).all()
    along = pieces[:, 2:] - pieces[:, :2]
    points = whole[:, :2] + share * (whole[:, 2:] - whole[:, :2])
    long = np.hypot(*(whole[:, 2:] - whole[:, :2]).T) > 1e-9
    for point in points[(np.abs(points) < half - 1e-6).all(1) & long]:
        t = np.clip(((point - pieces[:, :2]) * along).sum(1) / np.maximum((along**2).sum(1), 1e-30), 0, 1)
        assert np.hypot(*(pieces[:, :2] + t[:, None] * along - point).T).min(initial=np.inf) < 1e-6


def test_a_moment_that_was_sought_is_drawn_at_once(bench: Bench) -> None:
    """Whatever was drawn a moment ago: nothing waits for its turn, but for the occupancy, which is drawn beside the rest."""
    past = TimeView(past=True, end_tick=600, end_s=60.0, begin_s=0.0, branch=1, branches=(), loop=None)

    def sought(tick: int, off_m: float) -> Snapshot:
        return judged(tick, off_m, running=False, time=past)

    bench.show(sought(420, 0.0))
    bench.settle()
    bench.show(sought(380, 0.5), 0.05)
    assert any("ghost_path" in name for name in bench.show(sought(300, 1.0), 0.05))
    assert not [name for name in bench.show(None, 3.0) if "occupancy" not in name]
