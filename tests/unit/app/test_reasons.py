"""Why something happened is kept when it happens, and true: views, packets before and after, and where it began."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from app.config import Config
from app.session import Session
from app.views.history import History
from app.views.snap_causes import words_of
from ratslam_core.extensions.evidence import ODDS
from web.messages import SnapCause, WhyReport

from .sessions import OFFICE

pytestmark = pytest.mark.slow


class Carried(NamedTuple):
    """A robot that explored, was carried away, and found itself again."""

    session: Session
    history: History
    odds: float  # of the place that it believed first, when it came to believe it
    causes: tuple[SnapCause, ...]  # of the first snap, when it had just snapped


def watched(session: Session, ticks: int) -> History:
    history = History(session)
    for _ in range(ticks):
        session.tick()
        history.watch()
    return history


def reasons_of(history: History, kind: str) -> list[WhyReport]:
    return [history.events.reasons.of(event.number) for event in history.log.events if event.kind == kind]


@pytest.fixture(scope="module")
def carried() -> Carried:
    session = Session(OFFICE, 11)
    history = watched(session, 4000)
    session.kidnap()
    evidence, odds, causes = session.brain.experience_map.evidence, list[float](), list[tuple[SnapCause, ...]]()
    for _ in range(150):
        session.tick()
        history.watch()
        if evidence.belief is not None:
            odds.append(float(evidence.hypotheses[:, ODDS].max()))
        if session.estimate.relocalised:
            assert history.events.last_snap is not None
            causes.append(history.events.last_snap.causes)
    return Carried(session, history, odds[0], causes[0])


def test_a_snap_is_explained_by_views_that_put_activity_where_it_led(carried: Carried) -> None:
    session, history, causes = carried.session, carried.history, carried.causes
    (snap, *_), views = reasons_of(history, "snap"), tuple(cause.view for cause in causes)
    assert snap.after[0].id != snap.before[0].id, "another packet has won"
    assert snap.without == views != ()
    assert 0 < snap.time_s - snap.since_s < 60
    assert tuple(seen.view for seen in snap.views) == views[:4]
    assert [at for at, _ in snap.chain] == sorted(at for at, _ in snap.chain)
    assert snap.chain[0][0] == snap.since_s
    assert "the pose cells have relocalised" in " ".join(words for _, words in snap.chain)
    assert snap.camera.shape == session.frame.image.shape
    event = next(event for event in history.log.events if event.kind == "snap")
    assert event.text.startswith(f"relocalised {words_of(causes)}: (")
    assert sum(cause.share for cause in causes) == pytest.approx(1.0)
    for cause in causes:
        assert 0 <= cause.view < len(session.brain.local_view)
        assert cause.age_s >= session.brain.params.local_view.rest - 1e-6  # younger ones inject nothing


def test_who_was_carried_believes_then_joins_and_what_was_said_adds_up_to_the_odds(carried: Carried) -> None:
    """The bars are changes of the log odds of the place that is believed, from when it was first thought of."""
    kinds = [event.kind for event in carried.history.log.events if event.kind in ("lost", "believes", "joined")]
    assert kinds == ["lost", "believes", "joined"]
    (why,) = reasons_of(carried.history, "believes")
    assert sum(nats for _, nats in why.said) == pytest.approx(carried.odds)
    assert why.since_s == why.said[0][0] < why.said[-1][0] == why.time_s


def test_a_closed_loop_is_marked_and_says_what_was_linked(carried: Carried) -> None:
    closures, map_ = reasons_of(carried.history, "closure"), carried.session.brain.experience_map
    assert closures
    births = carried.session.evaluation.births(len(map_))
    for closure in closures:
        start, end = closure.experiences
        assert (start, end) in map_.transitions.row_of
        assert births[start, 3] - births[end, 3] > 0, "back at an older one"
        assert closure.without == tuple(seen.view for seen in closure.views)


def test_a_false_look_says_which_view_was_right() -> None:
    history = watched(Session(OFFICE, 5, Config().with_value("local_view.false_positives", 0.1)), 200)
    false = reasons_of(history, "false")
    assert false
    for look in false:
        reported, right = (seen.view for seen in look.views)
        assert f"view {reported} instead of {right}" in look.text
        assert look.without == (reported,)
    with pytest.raises(
        ValueError, match="event must be a snap, closure, false look, lost moment or belief of late, got 777"
    ):
        history.events.reasons.of(777)
