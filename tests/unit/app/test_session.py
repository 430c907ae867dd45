from __future__ import annotations

import math
import re
from itertools import pairwise

import numpy as np
import pytest

from app.chronicle import PLACES_EVERY_S, SERIES_POINTS, Chronicle
from app.config import Config
from app.pilot.pilot import BEHAVIOURS
from app.session import PARTS, Session, is_lost, spread_goals
from app.snapshots import STRONGEST, Snapshots
from ratslam_core import Packet, Pose2
from sim2d import World, load_world
from web.messages import Snapshot

OFFICE = load_world("office")


def a_session(ticks: int = 0, seed: int = 3, world: World = OFFICE, config: Config | None = None) -> Session:
    session = Session(world, seed, config)
    for _ in range(ticks):
        session.tick()
    return session


# ---------------------------------------------------------------- the loop


def test_a_tick_is_a_tenth_of_a_second() -> None:
    session = a_session()
    assert (session.tick_count, session.time_s) == (0, 0.0)
    assert session.estimate.created  # it has looked around already
    for tick in range(1, 31):
        session.tick()
        assert session.tick_count == tick
        assert session.time_s == pytest.approx(tick / 10)
    assert session.evaluation.path_m > 0.5
    timings = session.stopwatch.mean_and_worst_ms
    assert list(timings) == list(PARTS)
    assert all(0 < mean <= worst for mean, worst in timings.values())


def test_links_remember_what_the_pilot_was_doing() -> None:
    session = a_session()
    learnt: dict[tuple[int, int], int] = {}
    for _ in range(400):
        before = session.brain.experience_map.link_count
        session.tick()
        if session.brain.experience_map.link_count > before:
            i, j = session.brain.experience_map.links[-1]
            learnt[int(i), int(j)] = BEHAVIOURS[session.pilot.doing]
    map_ = session.brain.experience_map
    assert {(int(i), int(j)): int(b) for (i, j), b in zip(map_.links, map_.behaviours, strict=True)} == learnt
    assert set(learnt.values()) >= {BEHAVIOURS["following the wall"], BEHAVIOURS["turning back to look"]}
    session.set_mode("manual")
    session.tick()
    assert session.pilot.behaviour == 0  # it waits
    session.pilot.drive(0.1, 0.0)
    session.tick()
    assert session.pilot.behaviour == BEHAVIOURS["driven by hand"]


def test_equal_runs_have_equal_hashes_and_others_not() -> None:
    one, two, other_seed = a_session(150), a_session(150), a_session(150, seed=4)
    assert one.state_hash() == two.state_hash()
    assert one.state_hash() == one.state_hash()
    assert one.state_hash() != other_seed.state_hash()
    two.tick()
    assert one.state_hash() != two.state_hash()
    one.tick()
    assert one.state_hash() == two.state_hash()
    two.pilot.drive(0.1, 0.0)
    assert one.state_hash() != two.state_hash()
    other_config = a_session(151, config=Config().with_value("pose_cells.inhibit", 4e-4))
    assert one.state_hash() != other_config.state_hash()


@pytest.mark.parametrize("front_end", ["complex cells", "hue and saturation", "scene numbers"])
def test_each_front_end_maps_the_office(front_end: str) -> None:
    """Known places are known again and nothing is far off; what is pictured is what the front end sees."""
    session = a_session(1200, config=Config().with_value("local_view.front_end", front_end))
    map_error, _ = session.evaluation.errors(session.brain.experience_map)
    assert map_error < 1.5
    assert len(session.brain.experience_map) > 100
    assert session.brain.experience_map.closures > 0
    senses = build(snapshots(session)).senses
    assert senses.front_end == front_end
    assert senses.best is not None
    assert senses.seen.shape[2:] == senses.best.shape[2:] == ((3,) if front_end == "hue and saturation" else ())
    assert senses.threshold == session.brain.local_view.front_end.threshold(session.config.local_view)
    if front_end == "scene numbers":
        assert senses.seen_words == f"scene {session.frame.scene}"


def test_the_true_pose_stays_out_of_a_brain_that_sees_images(monkeypatch: pytest.MonkeyPatch) -> None:
    for front_end in ("template", "scene numbers"):
        session = a_session(5, config=Config().with_value("local_view.front_end", front_end))
        told = []
        step = session.brain.step
        monkeypatch.setattr(
            session.brain, "step", lambda *a, f=step, t=told, **k: (t.append(k["scene"]), f(*a, **k))[1]
        )
        session.tick()
        assert told == [session.frame.scene if front_end == "scene numbers" else None]


@pytest.mark.parametrize("order", ["kidnap", "goal", "mode", "parameter"])
def test_equal_orders_keep_runs_equal(order: str) -> None:
    runs = []
    for _ in range(2):
        session = a_session(60)
        if order == "kidnap":
            session.kidnap()
        elif order == "goal":
            session.set_goal(0.0, 0.0)
        elif order == "mode":
            session.set_mode("manual")
        else:
            assert session.set_parameter("robot.gyro_bias", 0.02)
        for _ in range(60):
            session.tick()
        runs.append(session.state_hash())
    assert runs[0] == runs[1]
    assert runs[0] != a_session(120).state_hash()


# ---------------------------------------------------------------- orders


def test_a_goal_is_the_nearest_experience() -> None:
    session = a_session(100)
    poses = session.brain.experience_map.poses
    for x, y in ((0.0, 0.0), (1.0, 0.2), tuple(poses[-1, :2] + 0.3)):
        goal = session.set_goal(float(x), float(y))
        assert goal == np.argmin(np.hypot(poses[:, 0] - x, poses[:, 1] - y))
        assert session.pilot.goal == goal
        assert session.pilot.mode == "goal"


@pytest.mark.parametrize("place", [(40.0, 0.0), (0.0, -30.0), (math.nan, 0.0), (0.0, math.inf)])
def test_a_goal_off_the_map_is_refused(place: tuple[float, float]) -> None:
    session = a_session(50)
    with pytest.raises(
        ValueError, match=r"is off the map: the nearest experience is .* m away, at \(.*\); choose a place"
    ):
        session.set_goal(*place)
    assert session.pilot.goal is None
    assert session.pilot.mode == "explore"


def test_a_kidnap_moves_the_robot_and_tells_nobody() -> None:
    session = a_session(50)
    believed = session.brain.experience_map.robot
    session.kidnap(7.0, 7.4, 1.0)
    truth = session.simulator.truth
    assert (truth.x, truth.y, truth.heading_rad) == pytest.approx((7.0, 7.4, 1.0))
    assert session.brain.experience_map.robot == believed
    assert session.frame.odometry_speed == 0.0
    assert [k.at_s for k in session.evaluation.kidnaps] == [5.0]
    session.kidnap(9.0, 1.0)
    assert session.simulator.truth.heading_rad == pytest.approx(1.0)  # kept
    places = set()
    for _ in range(5):
        session.kidnap()
        truth = session.simulator.truth
        assert session.simulator.free_space.is_free(truth.x, truth.y)
        places.add((truth.x, truth.y))
    assert len(places) == 5
    session.kidnap(heading_rad=0.5)
    assert session.simulator.truth.heading_rad == pytest.approx(0.5)
    session.tick()


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ((5.0, 0.1, 0.0), r"from walls\[0\] \(wall\); the robot needs 0\.22 m"),
        ((11.0, 4.0, 0.0), "is outside of office"),
        ((math.nan, 4.0, 0.0), "is not a place"),
        ((5.0, 4.0, math.inf), "heading must be finite"),
        ((5.0, None, 0.0), "a kidnap needs both x and y, or neither"),
        ((None, 5.0, None), "a kidnap needs both x and y, or neither"),
    ],
)
def test_a_kidnap_that_cannot_be_changes_nothing(place: tuple, reason: str) -> None:
    session = a_session(20)
    before = session.state_hash()
    with pytest.raises(ValueError, match=reason):
        session.kidnap(*place)
    assert session.state_hash() == before
    assert session.evaluation.kidnaps == []


def test_the_mode_goal_needs_a_goal() -> None:
    session = a_session()
    with pytest.raises(ValueError, match="there is no goal to go to"):
        session.set_mode("goal")
    session.set_mode("manual")
    session.tick()
    assert session.pilot.doing == "waiting for the hand"


def test_live_parameters_act_at_once_others_wait() -> None:
    session = a_session(10)
    assert session.set_parameter("local_view.match_threshold", 9)
    assert session.brain.local_view.params.match_threshold == 9.0
    assert session.set_parameter("experience_map.sweeps", 3)
    assert session.brain.experience_map.params.sweeps == 3
    assert session.set_parameter("pose_cells.inhibit", 5e-4)
    assert session.brain.pose_cells.params.inhibit == 5e-4
    assert session.set_parameter("robot.light", 0.7)
    assert session.simulator.params.light == 0.7
    assert session.set_parameter("pilot.cruise_speed", 0.2)
    assert session.pilot.params.cruise_speed == 0.2
    assert not session.set_parameter("pose_cells.n_x", 32)
    assert session.brain.pose_cells.shape == (36, 64, 64)
    assert session.config.pose_cells.n_x == 32
    assert session.set_parameter("pose_cells.inhibit", 4e-4)  # though another waits
    assert session.brain.pose_cells.params.inhibit == 4e-4
    assert session.set_parameter("robot.light", 0.8)
    session.tick()
    anew = Session(OFFICE, 3, session.config)
    assert anew.brain.pose_cells.shape == (36, 64, 32)
    assert anew.brain.local_view.params.match_threshold == 9.0


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("pilot.cruise", 0.2, "unknown parameter 'pilot.cruise'; expected one of: pilot.cruise_speed"),
        ("nothing", 1, "unknown parameter 'nothing'"),
        ("pilot.cruise_speed", 3.0, "pilot.cruise_speed must be between 0.05 and 0.5 m/s, got 3.0"),
        ("pilot.cruise_speed", "fast", "pilot.cruise_speed must be float, got 'fast'"),
        ("pose_cells.carry", 1, "pose_cells.carry must be bool, got 1"),
        ("robot.light", math.nan, "robot.light must be from 0.1 to 2, got nan"),
    ],
)
def test_a_parameter_that_cannot_be_is_refused(name: str, value: object, message: str) -> None:
    session = a_session()
    config, before = session.config, session.state_hash()
    with pytest.raises(ValueError, match=re.escape(message)):
        session.set_parameter(name, value)  # type: ignore[arg-type]
    assert session.config is config
    assert session.state_hash() == before


def test_goals_are_spread_over_the_map() -> None:
    session = a_session(600)
    poses = session.brain.experience_map.poses[:, :2]
    goals = spread_goals(session, 4)
    assert len(set(goals)) == 4
    robot = session.brain.experience_map.robot
    known = [np.array([robot.x, robot.y])]
    for goal in goals:
        away = np.min([np.hypot(*(poses - place).T) for place in known], axis=0)
        assert away[goal] == away.max()
        known.append(poses[goal])
    assert spread_goals(session, 0) == []
    fresh = a_session()
    assert spread_goals(fresh, 5) == [0]


# ---------------------------------------------------------------- chronicle and snapshots


def observed(session: Session, ticks: int) -> Chronicle:
    chronicle = Chronicle(session)
    for _ in range(ticks):
        session.tick()
        chronicle.watch()
    return chronicle


def kinds(chronicle: Chronicle) -> list[str]:
    return [event.kind for event in chronicle.events]


def test_the_chronicle_changes_nothing() -> None:
    watched = a_session()
    observed(watched, 120)
    assert watched.state_hash() == a_session(120).state_hash()


def test_trail_path_and_series_grow() -> None:
    session = a_session()
    chronicle = observed(session, 101)
    truth = session.simulator.truth
    assert chronicle.trail.shape == (50, 2)
    assert chronicle.path.shape == (50, 3)
    assert chronicle.trail.dtype == np.float32
    assert np.hypot(*(chronicle.trail[-1] - (truth.x, truth.y))) < 0.1
    assert chronicle.series.time_s == pytest.approx(np.arange(11.0), abs=0.11)
    assert chronicle.series.experiences[-1] <= len(session.brain.experience_map)
    assert np.all(np.diff(chronicle.series.views) >= 0)
    assert not chronicle.series.map_error_m.flags.writeable
    assert chronicle.series.residual_mm[-1] == pytest.approx(1000 * session.brain.experience_map.residual[0], abs=5)
    for _ in range(1300):
        session.tick()
        chronicle.watch()
    assert len(chronicle.trail) == len(chronicle.path) == 600  # two minutes


def test_a_long_series_is_thinned_evenly() -> None:
    session = a_session()
    chronicle = Chronicle(session)
    for second in range(1, 2 * SERIES_POINTS + 300):
        session.frame = type(session.frame)(**{
            name: getattr(session.frame, name) for name in session.frame.__slots__ if name not in ("tick", "time_s")
        }, tick=10 * second, time_s=float(second))  # fmt: skip
        chronicle.watch()
        assert len(chronicle.series.time_s) <= SERIES_POINTS
    steps = np.diff(chronicle.series.time_s)
    assert steps == pytest.approx(np.full(len(steps), 4.0))
    assert chronicle.series.time_s[0] == 0.0
    assert chronicle.series.time_s[-1] > 2 * SERIES_POINTS + 290


def test_false_positives_are_all_counted_and_marked_now_and_then() -> None:
    session = a_session(config=Config().with_value("local_view.front_end", "scene numbers"))
    chronicle = observed(session, 100)
    assert "false" not in kinds(chronicle)
    session.set_parameter("local_view.false_positives", 0.5)
    began_s, marked, wrong = session.time_s, [], 0
    for _ in range(200):
        session.tick()
        chronicle.watch()
        wrong += session.estimate.recognition.false_positive
        if session.estimate.recognition.false_positive and len(kinds(chronicle)) > len(marked):
            marked = [e for e in chronicle.events if e.kind == "false"]
    assert session.brain.local_view.false_positives == wrong > 50
    assert 3 <= len(marked) <= 5
    assert min(b.time_s - a.time_s for a, b in pairwise(marked)) >= 5.0 > marked[0].time_s - began_s
    assert re.fullmatch(r"view \d+ instead of \d+", marked[0].text)
    assert re.fullmatch(r"view \d+ instead of \d+, and \d+ more since the last mark", marked[1].text)


def test_events_are_numbered_and_the_last_five_hundred_kept() -> None:
    chronicle = Chronicle(a_session())
    first = chronicle.events
    for number in range(700):
        chronicle.note("parameter", f"change {number}")
    assert first == ()
    assert [event.number for event in chronicle.events[-500:]] == list(range(201, 701))
    assert len(chronicle.events) <= 501
    assert (chronicle.events[-1].kind, chronicle.events[-1].text) == ("parameter", "change 699")


def test_arrival_and_unreachable_goals_are_noted_once() -> None:
    session = a_session(100)
    chronicle = Chronicle(session)
    session.pilot.set_goal(0)
    session.tick()
    chronicle.watch()
    assert session.pilot.goal_state == (0, "tracking")
    assert chronicle.events == ()
    goal = session.brain.experience_map.active
    session.pilot.set_goal(goal)
    for _ in range(200):
        session.tick()
        chronicle.watch()
    assert kinds(chronicle).count("arrived") == 1
    assert f"at experience {goal}" in [event.text for event in chronicle.events]
    session.pilot.cancel_goal()
    session.tick()
    chronicle.watch()
    session.pilot.set_goal(0)
    session.pilot._follower.state = "unreachable"  # type: ignore[union-attr]
    chronicle._watch_goal()
    chronicle._watch_goal()
    assert kinds(chronicle).count("unreachable") == 1


def test_deleted_links_are_noted_once_a_tick() -> None:
    session = a_session(60)
    chronicle = Chronicle(session)
    map_ = session.brain.experience_map
    links = map_.links[:3].tolist()
    for i, j in links:
        for _ in range(20):
            map_.tried(i, j, False)
    assert [list(ends) for ends in map_.dropped_links] == links
    for _ in range(3):
        session.tick()
        chronicle.watch()
    texts = [event.text for event in chronicle.events if event.kind == "link"]
    assert texts == [f"deleted: from experience {links[0][0]} to {links[0][1]} and 2 more, tried too often in vain"]
    i, j = map_.links[0]
    for _ in range(20):
        map_.tried(int(i), int(j), False)
    session.tick()
    chronicle.watch()
    assert chronicle.events[-1].text == f"deleted: from experience {i} to {j}, tried too often in vain"
    assert Chronicle(session)._dropped == 4  # a watcher that comes later does not tell old tales


def test_places_that_pose_cells_hold_twice_or_in_common_are_noted() -> None:
    """Once, when there are more of them than before; looked for every ten seconds."""
    session = a_session(5)
    chronicle = Chronicle(session)
    known = session.brain.experience_map._experiences
    here = Packet(*known.at[0, :2], 0.0, 1.0)
    known.add(Packet((here.x + 30) % 64, here.y, 0.0, 1.0), 500, session.brain.experience_map.pose(0))
    known.add(here, 501, Pose2(30.0, 0.0, 0.0))
    for _ in range(3):
        session.brain.experience_map.transitions.graph.add_node()
    chronicle._watch_map()
    assert chronicle.events == ()
    for _ in range(2):
        chronicle._places_due_s = session.time_s
        chronicle._watch_map()
    assert [(event.kind, event.text) for event in chronicle.events] == [
        ("place", "places with several representations in the pose cells: 1"),
        ("place", "states of the pose cells that stand for several places: 1"),
    ]
    chronicle._watch_map()
    assert chronicle._places_due_s == session.time_s + PLACES_EVERY_S


def test_a_kidnap_recovery_is_noted() -> None:
    session = a_session(10)
    chronicle = Chronicle(session)
    session.kidnap()
    session.kidnap()
    first, second = session.evaluation.kidnaps
    chronicle.watch()
    second.after_s, second.after_m = 4.25, 1.5
    chronicle.watch()
    chronicle.watch()
    noted = [event.text for event in chronicle.events if event.kind == "recovered"]
    assert noted == ["knows where it is 4.2 s and 1.5 m after the kidnap"]
    assert first.after_s is None


def test_a_relocalisation_and_competing_packets_are_noted() -> None:
    session = a_session(40)
    chronicle = Chronicle(session)
    pose_cells = session.brain.pose_cells
    activity = np.roll(pose_cells.activity, (20, 25), (1, 2))
    flats = np.flatnonzero(activity)
    before = pose_cells.winner
    assert not is_lost(session)
    pose_cells.inject(flats.astype(np.int32), (0.8 * activity.flat[flats]).astype(np.float32))
    session.tick()
    assert is_lost(session)
    chronicle.watch()
    chronicle.watch()
    assert kinds(chronicle) == ["lost"]
    assert chronicle.lost
    pose_cells.inject(flats.astype(np.int32), (3.0 * activity.flat[flats]).astype(np.float32))
    session.tick()
    chronicle.watch()
    assert "snap" in kinds(chronicle)
    snap = chronicle.last_snap
    assert snap is not None
    assert snap.start.x == pytest.approx(before.x, abs=1.0)
    assert pose_cells.cells_apart(snap.end.x, snap.end.y, snap.start.x, snap.start.y) > 10


def arrays(value: object, name: str = "snapshot") -> list[tuple[str, np.ndarray]]:
    if isinstance(value, np.ndarray):
        return [(name, value)]
    if isinstance(value, tuple):
        return [found for k, item in enumerate(value) for found in arrays(item, f"{name}[{k}]")]
    slots = getattr(type(value), "__slots__", ())
    return [found for slot in slots for found in arrays(getattr(value, slot), f"{name}.{slot}")]


def snapshots(session: Session) -> Snapshots:
    return Snapshots(session, Chronicle(session), 1, (("office", "Office"),))


def build(made: Snapshots) -> Snapshot:
    return made.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)


@pytest.mark.parametrize("with_goal", [False, True])
def test_snapshots_are_immutable_and_their_rows_agree(with_goal: bool) -> None:
    session = a_session(200)
    if with_goal:
        session.set_goal(0.0, 0.0)
        session.tick()
    snapshot = build(snapshots(session))
    found = arrays(snapshot)
    assert len(found) > 20
    for name, array in found:
        assert not array.flags.writeable, name
    n = len(session.brain.experience_map)
    assert snapshot.experiences == n
    assert len(snapshot.map.ids) == len(snapshot.map.xy) == len(snapshot.map.heading_rad) == n
    assert len(snapshot.times.seconds) == n
    assert len(snapshot.map.links) == snapshot.links == session.brain.experience_map.link_count
    assert snapshot.map.links.max() < n
    assert snapshot.times.to_goal is with_goal
    assert np.all(snapshot.times.seconds >= 0)
    cells = snapshot.pose_cells
    assert len(cells.cells) == len(cells.activity) == min(cells.active_cells, STRONGEST)
    assert np.all(np.diff(cells.activity) <= 0)
    t, y, x = cells.cells[0]
    assert session.brain.pose_cells.activity[t, y, x] == cells.activity[0] == session.brain.pose_cells.activity.max()
    assert len({len(column) for column in (
        snapshot.series.time_s, snapshot.series.map_error_m, snapshot.series.views, snapshot.series.experiences
    )}) == 1  # fmt: skip
    assert len(snapshot.world.walls) == len(snapshot.world.wall_height_m) == len(snapshot.world.wall_kind)
    assert (snapshot.goal is not None) is with_goal
    if with_goal:
        assert snapshot.goal.state == "tracking"
        assert len(snapshot.goal.route_xy) == len(snapshot.goal.route_arrival_s) > 1
        assert snapshot.goal.experience == session.pilot.goal


def test_a_snapshot_is_of_its_moment() -> None:
    """What the engine does later does not show in it, and looking does not show in the engine."""
    session = a_session(100)
    made = snapshots(session)
    snapshot = build(made)
    kept = [(name, array.copy()) for name, array in arrays(snapshot)]
    for _ in range(60):
        session.tick()
        build(made)
    for (name, before), (_, now) in zip(kept, arrays(snapshot), strict=True):
        assert np.array_equal(before, now, equal_nan=True), name
    assert session.state_hash() == a_session(160).state_hash()


def test_what_is_unchanged_is_the_same_object(monkeypatch: pytest.MonkeyPatch) -> None:
    session = a_session(50)
    made = snapshots(session)
    clock = [100.0]
    monkeypatch.setattr("app.snapshots.time.perf_counter", lambda: clock[0])
    first = build(made)
    clock[0] += 0.1
    session.tick()
    second = build(made)
    assert first.world is second.world
    assert first.map is second.map
    assert first.times is second.times
    assert first.parameters is second.parameters
    clock[0] += 0.2  # times are due, the map is not
    third = build(made)
    assert third.map is first.map
    assert third.times is not first.times
    clock[0] += 0.3
    fourth = build(made)
    assert fourth.map is not first.map
    made.refresh()
    fifth = build(made)
    assert fifth.map is not fourth.map
    session.set_goal(0.0, 0.0)
    sixth = build(made)
    assert sixth.map is fifth.map
    assert sixth.times.to_goal
    session.set_parameter("robot.light", 0.9)
    seventh = build(made)
    assert seventh.parameters is not first.parameters
    assert {p.name: p.value for p in seventh.parameters}["robot.light"] == 0.9


def test_the_first_snapshot_has_no_best_view() -> None:
    senses = build(snapshots(a_session())).senses
    assert (senses.best, senses.best_view, senses.difference) == (None, -1, math.inf)
    later = build(snapshots(a_session(20))).senses
    assert later.best is not None
    assert later.best.shape == later.seen.shape == (8, 12)
    assert later.camera.dtype == np.uint8
