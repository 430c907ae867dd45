"""What is laid over office and map for people alone: the wheels' ghost, the true walls, error and doubt."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.crowded import FRAME, judged
from web.messages import Pose, Snapshot, TimeView
from web.viewer.fits.map_fit import DEPTH, WIDTH
from web.viewer.fits.poses import compose, into_map, placed
from web.viewer.marks.outline import clipped


@pytest.fixture
def bench(shared: Bench) -> Bench:
    for name in ("ghost", "outline", "doubt"):
        shared.switches.turn(name, True)
    shared.show(judged(), 10.0)
    shared.settle()
    return shared


def test_the_walls_lie_where_the_fit_puts_them(bench: Bench) -> None:
    snapshot, fit = judged(), bench.viewer._scenery.map.fit
    assert snapshot.world is not None
    wanted = fit.to_plate(into_map(np.asarray(snapshot.world.walls, np.float64).reshape(-1, 2), FRAME)).reshape(-1, 4)
    drawn = bench.drawn("/map/outline")[:, :, :2].reshape(-1, 4)
    inside = clipped(wanted, (WIDTH / 2, DEPTH / 2))
    assert len(drawn) == len(inside) > 10
    assert np.abs(drawn - inside).max() < 1 / 256


def test_the_ghost_stands_in_the_office_and_on_the_map(bench: Bench) -> None:
    snapshot, plates = judged(), bench.viewer._scenery
    ghost = snapshot.ghost
    assert ghost is not None
    office = compose(ghost.office_start, ghost.pose)
    at = plates.office.fit.to_plate(np.array([[office.x, office.y]]))[0]
    assert bench.visible("/office/ghost/body")
    assert bench.node("/office/ghost")["position"][:2] == pytest.approx(at.tolist(), abs=1e-5)
    on_map = plates.map.fit.to_plate(placed(np.array([[3.0, 0.0]]), ghost.map_start))[0]
    assert bench.node("/map/ghost")["position"][:2] == pytest.approx(on_map.tolist(), abs=1e-5)
    assert len(bench.drawn("/office/ghost_path")) > 3


def test_a_ghost_that_has_left_the_floor_leaves_its_name_at_the_edge(bench: Bench) -> None:
    far = replace(judged().ghost, pose=Pose(500.0, 0.0, 0.0))  # type: ignore[type-var]
    bench.show(replace(judged(), ghost=far), 5)
    bench.settle()
    assert not bench.visible("/office/ghost/body")
    x, y, _ = bench.node("/office/ghost_label")["position"]
    assert bench.visible("/office/ghost_label")
    assert abs(x) <= WIDTH / 2
    assert abs(y) <= DEPTH / 2 + 1


@pytest.mark.parametrize(("name", "nodes"), [("ghost", ["/office/ghost", "/map/ghost"]), ("doubt", ["/map/doubt"])])
def test_each_has_its_switch(bench: Bench, name: str, nodes: list[str]) -> None:
    assert all(bench.visible(node) for node in nodes)
    bench.switch(name, False)  # type: ignore[arg-type]
    assert not any(bench.visible(node) for node in nodes)


def test_the_outline_has_its_switch(bench: Bench) -> None:
    assert len(bench.drawn("/map/outline"))
    bench.switch("outline", False)
    assert not len(bench.drawn("/map/outline"))


def test_where_nobody_knows_the_truth_nothing_of_it_is_drawn(bench: Bench) -> None:
    bench.show(replace(fake_snapshot(430), truth=None, map_in_office=None, ghost=None, spread=None), 5)
    bench.settle()
    assert not len(bench.drawn("/map/outline"))
    assert not len(bench.drawn("/map/error"))
    for node in ("/map/ghost", "/office/ghost", "/map/doubt", "/map/true_place"):
        assert not bench.visible(node)


def test_the_error_is_a_line_from_the_estimate_to_the_true_place(bench: Bench) -> None:
    snapshot, fit = judged(), bench.viewer._scenery.map.fit
    assert snapshot.truth is not None
    (line,) = bench.drawn("/map/error")
    here = fit.to_plate(np.array([[snapshot.estimate.x, snapshot.estimate.y]]))[0]
    true = fit.to_plate(into_map(np.array([[snapshot.truth.x, snapshot.truth.y]]), FRAME))[0]
    assert np.abs(line[:, :2] - np.stack([here, true])).max() < 1 / 128
    assert bench.visible("/map/true_place")


def test_the_ellipse_has_the_axes_of_the_doubt(bench: Bench) -> None:
    node, fit = bench.node("/map/doubt"), bench.viewer._scenery.map.fit
    a, b, _ = node["scale"]
    assert a == pytest.approx(2 * 0.5 * fit.scale, abs=0.01)
    assert b == pytest.approx(2 * 0.25 * fit.scale, abs=0.01)
    half = math.atan2(node["wxyz"][3], node["wxyz"][0])
    assert math.remainder(2 * half - 0.3 - fit.turn_rad, math.tau) == pytest.approx(0.0, abs=0.01)


numbers = st.floats(-20, 20)


@settings(max_examples=150)
@given(st.lists(st.tuples(numbers, numbers, numbers, numbers), min_size=1, max_size=5), st.floats(0, 1))
def test_what_is_cut_off_is_what_lies_beside_the_floor(walls: list[tuple[float, ...]], share: float) -> None:
    """Any point of a wall that is well within the floor is on one of the pieces, and no piece leaves the floor."""
    half = (5.0, 4.0)
    whole = np.array(walls, np.float64)
    pieces = clipped(whole, half)
    ends = pieces.reshape(-1, 2)
    assert (np.abs(ends) <= np.array(half) + 1e-9).all()
    points = whole[:, :2] + share * (whole[:, 2:] - whole[:, :2])
    for point in points[(np.abs(points) < np.array(half) - 1e-6).all(1)]:
        along = pieces[:, 2:] - pieces[:, :2]
        length2 = np.maximum((along**2).sum(1), 1e-30)
        t = np.clip(((point - pieces[:, :2]) * along).sum(1) / length2, 0, 1)
        apart = np.hypot(*(pieces[:, :2] + t[:, None] * along - point).T)
        if np.hypot(*(whole[:, 2:] - whole[:, :2]).T).min() > 1e-9:
            assert apart.min(initial=np.inf) < 1e-6


def test_a_moment_that_was_sought_is_drawn_at_once(bench: Bench) -> None:
    """Whatever was drawn a moment ago: nothing waits for its turn, but for the occupancy, which is drawn beside the rest."""
    past = TimeView(past=True, end_tick=600, end_s=60.0, begin_s=0.0, branch=1, branches=(), loop=None)

    def sought(tick: int, off_m: float) -> Snapshot:
        return judged(tick, off_m, running=False, time=past)

    bench.show(sought(420, 0.0))
    bench.settle()
    bench.show(sought(380, 0.5), 0.05)
    now = bench.show(sought(300, 1.0), 0.05)
    assert any("ghost_path" in name for name in now)
    later = bench.show(None, 3.0)
    assert not [name for name in later if "occupancy" not in name]
