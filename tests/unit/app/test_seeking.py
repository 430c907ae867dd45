"""Trips that the robot makes of its own: into openings, back to old ground, to where it has not been for long."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot import PilotParams
from sim2d import Simulator

from .pilots import EXPLORING, Run, a_pilot
from .worlds import EXACT, HandMadeMap, chain, room

TRIPS = {"going where the map is thin", "going back to known ground"}


def a_run(map_: HandMadeMap, *walls: tuple[float, float, float, float], **params: float) -> Run:
    world = room(*walls, side=8.0, start=(*map_.poses[-1, :2], 0.0))
    run = Run(Simulator(world, EXACT, 1), a_pilot(1, **params), map_)
    run.tick()
    return run


def test_without_seeking_it_only_wanders() -> None:
    run = a_run(HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0))), seek=False)
    run.run(200)
    assert set(run.doing) <= EXPLORING | {"freeing itself"}


def test_it_goes_where_open_floor_was_seen() -> None:
    """All experiences lie on one side of the room; those in the middle have seen far to the other side."""
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, openings_every=1)
    ground = run.pilot._seeker.ground
    ground._seen_m[: ground.count] = 1.0
    ground._seen_m[10:14, 3:5] = 5.0  # ahead, that is along x
    run.run(4.0)
    begin = len(run.track)
    while run.pilot.doing not in TRIPS:
        run.tick()
        assert len(run.track) < begin + 200
    while run.pilot.doing in TRIPS:
        run.tick()
        assert len(run.track) < begin + 600
    x, y = run.truth
    assert x > 2.5
    assert abs(y - (1.0 + 11.5 * 0.25)) < 1.5
    assert len(ground.openings(map_.poses, run.pilot.params)[0]) == 0  # it does not go there twice


def test_on_new_ground_for_long_it_goes_back() -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, return_after_m=10.0)
    ground = run.pilot._seeker.ground
    ground.now_s, ground.new_m = 1000.0, 50.0
    ground._made_s[:] = 990.0
    ground._made_s[:12], ground._last_s[:12] = 0.0, 800.0  # old ground: the lower part of the first wall
    ground._last_s[12:] = 999.0
    while run.pilot.doing not in TRIPS:
        run.tick()
        assert len(run.track) < 200
    assert run.pilot.doing == "going back to known ground"
    while run.pilot.doing in TRIPS | {"freeing itself"}:
        run.tick()
        assert len(run.track) < 1200
    assert ground.new_m == 0.0
    assert math.dist(run.truth, map_.poses[11, :2]) < 0.7


def test_with_nothing_new_it_goes_where_it_has_not_been_for_longest() -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, openings_every=2)
    ground = run.pilot._seeker.ground
    ground.now_s = 1000.0
    ground._last_s[: ground.count] = 900.0
    ground._last_s[7] = 100.0
    while run.pilot.doing not in TRIPS:
        run.tick()
        assert len(run.track) < 200
    while run.pilot.doing in TRIPS | {"freeing itself"}:
        run.tick()
        assert len(run.track) < 1200
    assert math.dist(run.truth, map_.poses[7, :2]) < 0.7
    assert ground.last_s[7] > 1000.0
    near = np.hypot(*(map_.poses[:, :2] - map_.poses[7, :2]).T) < PilotParams().place_reach_m
    assert (ground.last_s[near] > 1000.0).all()  # all experiences of the place, whichever way they face


@pytest.mark.parametrize("order", ["goal", "hand"])
def test_an_order_ends_the_trip(order: str) -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, long_ago_s=0.0)
    while run.pilot.doing not in TRIPS:
        run.tick()
        assert len(run.track) < 200
    if order == "goal":
        run.pilot.set_goal(3)
    else:
        run.pilot.drive(0.0, 0.0)
    run.tick()
    assert run.pilot.doing not in TRIPS
    run.pilot.cancel_goal()
    run.pilot.set_mode("explore")
    run.tick()
    assert run.pilot.doing in EXPLORING
