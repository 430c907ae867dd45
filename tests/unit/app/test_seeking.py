"""Trips that the robot makes of its own: into openings, back to old ground, to where it has not been for long."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot.known_ground import PLACE_REACH_M, THIN_M, KnownGround
from app.pilot.opening import REACH_M, STEP_M, STILL_S, Opening
from app.pilot.params import PilotParams
from app.pilot.route_following import RouteFollower
from app.pilot.seeking import WANDER_S
from ratslam_core import Pose2
from sim2d import Simulator

from .pilots import EXPLORING, Run, a_pilot
from .worlds import EXACT, HandMadeMap, chain, room

USUAL = PilotParams()
NO_LOOPS = {"loop_share": 0.0}
TRIPS = {"going where the map is thin", "going back to known ground"}
AHEAD, RIGHT = slice(3, 5), slice(6, 8)  # sonars
Wall = tuple[float, float, float, float]


def one_side() -> HandMadeMap:
    """All experiences lie at one side of the room, and face it."""
    return HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0)))


def two_sides() -> HandMadeMap:
    return HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))


def a_run(
    map_: HandMadeMap, *walls: Wall, start: tuple[float, float] | None = None, side: float = 8.0, **params: float
) -> Run:
    """After its first tick, at the map's last place unless told otherwise; about to choose a trip."""
    x, y = map_.poses[-1, :2] if start is None else start
    run = Run(Simulator(room(*walls, side=side, start=(x, y, 0.0)), EXACT, 1), a_pilot(1, **params), map_)
    run.tick()
    run.pilot._seeker.stop()
    run.pilot._seeker._wander_s = WANDER_S
    return run


def ground_of(run: Run, *openings: tuple[slice, slice, float]) -> KnownGround:
    """What it knows of its experiences: little was seen from them, but for these rows, by these sonars, as far."""
    ground = run.pilot._seeker.ground
    ground._seen_m[: ground.count] = 1.0
    for rows, sonars, metres in openings:
        ground._seen_m[rows, sonars] = metres
    return ground


def chosen(run: Run) -> int | None:
    """Where it decides to go, now."""
    seeker = run.pilot._seeker
    seeker._choose(run.map, run.pilot._local, run.frame.ranges_m, run.pilot.params)  # type: ignore[arg-type]
    return None if seeker.follower is None else seeker.follower.goal


def to_a_trip(run: Run) -> str:
    """Until one begins; returns what it is doing."""
    while run.pilot.doing not in TRIPS:
        run.tick()
        assert len(run.track) < 200
    return run.pilot.doing


def to_its_end(run: Run) -> None:
    while run.pilot.doing in TRIPS | {"freeing itself"}:
        run.tick()
        assert len(run.track) < 1200


def test_without_seeking_it_only_wanders() -> None:
    run = a_run(one_side(), seek=False)
    run.run(200)
    assert set(run.doing) <= EXPLORING | {"freeing itself"}


def test_it_goes_where_open_floor_was_seen() -> None:
    """All experiences lie on one side of the room; those in the middle have seen far to the other side."""
    run = a_run(one_side(), **NO_LOOPS)
    run.pilot._explorer._far = 0.0  # it has looked behind itself
    ground = ground_of(run, (slice(10, 14), AHEAD, 5.0))
    to_a_trip(run)
    place = run.pilot._seeker.target(run.map)  # type: ignore[arg-type]
    assert place is not None
    to_its_end(run)
    x, y = run.truth
    assert x > 2.5
    assert abs(y - (1.0 + 11.5 * 0.25)) < 1.5
    left = ground.openings(run.map)[1]  # type: ignore[arg-type]
    assert np.hypot(*(left - place).T).min() > THIN_M  # not there twice; on from there, where it looks


def test_a_door_post_in_the_way_is_driven_round() -> None:
    """A beam passes a door where the robot would touch its post. Such trips used to end in the door, for good."""
    map_ = HandMadeMap(*chain((2.3, 1.0), (2.3, 2.0)))
    map_.landed = 2
    run = a_run(map_, (3.0, 0.0, 3.0, 2.4), (3.0, 3.6, 3.0, 8.0), **NO_LOOPS)
    seeker = run.pilot._seeker
    seeker.follower, seeker._trip_most_s = RouteFollower(len(map_) - 1, run.pilot._bars), 60.0
    seeker._last_leg = Opening(len(map_) - 1, Pose2(2.2, 0.95, 0.0))
    while seeker.follower is not None and len(run.track) < 250:
        run.tick()
    assert math.dist(run.truth, (4.5, 2.95)) < 0.6


def test_what_it_comes_no_nearer_to_is_given_up() -> None:
    map_, opening, aims = HandMadeMap([(0.0, 0.0)], []), Opening(0, Pose2(3.0, 0.0, 0.0)), 0
    while map_.robot.x < 1.0:  # slowly, but nearer and nearer
        map_.robot = Pose2(map_.robot.x + 1.1 * STEP_M, 0.0, 0.0)
        for _ in range(round(STILL_S / 0.2)):
            assert opening.aim(map_, 0.1, USUAL) == pytest.approx((3.0 - map_.robot.x, 0.0))  # type: ignore[arg-type]
    while opening.aim(map_, 0.1, USUAL) is not None:  # type: ignore[arg-type]
        aims += 1
    assert aims == pytest.approx(STILL_S / 0.2, abs=2)
    map_.robot = Pose2(3.0 - 0.9 * REACH_M, 0.0, 0.0)
    assert Opening(0, Pose2(3.0, 0.0, 0.0)).aim(map_, 0.1, USUAL) is None  # type: ignore[arg-type]


def test_while_there_is_an_opening_it_does_not_wander() -> None:
    """In a long corridor, of which it knows the first metres, it goes on and on."""
    map_ = HandMadeMap(*chain((0.5, 1.2), (3.0, 1.2)))
    run = a_run(map_, (0.0, 3.0, 20.0, 3.0), side=20.0, far_look_back_m=1000.0)
    run.pilot._explorer._far = 0.0  # it has looked behind itself
    ground_of(run)
    for _ in range(450):
        here = run.truth
        if math.dist(here, map_.poses[-1, :2]) > 0.1:
            map_.make(*here, run.simulator.truth.heading_rad)
        run.tick()
    assert run.truth[0] > 9.0
    assert run.doing["going where the map is thin"] > 350


def test_before_it_first_goes_to_new_ground_it_looks_behind_itself() -> None:
    """Where it began nobody has looked the other way: half of a corridor would never be an opening."""
    run = a_run(one_side(), **NO_LOOPS)
    ground_of(run, (slice(10, 14), AHEAD, 5.0))
    run.run(150)
    assert run.doing["turning back to look"] > 60


def test_of_two_openings_the_one_with_more_new_ground_for_the_way_is_taken() -> None:
    """The niche is nearer, the hall is worth the way; of two halls the nearer one."""
    for far, expected in ((range(4, 16), range(4, 16)), (range(4, 7), range(19, 22))):
        run = a_run(one_side(), start=(1.0, 5.5), **NO_LOOPS)
        ground_of(run, (slice(far.start, far.stop), AHEAD, 5.0), (slice(19, 22), AHEAD, 5.0))
        assert chosen(run) in expected
        assert run.pilot._seeker.reason.startswith("new ground, ")


def test_where_a_trip_did_not_get_to_the_next_does_not_go() -> None:
    """The map has a way where there is a wall. It used to set out for what lay there again and again, for hours."""
    run = a_run(two_sides(), (4.0, 0.0, 4.0, 8.0), **NO_LOOPS)
    run.pilot._explorer._far = 0.0  # it has looked behind itself
    ground = ground_of(run, (slice(30, 33), RIGHT, 5.0), (slice(10, 14), AHEAD, 5.0))
    goal, seeker = chosen(run), run.pilot._seeker
    assert goal in range(30, 33)
    while not ground.missed._places:
        run.tick()
        assert len(run.track) < 1500
    assert ground.missed._places == [(goal, 0.0, 0.0)]
    seeker.stop()
    assert chosen(run) in range(10, 14)


def test_where_odometry_may_be_far_off_it_goes_back() -> None:
    map_ = two_sides()
    for most_m, new_m in ((1.0, 101.0), (100.0, 101.0), (100.0, 99.0)):
        run = a_run(map_, return_sigma_m=most_m * map_.params.odometry_drift)
        seeker, ground = run.pilot._seeker, run.pilot._seeker.ground
        ground.now_s, ground.new_m = 1000.0, new_m
        ground._made_s[:], ground._last_s[:] = 990.0, 999.0
        ground._made_s[:12], ground._last_s[:12] = 0.0, 800.0
        chosen(run)
        assert seeker.returning == (new_m > most_m)
        assert seeker.reason.startswith("back to known ground: off by up to") == seeker.returning


def test_on_new_ground_for_long_it_goes_back() -> None:
    run = a_run(two_sides(), return_sigma_m=0.5, **NO_LOOPS)
    ground = run.pilot._seeker.ground
    ground.now_s, ground.new_m = 1000.0, 50.0
    ground._made_s[:], ground._last_s[12:] = 990.0, 999.0
    ground._made_s[:12], ground._last_s[:12] = 0.0, 800.0  # old ground: the lower part of the first wall
    assert to_a_trip(run) == "going back to known ground"
    to_its_end(run)
    assert ground.new_m == 0.0
    assert math.dist(run.truth, run.map.poses[11, :2]) < 0.7


def test_before_it_came_to_anything_again_it_goes_back_to_where_it_began() -> None:
    """Nothing was known ground then, and the robot drove 230 m into a suburb."""
    run = a_run(two_sides(), return_sigma_m=0.5, **NO_LOOPS)
    ground = run.pilot._seeker.ground
    ground.now_s, ground.new_m = 1000.0, 50.0
    ground._made_s[: ground.count] = ground._last_s[: ground.count] = np.linspace(100.0, 990.0, ground.count)
    assert to_a_trip(run) == "going back to known ground"
    assert run.pilot._seeker.follower is not None
    assert run.pilot._seeker.follower.goal == 0


def test_with_nothing_new_it_goes_where_it_has_not_been_for_longest() -> None:
    run = a_run(two_sides(), **NO_LOOPS)
    ground, places = run.pilot._seeker.ground, run.map.poses[:, :2]
    ground.now_s = 1000.0
    ground._last_s[: ground.count] = 900.0
    ground._last_s[7] = 100.0
    to_a_trip(run)
    to_its_end(run)
    assert math.dist(run.truth, places[7]) < 0.7
    near = np.hypot(*(places - places[7]).T) < PLACE_REACH_M
    assert (ground.last_s[near] > 1000.0).all()  # all experiences of the place, whichever way they face


def test_carried_on_a_trip_it_leaves_that_at_once() -> None:
    """It drove on for up to 25 s to where the place would lie if the submaps lay as they happen to."""
    run = a_run(one_side(), **NO_LOOPS)
    run.pilot._explorer._far = 0.0  # it has looked behind itself
    ground_of(run, (slice(10, 14), AHEAD, 5.0))
    to_a_trip(run)
    follower = run.pilot._seeker.follower
    assert follower is not None
    assert follower.goal < run.map.active
    run.map.landed = run.map.active  # this and all after it lie on a submap of their own now
    run.tick()
    assert run.pilot._seeker.follower is not follower


def test_on_a_submap_it_does_not_go_back() -> None:
    """It has been on new ground for long, but it has lost the rest of its map: a large submap, not a tiny one."""
    run = a_run(two_sides(), **NO_LOOPS)
    seeker, ground = run.pilot._seeker, ground_of(run, (slice(35, 39), RIGHT, 5.0))
    ground.now_s, ground.new_m = 1000.0, 100.0
    ground._made_s[:] = ground._last_s[:] = 0.0
    ground._last_s[: ground.count] = 990.0
    for run.map.landed, goes_back in ((30, False), (2, True), (10**9, True)):
        seeker.stop()
        chosen(run)
        assert seeker.returning == goes_back
        assert (seeker._last_leg is not None) != goes_back


def test_on_a_submap_it_begins_where_that_began() -> None:
    """Of two openings the one near the submap's first experience is taken, though the other lies nearer to the robot."""
    map_ = two_sides()
    map_.link_times /= 2
    for map_.landed, expected in ((10**9, range(36, 39)), (30, range(30, 33))):
        run = a_run(map_, **NO_LOOPS)
        ground_of(run, (slice(30, 33), RIGHT, 5.0), (slice(36, 39), RIGHT, 5.0))
        run.tick()
        assert chosen(run) in expected


def test_an_order_ends_the_trip() -> None:
    for order in (lambda pilot: pilot.set_goal(3), lambda pilot: pilot.drive(0.0, 0.0)):
        run = a_run(two_sides(), **NO_LOOPS)
        ground_of(run).now_s = 1000.0
        to_a_trip(run)
        order(run.pilot)
        run.tick()
        assert run.pilot.doing not in TRIPS
        run.pilot.cancel_goal()
        run.pilot.set_mode("explore")
        run.pilot._seeker._wait_s = WANDER_S
        run.tick()
        assert run.pilot.doing in EXPLORING
