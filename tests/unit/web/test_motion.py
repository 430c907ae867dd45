"""What moves by itself, so that one sees why; it ends by itself, and a still viewer has none of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.test_replay import closing, runs
from web.messages import Snapshot
from web.viewer.camera_views import MAP_AT
from web.viewer.motion import FRESH_S, LIFT_S, REST_S, RUN_S

pytestmark = pytest.mark.slow


def at_speed(snapshot: Snapshot, speed: float) -> Snapshot:
    return replace(snapshot, running=True, speed=speed)


@pytest.mark.parametrize(("speed", "plays"), [(1.0, True), (8.0, False), (0.0, False)])
def test_a_new_correction_is_played_once_at_a_speed_at_which_one_watches(
    stage: Bench, speed: float, plays: bool
) -> None:
    snapshot = at_speed(closing(), speed)
    stage.show(replace(snapshot, closures=()), 10.0)
    stage.show(replace(snapshot, tick=snapshot.tick + 1), 0.1)
    stage.show(replace(snapshot, tick=snapshot.tick + 2), 2.0)
    assert runs(stage) == plays
    stage.show(replace(snapshot, tick=snapshot.tick + 3), 10.0)
    stage.show(replace(snapshot, tick=snapshot.tick + 4), 2.0)
    assert not runs(stage)


def test_a_new_goal_ends_a_correction_that_is_played_and_its_route_is_seen(stage: Bench) -> None:
    snapshot = at_speed(fake_snapshot(430), 1.0)
    assert snapshot.goal is not None
    (closure,) = closing().closures
    plain = replace(snapshot, goal=None, closures=())
    stage.show(plain, 10.0)
    stage.show(replace(plain, tick=plain.tick + 1, closures=(closure,)), 0.1)
    stage.show(replace(plain, tick=plain.tick + 2, closures=(closure,)), 1.0)
    assert runs(stage)
    stage.show(replace(plain, tick=plain.tick + 3, closures=(closure,), goal=snapshot.goal), 0.1)
    stage.show(replace(plain, tick=plain.tick + 4, closures=(closure,), goal=snapshot.goal), 0.2)
    assert not runs(stage)


def test_a_goal_that_moves_with_the_map_ends_no_correction_and_begins_no_dot_anew(stage: Bench) -> None:
    snapshot = at_speed(fake_snapshot(430), 1.0)
    goal, (closure,) = snapshot.goal, closing().closures
    assert goal is not None
    stage.show(replace(snapshot, closures=()), 10.0)
    stage.show(replace(snapshot, closures=()), RUN_S + REST_S)
    for k in range(1, 6):
        moved = replace(goal, x=goal.x + 0.01 * k, y=goal.y - 0.01 * k)
        stage.show(replace(snapshot, tick=snapshot.tick + k, closures=(closure,), goal=moved), 0.2)
        assert not stage.visible("/map/runner")
    assert runs(stage)


def test_the_map_stands_still_for_a_while_between_two_corrections(stage: Bench) -> None:
    """One that comes meanwhile is missed; the next one after it is played."""
    plain = at_speed(closing(), 1.0)
    (first,) = plain.closures
    closures = [replace(first, event=first.event + k) for k in range(3)]
    stage.show(replace(plain, closures=()), 10.0)
    played = []
    for k, wait_s in enumerate((0.1, REST_S / 2, REST_S)):
        stage.show(replace(plain, tick=plain.tick + 2 * k, closures=tuple(closures[:k])), wait_s)
        stage.show(replace(plain, tick=plain.tick + 2 * k + 1, closures=tuple(closures[: k + 1])), 0.1)
        stage.show(replace(plain, tick=plain.tick + 2 * k + 1, closures=tuple(closures[: k + 1])), 2.0)
        played.append(runs(stage))
    assert played == [True, False, True]


def test_who_has_not_looked_for_some_seconds_is_shown_no_correction(stage: Bench) -> None:
    snapshot = at_speed(closing(), 1.0)
    stage.show(replace(snapshot, closures=(), time_s=snapshot.time_s - 1.5 * FRESH_S), 10.0)
    stage.show(replace(snapshot, tick=snapshot.tick + 1), 0.1)
    stage.show(replace(snapshot, tick=snapshot.tick + 2), 2.0)
    assert not runs(stage)


def test_a_robot_that_is_carried_is_seen_to_be_lifted_and_put_down(stage: Bench) -> None:
    here = at_speed(fake_snapshot(430), 1.0)
    assert here.truth is not None
    stage.show(here, 10.0)
    stage.show(here, 1.0)
    start = np.array(stage.at("/office/robot"))
    there = replace(here, tick=here.tick + 1, truth=replace(here.truth, x=here.truth.x + 2.5))
    stage.show(there, 0.1)
    stage.show(there, LIFT_S / 2)
    between = np.array(stage.at("/office/robot"))
    assert between[2] > 1.0
    stage.show(there, LIFT_S)
    stage.show(there, 1.0)
    end = np.array(stage.at("/office/robot"))
    assert start[0] < between[0] < end[0]
    assert start[2] == end[2] == 0.0


def test_a_dot_runs_along_a_new_route_to_its_goal(stage: Bench) -> None:
    plain = fake_snapshot(430)
    assert plain.goal is not None
    stage.show(replace(plain, goal=None), 10.0)
    stage.show(replace(plain, tick=plain.tick + 1), 0.1)
    seen = []
    for _ in range(4):
        stage.show(replace(plain, tick=plain.tick + 1), RUN_S / 4)
        seen.append(np.array(stage.at("/map/runner")[:2]))
    way = stage.on_map(np.asarray(plain.goal.route_xy)) + MAP_AT
    assert np.hypot(*(way[-1] - seen[-1])) < 0.05 < np.hypot(*(way[-1] - seen[0]))
    stage.show(replace(plain, tick=plain.tick + 2), 0.5)
    assert not stage.visible("/map/runner")
