"""Why something happened is kept when it happens, and true: views, packets before and after, and where it began."""

from __future__ import annotations

import pytest

from app.config import Config
from app.session import Session
from app.views.history import History
from ratslam_core.extensions.evidence import ODDS
from sim2d import load_world
from web.messages import WhyReport

pytestmark = pytest.mark.slow

OFFICE = load_world("office")


def watched(session: Session, ticks: int) -> History:
    history = History(session)
    for _ in range(ticks):
        session.tick()
        history.watch()
    return history


def reasons_of(history: History, kind: str) -> list[WhyReport]:
    return [history.events.reasons.of(event.number) for event in history.log.events if event.kind == kind]


def test_a_snap_is_explained_by_views_that_put_activity_where_it_led() -> None:
    session, history = snapped()
    (snap, *_) = reasons_of(history, "snap")
    assert snap.after[0].id != snap.before[0].id, "another packet has won"
    assert snap.without == tuple(cause.view for cause in history.events.last_snap.causes) != ()  # type: ignore[union-attr]
    assert 0 < snap.time_s - snap.since_s < 60
    assert [seen.view for seen in snap.views] == list(snap.without[:4])
    assert [at for at, _ in snap.chain] == sorted(at for at, _ in snap.chain)
    assert snap.chain[0][0] == snap.since_s
    assert "the pose cells have relocalised" in " ".join(words for _, words in snap.chain)
    assert snap.camera.shape == session.frame.image.shape


def snapped() -> tuple[Session, History]:
    """A robot that was carried away and has just relocalised for the first time."""
    session = Session(OFFICE, 8)
    history = watched(session, 2400)
    session.kidnap()
    for _ in range(3000):
        session.tick()
        history.watch()
        if session.estimate.relocalised:
            return session, history
    raise AssertionError("it never relocalised")


def test_who_was_carried_believes_then_joins_and_what_was_said_adds_up_to_the_odds() -> None:
    """The bars are changes of the log odds of the place that is believed, from when it was first thought of."""
    session = Session(OFFICE, 11)
    history = watched(session, 4000)
    session.kidnap()
    evidence, odds = session.brain.experience_map.evidence, None
    for _ in range(1200):
        session.tick()
        history.watch()
        if odds is None and evidence.belief is not None:
            odds = float(evidence.hypotheses[:, ODDS].max())
    kinds = [event.kind for event in history.log.events if event.kind in ("lost", "believes", "joined")]
    assert kinds[:3] == ["lost", "believes", "joined"]  # what is lost later is another story
    (why,) = reasons_of(history, "believes")
    assert sum(nats for _, nats in why.said) == pytest.approx(odds)
    assert why.since_s == why.said[0][0] < why.said[-1][0] == why.time_s


def test_a_closed_loop_is_marked_and_says_what_was_linked() -> None:
    session = Session(OFFICE, 3)
    history = watched(session, 2000)
    closures = reasons_of(history, "closure")
    assert closures
    for closure in closures:
        start, end = closure.experiences
        assert (start, end) in session.brain.experience_map.transitions.row_of
        births = session.evaluation.births(len(session.brain.experience_map))
        assert births[start, 3] - births[end, 3] > 0, "back at an older one"
        assert closure.without == tuple(seen.view for seen in closure.views)


def test_a_false_look_says_which_view_was_right() -> None:
    session = Session(OFFICE, 5, Config().with_value("local_view.false_positives", 0.1))
    history = watched(session, 200)
    false = reasons_of(history, "false")
    assert false
    for look in false:
        reported, right = (seen.view for seen in look.views)
        assert f"view {reported} instead of {right}" in look.text
        assert look.without == (reported,)


def test_an_unknown_event_is_refused() -> None:
    history = watched(Session(OFFICE, 3), 50)
    with pytest.raises(
        ValueError, match="event must be a snap, closure, false look, lost moment or belief of late, got 77"
    ):
        history.events.reasons.of(77)
