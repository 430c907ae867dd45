"""Trips that the robot makes of its own: into openings, back to old ground, to where it has not been for long."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot import PilotParams
from app.pilot.route_following import RouteFollower
from ratslam_core import Pose2
from sim2d import Simulator

from .pilots import EXPLORING, OUTWARD, Run, a_pilot
from .worlds import EXACT, HandMadeMap, chain, room

NEAR_ONLY = {"far_openings": False, "loop_share": 0.0}  # no far openings, no loops
TRIPS = {"going where the map is thin", "going back to known ground"}


def a_run(map_: HandMadeMap, *walls: tuple[float, float, float, float], **params: float) -> Run:
    world = room(*walls, side=8.0, start=(*map_.poses[-1, :2], 0.0))
    run = Run(Simulator(world, EXACT, 1), a_pilot(1, **(OUTWARD | params)), map_)
    run.tick()
    return run


def test_without_seeking_it_only_wanders() -> None:
    run = a_run(HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0))), seek=False)
    run.run(200)
    assert set(run.doing) <= EXPLORING | {"freeing itself"}


def test_it_goes_where_open_floor_was_seen() -> None:
    """All experiences lie on one side of the room; those in the middle have seen far to the other side."""
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, openings_every=1, **NEAR_ONLY)
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
    assert len(ground.openings(map_, run.pilot.params, 3)[0]) == 0  # it does not go there twice


def test_a_door_post_in_the_way_is_driven_round() -> None:
    """A beam passes a door where the robot would touch its post. Such trips used to end in the door, for good."""
    map_ = HandMadeMap(*chain((2.3, 1.0), (2.3, 2.0)))
    map_.landed = 2
    run = a_run(map_, (3.0, 0.0, 3.0, 2.4), (3.0, 3.6, 3.0, 8.0), **NEAR_ONLY)
    seeker = run.pilot._seeker
    seeker._choose(map_, run.pilot._local, run.frame.ranges_m, run.pilot.params)  # type: ignore[arg-type]
    seeker.follower = RouteFollower(len(map_) - 1, run.pilot._bars)
    seeker._opening = Pose2(2.2, 0.95, 0.0)
    for _ in range(250):
        run.tick()
        if seeker.follower is None:
            break
    assert math.dist(run.truth, (4.5, 2.95)) < 0.6


def test_far_openings_are_sought_one_after_the_other() -> None:
    """In a long corridor, of which it knows the first metres, it goes on and on, in the middle, and does not wander."""
    map_ = HandMadeMap(*chain((0.5, 1.2), (3.0, 1.2)))
    walls = [(0.0, 0.0, 20.0, 0.0), (0.0, 3.0, 20.0, 3.0)]
    world = room(*walls, side=20.0, start=(3.0, 1.2, 0.0))
    run = Run(Simulator(world, EXACT, 1), a_pilot(1, seek_after_s=1.0, far_look_back_m=1000.0, **OUTWARD), map_)
    run.tick()
    run.pilot._seeker.ground._seen_m[:] = 1.0
    for _ in range(450):
        here = run.truth
        if math.dist(here, map_.poses[-1, :2]) > 0.25:
            map_.make(*here, run.simulator.truth.heading_rad)
        run.tick()
    assert run.truth[0] > 9.0
    assert run.doing["going where the map is thin"] > 400
    assert all(abs(y - 1.5) < 0.5 for x, y in run.track if x > 6.0)


def test_near_openings_and_old_places_come_after_the_far_ones() -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0)))
    run = a_run(map_, seek_after_s=1.0)
    ground = run.pilot._seeker.ground
    ground._seen_m[: ground.count] = 1.0
    ground._seen_m[4:8, 3:5] = 2.5  # a near opening
    ground._seen_m[18:22, 3:5] = 5.0  # a far one
    run.run(3.0)
    assert run.pilot._seeker.follower is not None
    assert run.pilot._seeker.follower.goal in range(18, 22)


def test_the_one_near_home_is_preferred() -> None:
    """Two far openings about as far from the robot: it takes that nearer to where the map began."""
    for home_share, expected in ((2.0, range(4, 8)), (0.0, range(17, 21))):
        map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0)))
        run = Run(
            Simulator(room(side=8.0, start=(1.0, 4.3, 0.0)), EXACT, 1),
            a_pilot(1, seek_after_s=0.5, home_share=home_share, **OUTWARD),
            map_,
        )
        run.tick()
        ground = run.pilot._seeker.ground
        ground._seen_m[: ground.count] = 1.0
        ground._seen_m[4:8, 3:5] = ground._seen_m[17:21, 3:5] = 5.0
        while run.pilot._seeker.follower is None:
            run.tick()
            assert len(run.track) < 100
        assert run.pilot._seeker.follower.goal in expected


def test_it_dares_twice_as_far_each_time_it_comes_back() -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    drift = map_.params.odometry_drift
    for dares, most_m, new_m, goes_back in (
        (1.0, 1e4, 26.0, True),
        (1.0, 1e4, 24.0, False),
        (4.0, 1e4, 99.0, False),
        (4.0, 1e4, 101.0, True),
        (512.0, 100.0, 101.0, True),
        (512.0, 100.0, 99.0, False),
    ):
        run = a_run(map_, seek_after_s=1.0, return_sigma_m=most_m * drift)
        seeker = run.pilot._seeker
        seeker.ground.now_s, seeker.ground.new_m, seeker._dares = 1000.0, new_m, dares
        seeker.ground._made_s[:], seeker.ground._last_s[:] = 990.0, 999.0
        seeker.ground._made_s[:12], seeker.ground._last_s[:12] = 0.0, 800.0
        times = map_.temporal_map.times_to(map_.active)
        assert np.isfinite(times).all()
        seeker._choose(map_, run.pilot._local, run.frame.ranges_m, run.pilot.params)  # type: ignore[arg-type]
        assert seeker.returning == goes_back


def test_on_new_ground_for_long_it_goes_back() -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, return_after_m=10.0, **NEAR_ONLY)
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
    run = a_run(map_, seek_after_s=5.0, openings_every=2, **NEAR_ONLY)
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


@pytest.mark.parametrize("search", [True, False])
def test_on_an_island_it_goes_into_every_opening(search: bool) -> None:
    """It has been on new ground for long, and this is a trip to an old place; but it has lost the rest of its map."""
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, seek_after_s=1.0, openings_every=2, search=search, **NEAR_ONLY)
    seeker = run.pilot._seeker
    ground = seeker.ground
    ground.now_s, ground.new_m = 1000.0, 100.0
    ground._made_s[:] = ground._last_s[:] = 0.0
    ground._last_s[: ground.count] = 990.0
    ground._seen_m[: ground.count] = 1.0
    ground._seen_m[35:39, 6:8] = 5.0  # to the right
    for landed, goes_into in ((30, search), (2, False), (10**9, False)):  # beside a large island, a tiny one, none
        map_.landed = landed
        seeker.stop()
        seeker._trips = 0
        seeker._choose(map_, run.pilot._local, run.frame.ranges_m, run.pilot.params)  # type: ignore[arg-type]
        assert (seeker._opening is not None) == goes_into
        assert seeker.returning == (not goes_into)


def test_on_an_island_it_begins_where_that_began() -> None:
    """Of two openings the one near the island's first experience is taken, though the other lies nearer to the robot."""
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    map_.landed = 30
    for home, chosen in ((0.0, 37), (5.0, 31)):
        run = a_run(map_, seek_after_s=1.0, search_home=home, **NEAR_ONLY)
        seeker = run.pilot._seeker
        seeker.ground._seen_m[: seeker.ground.count] = 1.0
        for row in (31, 37):
            seeker.ground._seen_m[row, 6:8] = 5.0  # to the right
        run.tick()
        seeker._choose(map_, run.pilot._local, run.frame.ranges_m, run.pilot.params)  # type: ignore[arg-type]
        assert seeker.follower is not None
        assert seeker.follower.goal == chosen


@pytest.mark.parametrize("small", [True, False])
def test_in_a_small_map_every_trip_goes_into_an_opening(small: bool) -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, openings_every=2, small_map_s=60.0 if small else 10.0, **NEAR_ONLY)
    seeker, into = run.pilot._seeker, []
    seeker.ground.now_s = 1000.0
    seeker.ground._last_s[: seeker.ground.count] = 100.0
    seeker.ground._seen_m[: seeker.ground.count] = 1.0
    seeker.ground._seen_m[10:14, 3:5] = 5.0  # ahead, that is along x
    for _ in range(4):
        seeker._choose(map_, run.pilot._local, run.frame.ranges_m, run.pilot.params)  # type: ignore[arg-type]
        into.append(seeker._opening is not None)
        seeker.stop()
    assert into == ([True] * 4 if small else [False, True, False, True])


@pytest.mark.parametrize("order", ["goal", "hand"])
def test_an_order_ends_the_trip(order: str) -> None:
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    run = a_run(map_, seek_after_s=5.0, long_ago_s=0.0, **NEAR_ONLY)
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
