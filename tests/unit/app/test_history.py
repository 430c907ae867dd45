"""Events, trails and series of a run: they record what happened, and recording changes nothing."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from app.config import Config
from app.session import Session, is_lost
from app.views.event_watch import PLACES_EVERY_S, EventWatch
from app.views.history import History
from app.views.series import SERIES_POINTS
from app.views.trails import STILL_CELLS
from ratslam_core import Packet, Pose2

from .sessions import a_session


def observed(session: Session, ticks: int) -> History:
    history = History(session)
    for _ in range(ticks):
        session.tick()
        history.watch()
    return history


def at(session: Session, time_s: float) -> None:
    """The session stands at another time."""
    frame: Any = session.frame
    rest = {name: getattr(frame, name) for name in frame.__slots__ if name not in ("tick", "time_s")}
    session.frame = type(frame)(**rest, tick=round(10 * time_s), time_s=time_s)


def kinds(history: History) -> list[str]:
    return [event.kind for event in history.log.events]


def test_a_map_that_has_diverged_is_told_once() -> None:
    session = a_session(30)
    session.set_parameters({"experience_map.sweep": "all at once", "experience_map.correction": 0.9})
    history = observed(session, 1)
    session.brain.experience_map.poses[-1, 0] = 1e6
    for _ in range(5):
        history.watch()
    warnings = [event.text for event in history.log.events if event.kind == "warning"]
    assert warnings == ["the map has diverged: a correction rate of 0.9 is too high for all links at once"]


@pytest.mark.slow
def test_trail_path_and_series_grow() -> None:
    session = a_session()
    history = observed(session, 101)
    truth = session.simulator.truth
    assert history.trails.robot.shape == (50, 2)
    assert history.trails.packet.shape == (50, 3)
    assert history.trails.robot.dtype == np.float32
    assert np.hypot(*(history.trails.robot[-1] - (truth.x, truth.y))) < 0.1
    assert history.series.series.time_s == pytest.approx(np.arange(11.0), abs=0.11)
    assert history.series.series.experiences[-1] <= len(session.brain.experience_map)
    assert np.all(np.diff(history.series.series.views) >= 0)
    assert not history.series.series.map_error_m.flags.writeable
    assert history.series.series.residual_mm[-1] == pytest.approx(
        1000 * session.brain.experience_map.residual[0], abs=5
    )
    for _ in range(1300):
        session.tick()
        history.watch()
    assert len(history.trails.robot) <= 600  # two minutes
    assert len(history.trails.packet) <= 600
    assert len(history.trails.robot) > 400  # of driving; while it stands, there is nothing to add


def test_the_trail_of_a_robot_that_stands_stays_the_same_object() -> None:
    session = a_session(50)
    session.pilot.set_mode("manual")
    for _ in range(20):  # it rolls out
        session.tick()
    history = History(session)
    for _ in range(40):
        session.tick()
        history.watch()
    trail = history.trails.robot
    for _ in range(40):
        session.tick()
        history.watch()
    assert history.trails.robot is trail
    steps = np.diff(history.trails.packet, axis=0)
    assert np.all(np.sqrt((steps**2).sum(1)) > 0.99 * STILL_CELLS)


def test_a_long_series_is_thinned_evenly() -> None:
    session = a_session()
    history = History(session)
    for second in range(1, 2 * SERIES_POINTS + 300):
        at(session, float(second))
        history.watch()
        assert len(history.series.series.time_s) <= SERIES_POINTS
    steps = np.diff(history.series.series.time_s)
    assert steps == pytest.approx(np.full(len(steps), 4.0))
    assert history.series.series.time_s[0] == 0.0
    assert history.series.series.time_s[-1] > 2 * SERIES_POINTS + 290


def test_false_positives_are_all_counted_and_marked_now_and_then() -> None:
    session = a_session(config=Config().with_value("local_view.front_end", "scene numbers"))
    history = observed(session, 100)
    assert "false" not in kinds(history)
    session.set_parameter("local_view.false_positives", 0.5)
    began_s, marked, wrong = session.time_s, [], 0
    for _ in range(200):
        session.tick()
        history.watch()
        wrong += session.estimate.recognition.false_positive
        if session.estimate.recognition.false_positive and len(kinds(history)) > len(marked):
            marked = [e for e in history.log.events if e.kind == "false"]
    assert session.brain.local_view.false_positives == wrong > 50
    assert 3 <= len(marked) <= 5
    assert min(b.time_s - a.time_s for a, b in pairwise(marked)) >= 5.0 > marked[0].time_s - began_s
    assert re.fullmatch(r"view \d+ instead of \d+", marked[0].text)
    assert re.fullmatch(r"view \d+ instead of \d+, and \d+ more since the last mark", marked[1].text)


def test_events_are_numbered_and_the_last_two_thousand_kept() -> None:
    history = History(a_session())
    first = history.log.events
    for number in range(2200):
        history.log.note("parameter", f"change {number}")
    assert first == ()
    assert [event.number for event in history.log.events[-2000:]] == list(range(201, 2201))
    assert len(history.log.events) <= 2001
    assert (history.log.events[-1].kind, history.log.events[-1].text) == ("parameter", "change 2199")


def test_arrival_and_unreachable_goals_are_noted_once() -> None:
    session = a_session(100)
    history = History(session)
    session.pilot.set_goal(0)
    session.tick()
    history.watch()
    assert session.pilot.goal_state == (0, "tracking")
    assert history.log.events == ()
    goal = session.brain.experience_map.active
    session.pilot.set_goal(goal)
    for _ in range(200):
        session.tick()
        history.watch()
    assert kinds(history).count("arrived") == 1
    assert f"at experience {goal}" in [event.text for event in history.log.events]
    session.pilot.cancel_goal()
    session.tick()
    history.watch()
    session.pilot.set_goal(0)
    session.pilot._follower.state = "unreachable"  # type: ignore[union-attr]
    history.events._watch_goal()
    history.events._watch_goal()
    assert kinds(history).count("unreachable") == 1


def test_of_a_goal_only_what_is_true_is_noted() -> None:
    """While the robot is lost it has not arrived; as soon as it knows where it is, it has, and this is noted once."""
    session = a_session(100)
    history = History(session)
    session.pilot.set_goal(0)
    follower = session.pilot._follower
    assert follower is not None
    for state, lost in [("tracking", True), ("arrived", True), ("unreachable", True), ("exploring", True)]:
        follower.state, history.events.lost = state, lost  # type: ignore[assignment]
        history.events._watch_goal()
        assert history.log.events == ()
    for lost in (True, False, True, False):
        follower.state, history.events.lost = "arrived", lost
        history.events._watch_goal()
    assert kinds(history) == ["arrived"]


def test_what_repeats_is_one_line_that_counts() -> None:
    """Also at any moment of the past: there the line counts what had happened by then."""
    session = a_session()
    log = History(session).log
    for tick in range(5):
        at(session, float(tick))
        log.of_tick = True
        log.note("place", f"several: {tick}", "several")
        log.note("snap", f"snap {tick}")
    (line,) = (event for event in log.events if event.kind == "place")
    assert (line.text, line.count, line.since_s, line.time_s) == ("several: 4", 5, 0.0, 4.0)
    assert [event.number for event in log.events] == sorted(event.number for event in log.events)
    assert sum(event.kind == "snap" for event in log.events) == 5
    for tick in range(5):
        past = log.until(float(tick), session)
        (line,) = (event for event in past.events if event.kind == "place")
        assert (line.text, line.count, line.time_s) == (f"several: {tick}", tick + 1, float(tick))
        past.note("place", "several: again", "several")
        assert [event.count for event in past.events if event.kind == "place"] == [tick + 2]


def test_deleted_links_are_noted_once_a_tick() -> None:
    session = a_session(60)
    history = History(session)
    map_ = session.brain.experience_map
    links = map_.links[:3].tolist()
    for i, j in links:
        for _ in range(20):
            map_.tried(i, j, False)
    assert [list(ends) for ends in map_.dropped_links] == links
    for _ in range(3):
        session.tick()
        history.watch()
    texts = [event.text for event in history.log.events if event.kind == "link"]
    assert texts == [f"deleted: from experience {links[0][0]} to {links[0][1]} and 2 more, tried too often in vain"]
    i, j = map_.links[0]
    for _ in range(20):
        map_.tried(int(i), int(j), False)
    session.tick()
    history.watch()
    assert history.log.events[-1].text == f"deleted: from experience {i} to {j}, tried too often in vain"
    assert EventWatch(session, history.log)._dropped == 4  # a watcher that comes later does not report old events


def test_places_that_pose_cells_hold_twice_or_in_common_are_noted() -> None:
    """They are looked for every ten seconds, and noted once when there are more than before."""
    session = a_session(5)
    history = History(session)
    known = session.brain.experience_map._experiences
    here = Packet(*known.at[0, :2], 0.0, 1.0)
    known.add(Packet((here.x + 30) % 64, here.y, 0.0, 1.0), 500, session.brain.experience_map.pose(0))
    known.add(here, 501, Pose2(30.0, 0.0, 0.0))
    for _ in range(3):
        session.brain.experience_map.transitions.graph.add_node()
    history.events._watch_places()
    assert history.log.events == ()
    for _ in range(2):
        history.events._places_due_s = session.time_s
        history.events._watch_places()
    assert [(event.kind, event.text) for event in history.log.events] == [
        ("place", "places with several representations in the pose cells: 1"),
        ("place", "states of the pose cells that stand for several places: 1"),
    ]
    history.events._watch_places()
    assert history.events._places_due_s == session.time_s + PLACES_EVERY_S


def test_a_kidnap_recovery_is_noted() -> None:
    session = a_session(10)
    history = History(session)
    session.kidnap()
    session.kidnap()
    first, second = session.evaluation.kidnaps
    history.watch()
    second.after_s, second.after_m = 4.25, 1.5
    history.watch()
    history.watch()
    noted = [event.text for event in history.log.events if event.kind == "recovered"]
    assert noted == ["knows where it is 4.2 s and 1.5 m after the kidnap"]
    assert first.after_s is None


def test_a_relocalisation_and_competing_packets_are_noted() -> None:
    session = a_session(40)
    history = History(session)
    pose_cells = session.brain.pose_cells
    activity = np.roll(pose_cells.activity, (20, 25), (1, 2))
    flats = np.flatnonzero(activity)
    before = pose_cells.winner
    assert not is_lost(session)
    pose_cells.inject(flats.astype(np.int32), (0.8 * activity.flat[flats]).astype(np.float32))
    session.tick()
    assert is_lost(session)
    history.watch()
    history.watch()
    assert kinds(history) == ["lost"]
    assert history.events.lost
    pose_cells.inject(flats.astype(np.int32), (3.0 * activity.flat[flats]).astype(np.float32))
    session.tick()
    history.watch()
    assert "snap" in kinds(history)
    snap = history.events.last_snap
    assert snap is not None
    assert snap.start.x == pytest.approx(before.x, abs=1.0)
    assert pose_cells.cells_apart(snap.end.x, snap.end.y, snap.start.x, snap.start.y) > 10
