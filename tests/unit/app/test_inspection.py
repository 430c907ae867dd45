"""What inspection reports is what the engine holds."""

from __future__ import annotations

import numpy as np
import pytest

from app.config import Config
from app.session import Session
from app.views.arrays import present_picture, stored_picture
from app.views.history import History, Visits
from app.views.inspection import inspect
from app.views.snapshots import senses_of
from web.messages import CellReport, ExperienceReport, Inspect, Report, ViewReport

from .sessions import a_session

Watched = tuple[Session, History]


@pytest.fixture(scope="module")
def watched() -> Watched:
    """A minute of exploring, watched."""
    session = a_session(seed=5)
    history = History(session)
    for _ in range(600):
        session.tick()
        history.watch()
    return session, history


def look(watched: Watched, **wish: int) -> Report | None:
    session, history = watched
    return inspect(session, history.visits, history.events.reasons, Inspect(type="inspect", **wish))


def test_an_experience_is_told_with_its_links_and_times(watched: Watched) -> None:
    session, _ = watched
    map_ = session.brain.experience_map
    active = map_.active
    report, first = look(watched, experience=active), look(watched, experience=0)
    assert isinstance(report, ExperienceReport)
    assert isinstance(first, ExperienceReport)
    assert (report.active, first.active) == (True, False)
    assert (*report.cell, report.view) == map_.cell_state(active)
    assert (report.pose.x, report.pose.y) == tuple(map_.poses[active, :2])
    assert {(link.start, link.end) for link in report.links} == {
        (i, j) for i, j in map_.links.tolist() if active in (i, j)
    }
    assert all(link.behaviour and 0 <= link.confidence <= 1 for link in report.links)
    assert (report.times.last_s, first.times.first_s) == (session.time_s, 0)
    assert report.times.first_s is not None
    assert report.times.first_s <= session.time_s


def test_a_view_is_told_with_what_is_seen_now(watched: Watched) -> None:
    session, _ = watched
    seen = session.estimate.recognition
    report = look(watched, view=seen.best_view)
    assert isinstance(report, ViewReport)
    np.testing.assert_array_equal(report.picture, stored_picture(session.brain, seen.best_view))
    np.testing.assert_array_equal(report.now, present_picture(session.brain))
    assert report.camera is session.frame.image
    assert report.difference == pytest.approx(seen.difference)  # as the engine itself measured it
    assert all(session.brain.experience_map.views[k] == report.id for k in report.experiences)
    cells, strength = session.brain.view_links.of(report.id)
    assert (report.hebbian.count, report.hebbian.strength[0]) == (len(cells), strength.max())


def test_a_column_of_pose_cells_is_told_with_the_views_that_lead_there(watched: Watched) -> None:
    session, _ = watched
    brain, winner, map_ = session.brain, session.brain.pose_cells.winner, session.brain.experience_map
    _, n_y, n_x = brain.pose_cells.shape
    x, y = round(winner.x) % n_x, round(winner.y) % n_y
    report = look(watched, x=x, y=y)
    assert isinstance(report, CellReport)
    np.testing.assert_allclose(report.by_heading, brain.pose_cells.activity[:, y, x], rtol=1e-6)
    assert report.packet is not None
    assert report.packet.id == winner.id
    sums = {}
    for view in range(len(brain.local_view)):
        cells, strength = brain.view_links.of(view)
        here = cells % (n_y * n_x) == y * n_x + x
        if here.any():
            sums[view] = float(strength[here].sum())
    assert report.view_count == len(sums)
    assert [view for view, _ in report.views] == sorted(sums, key=lambda v: (-np.float32(sums[v]), v))[:24]
    assert dict(report.views) == pytest.approx({view: sums[view] for view, _ in report.views}, rel=1e-5)
    for k in range(len(map_)):
        at = map_.cell_state(k)
        assert (k in report.experiences) == (brain.pose_cells.cells_apart(at[0], at[1], x, y) <= map_.params.zone_xy)
    taken = {(x, y) for x, y in brain.pose_cells.active[0][:, :2].tolist()}
    x, y = next((x, y) for x in range(64) for y in range(64) if (x, y) not in taken)
    report = look(watched, x=x, y=y)
    assert isinstance(report, CellReport)
    assert (report.packet, report.by_heading.any()) == (None, False), "where nothing is active there is no packet"


def test_what_is_not_there_is_refused_and_nothing_asked_nothing_shown(watched: Watched) -> None:
    for wish, words in [
        ({"experience": 10**6}, "experience must be from 0 to"),
        ({"view": 10**6}, "view must be from 0 to"),
        ({"x": 3}, "needs x from 0 to 63 and y from 0 to 63, got 3 and None"),
        ({"x": 64, "y": 0}, "got 64 and 0"),
        ({"experience": 0, "view": 0}, "one of them"),
    ]:
        with pytest.raises(ValueError, match=words):
            look(watched, **wish)
    assert look(watched) is None


def test_visits_are_counted_when_something_becomes_active() -> None:
    visits = Visits()
    for time_s, number in enumerate((2000, 2000, -1, 2000, 3, 2000)):
        visits.note(number, float(time_s))
    assert (visits.of(2000).first_s, visits.of(2000).last_s, visits.of(2000).visits) == (0.0, 5.0, 3)
    assert (visits.of(4).first_s, visits.of(10**6).visits) == (None, 0)


def test_where_the_camera_is_off_no_picture_of_it_is_shown() -> None:
    blind = a_session(1, config=Config().with_values({"robot.camera": False}))
    assert senses_of(blind).camera.size == 0
    assert senses_of(a_session()).camera.size > 0
