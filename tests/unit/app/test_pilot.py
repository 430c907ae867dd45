from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.pilot import Pilot, PilotParams, local_movement
from app.pilot.local_movement import LocalMovement
from app.pilot.route_following import LOOK_AROUND_S, LOST_S, NO_HEADWAY_S, REPLAN_S, RouteFollower, crosses
from ratslam_core import Odometry, Pose2
from sim2d import SONAR_ANGLES_RAD, Drive, Simulator, World, load_world
from sim2d.things import SlowZone
from tests.unit.ratslam_core import literal

from .worlds import EXACT, HandMadeMap, chain, room

DT = 0.1
ANGLES = np.array(SONAR_ANGLES_RAD)
FAR = np.full(8, 5.0, np.float32)
STILL = Odometry(0.0, 0.0, DT)
EXPLORING = {"following the wall", "crossing", "turning back to look"}


def a_pilot(seed: int = 0, **params: float) -> Pilot:
    return Pilot(PilotParams(**params), ANGLES, np.random.default_rng(seed))


class Run:
    """A pilot in a simulated room, on a map made by hand."""

    def __init__(self, simulator: Simulator, pilot: Pilot, map_: HandMadeMap | None = None) -> None:
        self.simulator, self.pilot = simulator, pilot
        self.map = map_ or HandMadeMap([(0.0, 0.0)], [])
        self.doing: Counter[str] = Counter()
        self.frame = simulator.observe()
        self.track: list[tuple[float, float]] = []
        self.bumps = 0

    def tick(self) -> None:
        frame = self.frame
        self.map.know(self.simulator)
        odometry = Odometry(frame.odometry_speed, frame.odometry_yaw_rate, frame.dt)
        speed, yaw_rate = self.pilot.step(frame.ranges_m, frame.bumped, odometry, self.map)  # type: ignore[arg-type]
        self.doing[self.pilot.doing] += 1
        self.frame = self.simulator.step(Drive(speed, yaw_rate))
        self.bumps += self.frame.bumped
        self.track.append((self.simulator.truth.x, self.simulator.truth.y))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            self.tick()

    @property
    def truth(self) -> tuple[float, float]:
        return self.simulator.truth.x, self.simulator.truth.y


# ---------------------------------------------------------------- getting free


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("heading", [math.pi, -2.4, -math.pi / 2])
def test_a_cornered_robot_frees_itself(heading: float, seed: int) -> None:
    """Pressed into a corner by a hand, then left alone: it is a metre away within a minute."""
    simulator = Simulator(room(start=(0.5, 0.5, heading)), EXACT, seed)
    for _ in range(20):
        simulator.step(Drive(0.3, 0.0))
    run = Run(simulator, a_pilot(seed))
    begin = run.truth
    run.run(60)
    assert max(math.dist(begin, place) for place in run.track) > 1.0


@pytest.mark.parametrize("seed", range(3))
def test_a_slow_floor_is_no_reason_to_back_off(seed: int) -> None:
    """On a floor where it is slow, exploring takes long, but the robot hardly ever frees itself of nothing."""
    world = room(start=(3.0, 2.0, 0.0))
    x, y, right, top = world.bounds
    zone = SlowZone("slippery", ((x, y), (right, y), (right, top), (x, top)), 0.3)
    run = Run(Simulator(replace(world, slow_zones=(zone,)), EXACT, seed), a_pilot(seed))
    run.run(240)
    assert run.doing["freeing itself"] < 0.1 * sum(run.doing.values())
    assert len({(int(x), int(y)) for x, y in run.track}) > 5


def test_bumped_and_getting_nowhere_it_backs_off_and_turns() -> None:
    pilot = a_pilot()
    map_ = HandMadeMap([(0.0, 0.0)], [])
    drives = [pilot.step(FAR, True, STILL, map_) for _ in range(45)]  # type: ignore[arg-type]
    backs = [k for k, (speed, _) in enumerate(drives) if speed < 0]
    assert backs[0] == pytest.approx(10, abs=1)  # a second of grace
    begin = backs[0]
    assert all(speed == -0.2 for speed, _ in drives[begin : begin + 10])
    assert all(speed == 0.0 and yaw != 0.0 for speed, yaw in drives[begin + 12 : begin + 25])
    turn = drives[begin][1]
    assert 0.5 <= abs(turn) <= 1.0
    assert {yaw for _, yaw in drives[begin : begin + 25]} == {turn}


def test_getting_nowhere_without_a_bump_takes_longer() -> None:
    pilot = a_pilot(stuck_s=3.0)
    map_ = HandMadeMap([(0.0, 0.0)], [])
    when = None
    for tick in range(60):
        pilot.step(FAR, False, STILL, map_)  # type: ignore[arg-type]
        if pilot.doing == "freeing itself":
            when = tick * DT
            break
    assert when == pytest.approx(3.0, abs=0.15)


def test_getting_ahead_is_not_being_stuck() -> None:
    pilot = a_pilot(stuck_s=3.0)
    map_ = HandMadeMap([(0.0, 0.0)], [])
    for _ in range(300):
        pilot.step(FAR, False, Odometry(0.3, 0.0, DT), map_)  # type: ignore[arg-type]
        assert pilot.doing != "freeing itself"


# ---------------------------------------------------------------- exploring


def test_exploring_follows_walls_crosses_and_looks_back() -> None:
    run = Run(
        Simulator(room(side=6.0, start=(3.0, 3.0, 0.0)), EXACT), a_pilot(look_back_after_m=8.0, cross_after_s=8.0)
    )
    run.run(240)
    for doing in EXPLORING:
        assert run.doing[doing] > 50
    assert run.doing["following the wall"] > 500
    cells = {(int(x / 1.5), int(y / 1.5)) for x, y in run.track}
    assert len(cells) >= 11  # of 16


@pytest.mark.parametrize("seed", range(3))
def test_the_wall_on_the_left_is_kept_at_its_distance(seed: int) -> None:
    pilot = a_pilot(seed, look_back_after_m=1000.0, cross_after_s=1e6)
    run = Run(Simulator(room(start=(2.0, 3.2 + 0.15 * seed, 0.0)), EXACT), pilot)
    run.run(10)
    left, walls = [], []
    for _ in range(600):
        run.tick()
        left.append(float(run.frame.ranges_m[0]))
        walls.append(min(*run.truth, 4 - run.truth[0], 4 - run.truth[1]))
    assert np.median(left) == pytest.approx(0.55, abs=0.15)
    assert min(walls) > 0.25
    angles = np.unwrap([math.atan2(y - 2, x - 2) for x, y in run.track[300:]])
    assert angles[-1] - angles[0] < -2 * math.pi  # clockwise around the room, the wall on its left


@pytest.mark.parametrize("seed", range(3))
def test_it_seldom_touches_anything(seed: int) -> None:
    run = Run(Simulator(load_world("office"), seed=seed), a_pilot(seed))
    run.run(150)
    assert run.bumps < 0.02 * 1500
    assert len({(int(x), int(y)) for x, y in run.track}) > 10  # of 80 square metres


def test_equal_pilots_do_the_same() -> None:
    runs = [Run(Simulator(room(start=(2.0, 2.0, 0.0)), EXACT, 3), a_pilot(3)) for _ in range(2)]
    other = Run(Simulator(room(start=(2.0, 2.0, 0.0)), EXACT, 3), a_pilot(4))
    for run in (*runs, other):
        run.run(60)
    assert runs[0].track == runs[1].track != other.track
    assert runs[0].pilot.digest() == runs[1].pilot.digest() != other.pilot.digest()


def test_a_crossing_that_cannot_be_turned_to_ends() -> None:
    """Wheels that report no turn do not keep it turning for ever."""
    pilot = a_pilot(cross_after_s=2.0, stuck_s=60.0)
    map_ = HandMadeMap([(0.0, 0.0)], [])
    seen = Counter()
    for _ in range(400):
        pilot.step(FAR, False, STILL, map_)  # type: ignore[arg-type]
        seen[pilot.doing] += 1
    assert seen["crossing"] > 20
    assert seen["following the wall"] > 20


# ---------------------------------------------------------------- local movement


def sensed(*echoes: tuple[float, float]) -> LocalMovement:
    """Obstacles at these places: bearing and distance."""
    local = LocalMovement(np.array([bearing for bearing, _ in echoes]))
    local.sense(np.array([distance for _, distance in echoes], np.float32), STILL)
    return local


def arc(speed: float, yaw_rate: float, seconds: float) -> list[tuple[float, float]]:
    pose, places = Pose2(0.0, 0.0, 0.0), []
    for _ in range(round(seconds / 0.02)):
        pose = pose.compose(Pose2(speed * 0.02, 0.0, yaw_rate * 0.02))
        places.append((pose.x, pose.y))
    return places


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.parametrize("bearing", [0.0, 0.5, -0.5, 1.2, -1.2, 3.0])
def test_free_floor_is_crossed_towards_the_target(
    bearing: float, interpreted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if interpreted:
        literal.interpret(local_movement, monkeypatch)
    local = sensed((0.0, 5.0))
    x, y = 1.5 * math.cos(bearing), 1.5 * math.sin(bearing)
    speed, yaw_rate = local.towards(x, y, 0.36, 1.0, 0.27)
    assert 0 <= speed <= 0.36
    assert abs(yaw_rate) <= 1.0
    if bearing == 0.0:
        assert (speed, yaw_rate) == (0.36, 0.0)
    else:
        assert math.copysign(1.0, yaw_rate) == math.copysign(1.0, bearing)
    if bearing == 3.0:
        assert speed <= 0.11  # what lies behind is turned to first


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_the_chosen_arc_keeps_clear_of_all_echoes(
    seed: int, interpreted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if interpreted:
        literal.interpret(local_movement, monkeypatch)
    rng = np.random.default_rng(seed)
    for _ in range(6 if interpreted else 60):
        echoes = [(float(b), float(d)) for b, d in zip(rng.uniform(-2, 2, 8), rng.uniform(0.3, 1.5, 8), strict=True)]
        local = sensed(*echoes)
        speed, yaw_rate = local.towards(*rng.uniform(-1, 1, 2), 0.36, 1.0, 0.27)
        places = arc(speed, yaw_rate, 1.2)
        nearest = min(math.dist(p, (d * math.cos(b), d * math.sin(b))) for p in places for b, d in echoes)
        assert nearest > 0.27 - 0.03


def test_a_wall_close_ahead_is_turned_from() -> None:
    wall = sensed(*[(b, 0.3 / math.cos(b)) for b in (-1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.2)])
    speed, yaw_rate = wall.towards(1.0, 0.0, 0.36, 1.0, 0.27)
    assert speed == 0.0
    assert abs(yaw_rate) >= 0.5


@pytest.mark.parametrize("interpreted", [False, True])
def test_the_free_way_is_the_distance_less_the_clearance(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(local_movement, monkeypatch)
    local = sensed((0.0, 1.0), (math.pi / 2, 0.5), (3.0, 2.0))
    assert local.free_way(0.0, 0.27) == pytest.approx(0.73)
    assert local.free_way(math.pi / 2, 0.27) == pytest.approx(0.23)
    assert local.free_way(-math.pi / 2, 0.27) == pytest.approx(1.6)
    assert local.free_way(3.0, 0.27) == pytest.approx(1.6)  # farther than it cares
    assert sensed((0.0, 0.1)).free_way(0.0, 0.27) == 0.0


@pytest.mark.parametrize("interpreted", [False, True])
def test_echoes_are_carried_along_and_forgotten(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(local_movement, monkeypatch)
    local = LocalMovement(np.array([0.0, 0.7]))
    local.sense(np.array([1.2, 5.0], np.float32), STILL)
    nothing = np.array([5.0, 5.0], np.float32)
    for _ in range(10):  # half a metre ahead
        local.sense(nothing, Odometry(0.5, 0.0, DT))
    assert local.free_way(0.0, 0.2) == pytest.approx(0.5, abs=1e-6)
    for _ in range(10):  # a quarter turn to the left: now it is on the right
        local.sense(nothing, Odometry(0.0, math.pi / 2, DT))
    assert local.free_way(-math.pi / 2, 0.2) == pytest.approx(0.5, abs=1e-6)
    assert local.free_way(0.0, 0.2) == pytest.approx(1.6)
    for _ in range(30):  # three seconds later
        local.sense(nothing, STILL)
    assert local.free_way(-math.pi / 2, 0.2) == pytest.approx(1.6)
    local.sense(np.array([0.4, 5.0], np.float32), STILL)
    assert local.free_way(0.0, 0.2) < 1.0
    local.forget()
    assert local.free_way(0.0, 0.2) == pytest.approx(1.6)


# ---------------------------------------------------------------- the hand


def test_driven_by_hand_until_told_otherwise() -> None:
    pilot = a_pilot()
    map_ = HandMadeMap([(0.0, 0.0)], [])
    pilot.drive(0.2, -0.5)
    assert pilot.mode == "manual"
    near = np.full(8, 0.25, np.float32)
    for _ in range(100):  # it neither avoids nor frees itself: the hand knows better
        assert pilot.step(near, True, STILL, map_) == (0.2, -0.5)  # type: ignore[arg-type]
        assert pilot.doing == "driven by hand"
    pilot.drive(0.0, 0.0)
    assert pilot.step(FAR, False, STILL, map_) == (0.0, 0.0)  # type: ignore[arg-type]
    assert pilot.doing == "waiting for the hand"
    pilot.drive(0.2, 0.0)
    pilot.set_mode("explore")
    pilot.step(FAR, False, STILL, map_)  # type: ignore[arg-type]
    assert pilot.doing in EXPLORING
    pilot.set_mode("manual")
    assert pilot.step(FAR, False, STILL, map_) == (0.0, 0.0)  # type: ignore[arg-type]


def test_modes_and_goals() -> None:
    pilot = a_pilot()
    map_ = HandMadeMap(*chain((0.0, 0.0), (3.0, 0.0)))
    with pytest.raises(ValueError, match="there is no goal to go to; set one first"):
        pilot.set_mode("goal")
    assert (pilot.mode, pilot.goal, pilot.goal_state, pilot.progress(map_)) == ("explore", None, None, None)  # type: ignore[arg-type]
    pilot.set_goal(12)
    assert (pilot.mode, pilot.goal, pilot.goal_state) == ("goal", 12, (12, "tracking"))
    pilot.drive(0.1, 0.0)
    assert pilot.goal == 12  # the hand interrupts; the goal stays
    pilot.set_mode("goal")
    assert pilot.mode == "goal"
    pilot.cancel_goal()
    assert (pilot.mode, pilot.goal) == ("explore", None)
    pilot.drive(0.1, 0.0)
    pilot.cancel_goal()
    assert pilot.mode == "manual"


# ---------------------------------------------------------------- routes


def test_a_route_is_followed_to_the_goal() -> None:
    """Around a wall with a gap: along the links, not as the crow flies."""
    world = room((2.0, 0.0, 2.0, 2.8), start=(1.0, 0.6, 0.0))
    map_ = HandMadeMap(*chain((1.0, 0.6), (1.0, 3.4), (3.0, 3.4), (3.0, 0.6)))
    run = Run(Simulator(world, EXACT), a_pilot(), map_)
    goal = len(map_) - 1
    run.pilot.set_goal(goal)
    for _ in range(600):
        run.tick()
        if run.pilot.goal_state == (goal, "arrived"):
            break
    assert run.pilot.goal_state == (goal, "arrived")
    assert math.dist(run.truth, (3.0, 0.6)) < 0.35
    length = sum(math.dist(a, b) for a, b in pairwise(run.track))
    assert 6.5 < length < 9.0  # the links are 7.6 m long
    assert run.bumps == 0
    here = run.truth
    run.run(3)
    assert run.pilot.doing == "at the goal"
    assert math.dist(here, run.truth) < 0.05
    progress = run.pilot.progress(map_)  # type: ignore[arg-type]
    assert progress is not None
    assert (progress.state, progress.eta_s, progress.remaining_m, len(progress.route)) == ("arrived", 0.0, 0.0, 0)


def test_progress_counts_down_along_the_links() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (4.0, 0.0), (4.0, 2.0)))
    goal = len(map_) - 1
    follower = RouteFollower(goal)
    etas, remaining = [], []
    for x in (0.0, 1.0, 2.0, 3.0, 4.0):
        map_.robot = Pose2(x, 0.1, 0.0)
        for _ in range(11):
            assert follower.step(map_, DT, PilotParams()) is not None  # type: ignore[arg-type]
        progress = follower.progress(map_)  # type: ignore[arg-type]
        assert progress.state == "tracking"
        assert progress.route[-1] == goal
        assert len(progress.route) == len(progress.arrival_s)
        assert np.all(np.diff(progress.arrival_s) > 0)
        etas.append(progress.eta_s)
        remaining.append(progress.remaining_m)
    assert etas == pytest.approx([(6.0 - x) / 0.3 for x in range(5)], abs=2.1)
    assert remaining == pytest.approx([6.1 - x for x in range(5)], abs=0.3)


def test_the_robot_heads_for_a_point_ahead_on_the_route() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (4.0, 0.0)))
    for heading in (0.0, 1.0, -2.5, math.pi):
        map_.robot = Pose2(1.0, 0.2, heading)
        target = RouteFollower(len(map_) - 1).step(map_, DT, PilotParams(lookahead_m=0.6))  # type: ignore[arg-type]
        assert target is not None
        there = map_.robot.compose(Pose2(*target, 0.0))
        assert there.y == pytest.approx(0.0, abs=1e-9)
        assert 1.6 <= there.x <= 2.3


def test_the_quickest_of_two_ways_is_taken() -> None:
    places, links = chain((0.0, 0.0), (4.0, 0.0))
    middle = len(places)
    map_ = HandMadeMap([*places, (2.0, 2.0)], [*links, (0, middle), (middle, middle - 1)])
    for quick, expected in ((False, False), (True, True)):
        map_.link_times[-2:] = 3.0 if quick else 30.0
        follower = RouteFollower(middle - 1)
        follower.step(map_, DT, PilotParams())  # type: ignore[arg-type]
        assert (middle in follower.progress(map_).route) is expected  # type: ignore[arg-type]


def test_a_brand_new_experience_is_left_by_way_of_a_near_one() -> None:
    """Active, alone, and not linked to anything yet."""
    places, links = chain((0.0, 0.0), (3.0, 0.0))
    map_ = HandMadeMap([*places, (0.3, 0.35)], links)
    map_.robot = Pose2(0.3, 0.34, 0.0)
    assert map_.active == len(places)
    follower = RouteFollower(len(places) - 1)
    assert follower.step(map_, DT, PilotParams()) is not None  # type: ignore[arg-type]
    assert follower.state == "tracking"


def test_a_lost_route_is_coasted_on_then_given_up() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    params = PilotParams(coast_s=4.0)
    follower = RouteFollower(len(map_) - 1)
    states = []
    for tick in range(400):
        if tick == 20:
            map_.links, map_.link_times = map_.links[:0], map_.link_times[:0]
        map_.robot = Pose2(min(0.03 * tick, 1.5), 0.0, 0.0)
        target = follower.step(map_, DT, params)  # type: ignore[arg-type]
        states.append(follower.state)
        assert (target is None) == (follower.state in ("exploring", "unreachable"))
        progress = follower.progress(map_)  # type: ignore[arg-type]
        assert (progress.eta_s is None) == (progress.remaining_m is None) == (target is None)
    seconds = {state: states.count(state) * DT for state in set(states)}
    order = list(dict.fromkeys(states))
    assert order == ["tracking", "coasting", "exploring", "unreachable"]
    assert seconds["tracking"] + seconds["coasting"] == pytest.approx(2 + 4, abs=REPLAN_S + 0.2)
    assert seconds["exploring"] == pytest.approx(LOST_S, abs=0.2)


def test_an_unreachable_goal_is_explored_for_and_reached_when_a_way_is_found() -> None:
    places, links = chain((0.0, 0.0), (3.0, 0.0))
    gap = [link for link in links if link != (5, 6)]
    map_ = HandMadeMap(places, gap)
    pilot = a_pilot()
    pilot.set_goal(len(places) - 1)
    for _ in range(round(LOST_S / DT) + 10):
        pilot.step(FAR, False, Odometry(0.3, 0.0, DT), map_)  # type: ignore[arg-type]
        assert pilot.doing in EXPLORING
    assert pilot.goal_state == (len(places) - 1, "unreachable")
    map_.links = np.array(links)
    map_.link_times = np.full(len(links), 0.8)
    for _ in range(round(2 * REPLAN_S / DT)):
        pilot.step(FAR, False, Odometry(0.3, 0.0, DT), map_)  # type: ignore[arg-type]
    assert pilot.goal_state == (len(places) - 1, "tracking")
    assert pilot.doing == "following the route"


def test_coasting_is_said() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    pilot = a_pilot()
    pilot.set_goal(len(map_) - 1)
    pilot.step(FAR, False, STILL, map_)  # type: ignore[arg-type]
    assert pilot.doing == "following the route"
    map_.links, map_.link_times = map_.links[:0], map_.link_times[:0]
    for _ in range(25):
        pilot.step(FAR, False, Odometry(0.3, 0.0, DT), map_)  # type: ignore[arg-type]
    assert pilot.doing == "coasting on the old route"


@pytest.mark.parametrize("seed", range(3))
def test_a_blocked_way_is_left(seed: int) -> None:
    """The map takes for a way what is a wall: the robot looks around instead of pushing for ever."""
    world = room((2.0, 0.0, 2.0, 3.0), start=(1.0, 0.6, 0.0))
    map_ = HandMadeMap(*chain((1.0, 0.6), (3.0, 0.6)))
    run = Run(Simulator(world, EXACT, seed), a_pilot(seed), map_)
    run.pilot.set_goal(len(map_) - 1)
    goal = len(map_) - 1
    while run.pilot.goal_state == (goal, "tracking"):
        run.tick()
        assert len(run.track) < 10 * (6 * NO_HEADWAY_S)
    assert len(run.track) > 10 * NO_HEADWAY_S
    assert run.pilot.goal_state == (goal, "exploring")
    before = Counter(run.doing)
    while run.pilot.goal_state == (goal, "exploring"):
        run.tick()
        assert len(run.track) < 10 * (6 * NO_HEADWAY_S + 60)  # it may have to free itself from the corner first
    looked = run.doing - before
    assert sum(looked[doing] for doing in EXPLORING) > 10 * (LOOK_AROUND_S - 2)
    assert run.pilot.goal_state in ((goal, "tracking"), (goal, "arrived"))  # and tries again


def two_ways() -> tuple[World, list[tuple[float, float]], list[tuple[int, int]]]:
    """A wall between the robot and its goal with a door that is shut, which three rows of links pass, and a way round."""
    world = room((2.0, 0.0, 2.0, 3.0), start=(1.0, 0.6, 0.0))
    places, links = chain((1.0, 0.6), (3.0, 0.6))
    goal = len(places) - 1
    for y in (0.3, 0.95):
        more, joined = chain((1.2, y), (2.8, y))
        links += [(i + len(places), j + len(places)) for i, j in joined]
        links += [(1, len(places)), (len(places) + len(more) - 1, goal - 1)]
        places += more
    more, joined = chain((0.8, 0.8), (0.8, 3.5), (3.2, 3.5), (3.2, 0.7))
    links += [(i + len(places), j + len(places)) for i, j in joined]
    links += [(0, len(places)), (len(places) + len(more) - 1, goal)]
    return world, places + more, links


@pytest.mark.parametrize("seed", range(3))
def test_a_door_that_was_shut_is_given_up(seed: int) -> None:
    """Every way through it fails with it, not one after the other, and the robot goes round."""
    world, places, links = two_ways()
    map_ = HandMadeMap(places, links)
    map_.patience = 4
    goal = round(2.0 / 0.25)
    run = Run(Simulator(world, EXACT, seed), a_pilot(seed), map_)
    run.pilot.set_goal(goal)
    while run.pilot.goal_state != (goal, "arrived"):
        run.tick()
        assert len(run.track) < 10 * 120
    truth = run.simulator.truth
    assert math.hypot(truth.x - places[goal][0], truth.y - places[goal][1]) < 0.4
    gone = {tuple(link) for link in links} - {(int(i), int(j)) for i, j in map_.links}
    assert gone
    for i, j in gone:
        assert max(places[i][1], places[j][1]) < 1.5  # nothing of the way round
    assert {(i, j) for i, j, well in map_.trials if well} - gone  # and what was driven has been a trial, too


def test_what_was_driven_of_a_route_was_a_trial() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    follower = RouteFollower(len(map_) - 1)
    for tick in range(150):
        map_.robot = Pose2(0.03 * tick, 0.0, 0.0)
        follower.step(map_, DT, PilotParams())  # type: ignore[arg-type]
    tried = {(i, j) for i, j, _ in map_.trials}
    assert all(well for _, _, well in map_.trials)
    assert len(tried) >= 8  # of the 18 that were driven; a plan may begin beyond the end of the one before
    assert tried <= {(k, k + 1) for k in range(18)}


@settings(max_examples=200)
@given(st.lists(st.tuples(*[st.floats(-2, 2)] * 4), max_size=8), st.tuples(*[st.floats(-2, 2)] * 4))
def test_crossing_a_bar_is_what_points_on_both_lines_are(lines, bar) -> None:
    """By solving for where the two lines meet."""
    ends = np.array(lines).reshape(-1, 4)
    found = crosses(np.array(bar).reshape(2, 2), ends[:, :2], ends[:, 2:])
    for (ax, ay, bx, by), answer in zip(ends, found, strict=True):
        along = np.array([[bx - ax, bar[0] - bar[2]], [by - ay, bar[1] - bar[3]]])
        if abs(along[0, 0] * along[1, 1] - along[0, 1] * along[1, 0]) < 1e-6:
            continue  # parallel, or no length
        t, u = np.linalg.solve(along, np.array([bar[0] - ax, bar[1] - ay]))
        if min(abs(t), abs(t - 1), abs(u), abs(u - 1)) > 1e-6:  # not just touching
            assert bool(answer) is bool(0 < t < 1 and 0 < u < 1)


def test_headway_is_no_reason_to_look_around() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (20.0, 0.0)))
    follower = RouteFollower(len(map_) - 1)
    for tick in range(600):
        map_.robot = Pose2(0.03 * tick, 0.0, 0.0)
        follower.step(map_, DT, PilotParams())  # type: ignore[arg-type]
        assert follower.state == "tracking"


def test_close_by_and_not_getting_nearer_is_there() -> None:
    """At a goal in a corner where the robot just does not fit."""
    map_ = HandMadeMap(*chain((0.0, 0.0), (3.0, 0.0)))
    params = PilotParams(arrival_m=0.3)
    for away, arrives in ((0.5, True), (0.7, False)):
        follower = RouteFollower(len(map_) - 1)
        map_.robot = Pose2(3.0 - away, 0.0, 0.0)
        for _ in range(80):
            follower.step(map_, DT, params)  # type: ignore[arg-type]
        assert (follower.state == "arrived") is arrives
    assert follower.step(map_, DT, params) is not None  # type: ignore[arg-type]
