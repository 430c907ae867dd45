"""Events, trails and series of a run: they record what happened, and recording changes nothing."""

from __future__ import annotations

import re
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.config import Config
from app.pilot import Pilot
from app.session import Session, is_lost
from app.views import events
from app.views.events import PLACES_EVERY_S, EventWatch
from app.views.history import SERIES_POINTS, STILL_CELLS, History

from .sessions import a_session


def go_on(session: Session, history: History, ticks: int) -> None:
    for _ in range(ticks):
        session.tick()
        history.watch()


def at(session: Session, time_s: float) -> None:
    """The session stands at another time."""
    frame: Any = session.frame
    rest = {name: getattr(frame, name) for name in frame.__slots__ if name not in ("tick", "time_s")}
    session.source.frame = type(frame)(**rest, tick=round(10 * time_s), time_s=time_s)


def kinds(history: History) -> list[str]:
    return [event.kind for event in history.log.events]


def texts(history: History, kind: str) -> list[str]:
    return [event.text for event in history.log.events if event.kind == kind]


def test_a_map_that_has_diverged_is_told_once() -> None:
    session = a_session(30)
    session.set_parameters({"experience_map.sweep": "all at once", "experience_map.correction": 0.9})
    history = History(session)
    go_on(session, history, 1)
    session.brain.experience_map.poses[-1, 0] = 1e6
    for _ in range(5):
        history.watch()
    assert texts(history, "warning") == ["the map diverged: correction rate 0.9 is too high for all links at once"]


def test_trail_path_and_series_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.views.history.TRAIL_S", 20.0)
    session = a_session(config=Config().with_value("pilot.seek", False))  # else it begins by turning on the spot
    history, map_ = History(session), session.brain.experience_map
    go_on(session, history, 101)
    truth, series = session.simulator.truth, history.series.series
    assert (history.trails.robot.shape, history.trails.packet.shape) == ((50, 2), (50, 3))
    assert history.trails.robot.dtype == np.float32
    assert np.hypot(*(history.trails.robot[-1] - (truth.x, truth.y))) < 0.1
    assert series.time_s == pytest.approx(np.arange(11.0), abs=0.11)
    assert series.experiences[-1] <= len(map_)
    assert np.all(np.diff(series.views) >= 0)
    assert not series.map_error_m.flags.writeable
    assert series.residual_mm[-1] == pytest.approx(1000 * map_.residual[0], abs=5)
    go_on(session, history, 170)
    assert (len(history.trails.robot), len(history.trails.packet)) == (100, 100)


def test_the_trail_of_a_robot_that_stands_stays_the_same_object() -> None:
    session = a_session(50)
    session.pilot.set_mode("manual")
    for _ in range(20):  # it rolls out
        session.tick()
    history = History(session)
    go_on(session, history, 40)
    trail = history.trails.robot
    go_on(session, history, 40)
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
    times = history.series.series.time_s
    assert np.diff(times) == pytest.approx(np.full(len(times) - 1, 4.0))
    assert times[0] == 0.0
    assert times[-1] > 2 * SERIES_POINTS + 290


def test_false_positives_are_all_counted_and_marked_now_and_then() -> None:
    session = a_session(config=Config().with_value("local_view.front_end", "scene numbers"))
    history = History(session)
    go_on(session, history, 100)
    assert "false" not in kinds(history)
    session.set_parameter("local_view.false_positives", 0.5)
    began_s, wrong = session.time_s, 0
    for _ in range(200):
        go_on(session, history, 1)
        wrong += session.estimate.recognition.false_positive
    marked = [event for event in history.log.events if event.kind == "false"]
    assert session.brain.local_view.false_positives == wrong > 20
    assert 3 <= len(marked) <= 5
    assert min(b.time_s - a.time_s for a, b in pairwise(marked)) >= 5.0 > marked[0].time_s - began_s
    assert re.fullmatch(r"view \d+ reported instead of \d+", marked[0].text)
    assert re.fullmatch(r"view \d+ reported instead of \d+, and \d+ more since the last mark", marked[1].text)


def test_events_are_numbered_and_the_last_two_thousand_kept() -> None:
    log = History(a_session()).log
    first = log.events
    for number in range(2200):
        log.note("parameter", f"change {number}")
    assert first == ()
    assert [event.number for event in log.events[-2000:]] == list(range(201, 2201))
    assert len(log.events) <= 2001
    assert (log.events[-1].kind, log.events[-1].text) == ("parameter", "change 2199")


def test_arrival_is_noted_once() -> None:
    session = a_session(100)
    history = History(session)
    session.pilot.set_goal(0)
    go_on(session, history, 1)
    assert (session.pilot.goal_state, history.log.events) == ((0, "tracking"), ())
    goal = session.brain.experience_map.active
    session.pilot.set_goal(goal)
    go_on(session, history, 200)
    assert texts(history, "arrived") == [f"at experience {goal}"]


def test_of_a_goal_only_what_is_true_is_noted_and_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """While the robot is lost it has not arrived; as soon as it knows where it is, it has."""
    session = a_session(100)
    history = History(session)
    session.pilot.set_goal(0)

    def seen(state: str, lost: bool) -> list[str]:
        """What is noted of the goal when the pilot says so."""
        monkeypatch.setattr(Pilot, "goal_state", (0, state))
        monkeypatch.setattr(events, "is_lost", lambda _: lost)
        history.watch()
        return [kind for kind in kinds(history) if kind != "lost"]

    assert [seen(state, True) for state in ("tracking", "arrived", "unreachable", "exploring")] == [[]] * 4
    assert [seen("arrived", lost) for lost in (True, False, True, False)] == [[], *[["arrived"]] * 3]
    for _ in range(2):
        assert seen("unreachable", False) == ["arrived", "unreachable"]


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
    numbers = [event.number for event in log.events]
    assert numbers == sorted(numbers)
    assert len(numbers) == 1 + 5, "the line and each snap"
    for tick in range(5):
        past = log.until(float(tick), session)
        (line,) = (event for event in past.events if event.kind == "place")
        assert (line.text, line.count, line.time_s) == (f"several: {tick}", tick + 1, float(tick))
        past.note("place", "several: again", "several")
        assert [event.count for event in past.events if event.kind == "place"] == [tick + 2]


def test_deleted_links_are_noted_once_a_tick() -> None:
    session = a_session(60)
    history, map_ = History(session), session.brain.experience_map

    def fail(count: int) -> list[list[int]]:
        """Try the first links in vain until they are deleted."""
        links = map_.links[:count].tolist()
        for i, j in links:
            for _ in range(20):
                map_.tried(i, j, False)
        return links

    first = fail(3)
    assert [list(ends) for ends in map_.dropped_links] == first
    go_on(session, history, 3)
    i, j = first[0]
    assert texts(history, "link") == [f"deleted: {i} to {j} and 2 more, failed too often"]
    ((i, j),) = fail(1)
    later = History(session)
    go_on(session, history, 1)
    assert history.log.events[-1].text == f"deleted: {i} to {j}, failed too often"
    EventWatch(session, later.log).watch()
    assert texts(later, "link") == [], "a watcher that comes later does not report old events"


def test_who_proves_to_be_elsewhere_than_it_took_itself_to_be_is_noted_once() -> None:
    session = a_session()
    history = History(session)
    session.brain.experience_map.corrected += 1
    go_on(session, history, 3)
    assert kinds(history).count("corrected") == 1


def test_places_that_pose_cells_hold_twice_or_in_common_are_noted(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are looked for every ten seconds, and noted once when there are more than before."""
    session, found = a_session(), SimpleNamespace(multiple_representations=[1], hash_collisions=[])
    history = History(session)
    monkeypatch.setattr(events, "find_places", lambda _map: found)

    def noted(after_s: float) -> list[str]:
        at(session, session.time_s + after_s)
        history.watch()
        return texts(history, "place")

    assert noted(PLACES_EVERY_S - 0.1) == []
    assert noted(0.1) == noted(PLACES_EVERY_S) == ["multiple representations in the pose cells: 1 place"]
    found.multiple_representations, found.hash_collisions = [1, 2], [3]
    assert len(noted(PLACES_EVERY_S - 0.1)) == 1
    assert noted(0.1) == [
        "multiple representations in the pose cells: 2 places",
        "hash collisions in the pose cells: 1 state",
    ]


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
    assert texts(history, "recovered") == ["right again 4.2 s and 1.5 m after the kidnap"]
    assert first.after_s is None


def test_a_relocalisation_and_competing_packets_are_noted() -> None:
    session = a_session(40)
    history, pose_cells = History(session), session.brain.pose_cells
    activity = np.roll(pose_cells.activity, (20, 25), (1, 2))
    flats = np.flatnonzero(activity)
    before = pose_cells.winner

    def compete(share: float) -> None:
        pose_cells.inject(flats.astype(np.int32), (share * activity.flat[flats]).astype(np.float32))
        go_on(session, history, 1)

    assert not is_lost(session)
    compete(0.8)
    history.watch()
    assert (kinds(history), is_lost(session), history.events.lost) == (["lost"], True, True)
    compete(3.0)
    snap = history.events.last_snap
    assert "snap" in kinds(history)
    assert snap is not None
    assert snap.start.x == pytest.approx(before.x, abs=1.0)
    assert pose_cells.cells_apart(snap.end.x, snap.end.y, snap.start.x, snap.start.y) > 10
