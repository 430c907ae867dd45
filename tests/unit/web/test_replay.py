"""A correction is played again on the map's plate, from before to after, and leaves everything else alone."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Closure, Snapshot
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.replay import AFTER_S, BEFORE_S, MOVES_S, share_at

EVENT = 77


@pytest.fixture
def bench(shared: Bench) -> Bench:
    shared.show(closing(), 10.0)
    shared.settle()
    return shared


def closing(time_s: float = 43.0) -> Snapshot:
    """Shortly after a loop was closed at the tenth experience, which moved half of the map."""
    plain = replace(fake_snapshot(430), time_s=time_s)
    n = len(plain.map.xy) // 2
    after = plain.map.xy[:n].copy()
    before = after + np.linspace(0, 1.3, n)[:, None].astype(np.float32) * np.array([1, 0], np.float32)
    links = plain.map.links[(plain.map.links < n).all(1)]
    return replace(plain, closures=(Closure(EVENT, 40.0, n - 1, 10, links, before, after, 1.3),))


def nodes(bench: Bench) -> np.ndarray:
    return bench.dots()[:, :2].astype(np.float64)


def place_of_ring(bench: Bench) -> tuple[float, float, float]:
    origin, at = bench.viewer._scenery.map.origin, bench.node("/map/closure_0")["position"]
    return origin[0] + at[0], origin[1] + at[1], origin[2] + NODE_Z


def test_a_closure_has_its_ring_where_the_loop_closed_and_says_how_far_it_moved_the_map(bench: Bench) -> None:
    snapshot, fit = closing(), bench.viewer._scenery.map.fit
    at = fit.to_plate(snapshot.map.xy[10:11])[0]
    assert bench.visible("/map/closure_0/ring")
    assert bench.node("/map/closure_0")["position"][:2] == pytest.approx(at.tolist(), abs=1 / 128)
    assert bench.viewer._scenery.map.closures._label._words == "loop closed: moved the map by 1.3 m"
    assert bench.visible("/map/closure_label")
    bench.show(closing(400.0), 5)
    bench.settle()
    assert bench.visible("/map/closure_0/ring")
    assert not bench.visible("/map/closure_label")  # later the ring alone


def test_it_goes_from_before_to_after_and_then_shows_the_map_as_it_is(bench: Bench) -> None:
    snapshot, fit, live = closing(), bench.viewer._scenery.map.fit, nodes(bench)
    closure = snapshot.closures[0]
    bench.viewer.replay(EVENT)
    bench.show(snapshot, 0.0)
    began_s, commands = bench.now_s, len(bench.engine.commands)
    seen: list[np.ndarray] = []
    for at_s in (0.1, BEFORE_S + MOVES_S / 2, BEFORE_S + MOVES_S + AFTER_S / 2):
        bench.show(replace(snapshot, tick=snapshot.tick + 1), began_s + at_s - bench.now_s)
        seen.append(nodes(bench))
        assert not bench.visible("/map/arrow")
    before, after = fit.to_plate(closure.before_xy), fit.to_plate(closure.after_xy)
    for drawn, wanted in zip(seen, (before, (before + after) / 2, after), strict=True):
        assert len(drawn) == len(wanted)
        assert np.abs(drawn - wanted).max() < 0.02
    assert len(bench.drawn("/map/replay")) > 100
    bench.show(snapshot, AFTER_S + 1.0)
    bench.settle()
    assert np.abs(nodes(bench) - live).max() < 0.01
    assert bench.visible("/map/arrow")
    assert not len(bench.drawn("/map/replay"))
    assert len(bench.engine.commands) == commands  # the session was told nothing


def test_a_click_on_the_ring_plays_it(bench: Bench) -> None:
    commands = len(bench.engine.commands)
    bench.click(place_of_ring(bench))
    bench.show(closing(), 0.2)
    assert bench.viewer._replay.runs
    assert len(bench.engine.commands) == commands
    bench.show(closing(), 10.0)
    bench.settle()


def test_without_rings_a_click_there_sets_a_goal(bench: Bench) -> None:
    ring = place_of_ring(bench)
    bench.switch("closures", False)
    assert not bench.visible("/map/closure_0")
    bench.click(ring)
    bench.show(closing(), 0.2)
    assert not bench.viewer._replay.runs
    assert bench.engine.commands[-1].type == "set_goal"
    bench.switch("closures", True)
    assert bench.visible("/map/closure_0")


def test_a_closure_that_is_no_longer_kept_plays_nothing(bench: Bench) -> None:
    bench.viewer.replay(EVENT + 1)
    bench.show(closing(), 0.2)
    assert not bench.viewer._replay.runs


def test_it_is_slow_at_both_ends_and_never_goes_back() -> None:
    shares = [share_at(s) for s in np.linspace(0, BEFORE_S + MOVES_S + AFTER_S, 200)]
    assert shares[0] == 0.0
    assert shares[-1] == 1.0
    assert all(b >= a for a, b in itertools.pairwise(shares))
