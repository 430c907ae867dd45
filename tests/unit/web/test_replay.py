"""A correction is played again on the map's plate, from before to after, and leaves everything else alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from web.messages import Closure, Snapshot
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.replay import AFTER_S, BEFORE_S, MOVES_S, share_at

EVENT = 77


def closing(time_s: float = 43.0) -> Snapshot:
    """Shortly after a loop was closed at the tenth experience, which moved half of the map."""
    plain = replace(fake_snapshot(430), time_s=time_s, speed=8.0)  # at which nothing moves by itself
    n = len(plain.map.xy) // 2
    after = plain.map.xy[:n].copy()
    before = after + np.linspace(0, 1.3, n)[:, None].astype(np.float32) * np.array([1, 0], np.float32)
    links = plain.map.links[(plain.map.links < n).all(1)]
    return replace(plain, closures=(Closure(EVENT, 40.0, n - 1, 10, links, before, after, 1.3),))


@pytest.fixture
def moment() -> Snapshot:
    return closing()


def nodes(stage: Bench) -> np.ndarray:
    return stage.dots()[:, :2].astype(np.float64)


def runs(stage: Bench) -> bool:
    """Whether a correction is played: then the ways that experiences go are drawn."""
    return len(stage.drawn("/map/replay")) > 0


def press_ring(stage: Bench) -> None:
    """A click on the ring of the closure; a correction that it starts has then begun to move."""
    x, y, z = stage.at("/map/closure_0")
    stage.click((x, y, z + NODE_Z))
    stage.show(closing(), 0.2)
    stage.show(closing(), BEFORE_S + 0.5)


def test_a_closure_has_its_ring_where_the_loop_closed_and_says_how_far_it_moved_the_map(stage: Bench) -> None:
    at = stage.on_map(closing().map.xy[10:11])[0]
    assert stage.node("/map/closure_0")["position"][:2] == pytest.approx(at.tolist(), abs=1 / 128)
    assert stage.says("/map/closure_label", "loop closed: moved the map by 1.3 m")
    assert stage.visible("/map/closure_0/ring")
    assert stage.visible("/map/closure_label")
    stage.show(closing(400.0), 5)
    stage.settle()
    assert stage.visible("/map/closure_0/ring")
    assert not stage.visible("/map/closure_label")  # later the ring alone


def test_it_goes_from_before_to_after_and_then_shows_the_map_as_it_is(stage: Bench) -> None:
    snapshot, live = closing(), nodes(stage)
    stage.viewer.replay(EVENT)
    stage.show(snapshot, 0.0)
    began_s, seen = stage.now_s, []
    for at_s in (0.1, BEFORE_S + MOVES_S / 2, BEFORE_S + MOVES_S + AFTER_S / 2):
        stage.show(replace(snapshot, tick=snapshot.tick + 1), began_s + at_s - stage.now_s)
        seen.append(nodes(stage))
        assert not stage.visible("/map/arrow")
    before, after = (stage.on_map(xy) for xy in (snapshot.closures[0].before_xy, snapshot.closures[0].after_xy))
    for drawn, wanted in zip(seen, (before, (before + after) / 2, after), strict=True):
        assert drawn.shape == wanted.shape
        assert np.abs(drawn - wanted).max() < 0.02
    assert len(stage.drawn("/map/replay")) > 100
    stage.show(snapshot, AFTER_S + 1.0)
    stage.settle()
    assert np.abs(nodes(stage) - live).max() < 0.01
    assert stage.visible("/map/arrow")
    assert not runs(stage)
    assert stage.engine.commands == []  # the session was told nothing


def test_a_click_on_the_ring_plays_it_and_without_rings_sets_a_goal(stage: Bench) -> None:
    press_ring(stage)
    assert (runs(stage), stage.engine.commands) == (True, [])
    stage.show(closing(), 10.0)
    stage.settle()
    stage.switch("closures", False)
    assert not stage.visible("/map/closure_0")
    press_ring(stage)
    assert (runs(stage), [command.type for command in stage.engine.commands]) == (False, ["set_goal"])
    stage.switch("closures", True)
    assert stage.visible("/map/closure_0")


def test_a_closure_that_is_no_longer_kept_plays_nothing(stage: Bench) -> None:
    stage.viewer.replay(EVENT + 1)
    stage.show(closing(), 0.2)
    stage.show(closing(), BEFORE_S + 0.5)
    assert not runs(stage)


def test_it_is_slow_at_both_ends_and_never_goes_back() -> None:
    shares = [share_at(s) for s in np.linspace(0, BEFORE_S + MOVES_S + AFTER_S, 200)]
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert shares == sorted(shares)
