"""Why something happened is kept when it happens, and true: views, packets before and after, and where it began. A snap says
which links made it: views, how often they injected around the packet that won, and how much."""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple
from unittest.mock import MagicMock

import numpy as np
import pytest

from app.config import Config
from app.session import Session
from app.views.events import LONG_AGO_S, NEW_GROUND, EventLog, EventWatch
from app.views.history import History
from app.views.reasons import SnapCauses, words_of
from ratslam_core import LocalViewParams, Pose2, PoseCells, Recognition
from ratslam_core.extensions.evidence import ODDS
from ratslam_core.local_view.view_links import VisualAssociation
from web.messages import SnapCause, WhyReport

from .sessions import OFFICE

pytestmark = pytest.mark.slow

HERE, THERE = (8, 8, 0), (40, 50, 9)


class Bench:
    """Pose cells and views that a test links and looks at by hand."""

    def __init__(self) -> None:
        self.pose_cells, self.association = PoseCells(), VisualAssociation(LocalViewParams(rest=0.0, saturation=0.01))
        self.causes = SnapCauses(SimpleNamespace(brain=self, time_s=0.0))  # type: ignore[arg-type]

    def learn(self, view: int, place: tuple[int, int, int]) -> None:
        """Link a new view to a place, as strongly as by a long look."""
        self.pose_cells.place(*place)
        self.pose_cells.attract()
        for k in range(30):
            links = self.association.links
            if k == 0:
                self.association.step(Recognition(view, True, -1, 99.0), 1.0, 0.1, self.pose_cells, False)
            links.learn(view, *self.pose_cells.active, self.pose_cells.slot)

    def look(self, view: int) -> None:
        self.association.step(Recognition(view, False, view, 1.0), 1.0, 0.1, self.pose_cells, False)
        self.pose_cells.attract()
        self.causes.watch()

    def at(self, place: tuple[int, int, int]) -> bool:
        return self.pose_cells.cells_apart(*place[:2], self.pose_cells.winner.x, self.pose_cells.winner.y) < 3


def test_the_views_that_fed_the_winner_are_told_the_strongest_first() -> None:
    bench = Bench()
    for view, place in ((0, HERE), (1, THERE), (2, THERE)):
        bench.learn(view, place)
    bench.pose_cells.place(*HERE)
    looks: list[int] = []
    for view in (0, 0, -1, *(1, 1, -1, 2) * 60):
        looks.append(view)
        bench.look(view)
        if bench.at(THERE):
            break
    assert bench.at(THERE)
    causes = bench.causes.of(bench.pose_cells.winner)
    assert [cause.view for cause in causes] == [1, 2]  # not 0, which fed the other packet
    assert [cause.looks for cause in causes] == [looks.count(1), looks.count(2)]
    assert sum(cause.share for cause in causes) == pytest.approx(1.0)
    for cause in causes:
        cells, strength = bench.association.links.of(cause.view)
        assert 0 < cause.links <= len(cells)
        assert cause.strongest == pytest.approx(strength.max())
        assert cause.age_s == pytest.approx(bench.association.age_s(cause.view))
    assert causes[0].amount > causes[1].amount > 0


def test_what_fed_the_place_before_the_packet_came_into_being_does_not_count() -> None:
    bench = Bench()
    for view, place in ((0, HERE), (1, THERE)):
        bench.learn(view, place)
    bench.pose_cells.place(*THERE)
    for view in (1, 1, 1):
        bench.look(view)
    bench.pose_cells.place(*HERE)  # that packet is gone
    for _ in range(5):
        bench.look(0)
    (cause,) = bench.causes.of(bench.pose_cells.winner)
    assert (cause.view, cause.looks) == (0, 5)
    bench = Bench()
    bench.look(-1)
    assert bench.causes.of(bench.pose_cells.winner) == ()  # a packet that no view made


def test_the_words_of_causes() -> None:
    cause = SnapCause(312, 7, 1.2, 0.41, 90, 0.02, 61.3)
    assert words_of((cause,)) == "by view 312 (7 observations, 41% of the injection, learnt 61 s before)"
    assert words_of((cause, cause, cause)).endswith("before) and 2 more")
    assert words_of((SnapCause(1, 1, 1.0, 1.0, 1, 0.1, 0.0),)).startswith("by view 1 (1 observation, 100% of")
    assert words_of(()) == "by no view"


# ---------------------------------------------------------------- in a run


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
    """The first robot that finds itself by a snap."""
    return next(found for seed in range(11, 20) if (found := carried_robot(seed)) is not None)


def carried_robot(seed: int) -> Carried | None:
    session = Session(OFFICE, seed)
    history = watched(session, 4000)
    session.kidnap()
    evidence, odds, causes = session.brain.experience_map.evidence, list[float](), list[tuple[SnapCause, ...]]()
    while session.brain.experience_map.carried or session.time_s < 400.5:
        session.tick()
        history.watch()
        if evidence.belief is not None:
            odds.append(float(evidence.hypotheses[:, ODDS].max()))
        if session.estimate.relocalised:
            assert history.events.last_snap is not None
            causes.append(history.events.last_snap.causes)
    return Carried(session, history, odds[0], causes[0]) if odds and causes else None


def test_a_snap_is_explained_by_views_that_put_activity_where_it_led(carried: Carried) -> None:
    (snap, *_), views = reasons_of(carried.history, "snap"), tuple(cause.view for cause in carried.causes)
    assert snap.after[0].id != snap.before[0].id, "another packet has won"
    assert snap.without == views != ()
    assert 0 < snap.time_s - snap.since_s < 60
    assert tuple(seen.view for seen in snap.views) == views[:4]
    assert [at for at, _ in snap.chain] == sorted(at for at, _ in snap.chain)
    assert snap.chain[0][0] == snap.since_s
    assert ": relocalised" in " ".join(words for _, words in snap.chain)
    assert snap.camera.shape == carried.session.frame.image.shape


def test_a_snap_is_told_with_its_causes(carried: Carried) -> None:
    session, history, causes = carried.session, carried.history, carried.causes
    event = next(event for event in history.log.events if event.kind == "snap")
    assert event.text.startswith(f"relocalised {words_of(causes)}: (")
    assert sum(cause.share for cause in causes) == pytest.approx(1.0)
    for cause in causes:
        assert 0 <= cause.view < len(session.brain.local_view)
        assert cause.age_s >= session.brain.params.local_view.rest - 1e-6  # younger ones inject nothing


def test_who_was_carried_believes_then_joins_and_what_was_said_adds_up_to_the_odds(carried: Carried) -> None:
    """The bars are changes of the log odds of the place that is believed, from when it was first thought of."""
    kinds = [event.kind for event in carried.history.log.events if event.kind in ("lost", "believes", "joined")]
    assert kinds == ["lost", *["believes"] * (len(kinds) - 2), "joined"]
    why, *_ = reasons_of(carried.history, "believes")
    assert sum(nats for _, nats in why.said) == pytest.approx(carried.odds)
    assert why.since_s == why.said[0][0] < why.said[-1][0] == why.time_s


def test_a_kidnap_that_is_only_suspected_is_marked() -> None:
    """Perhaps it was carried, since image and sonars jumped; and the evaluation counts it as noticed."""
    session = Session(OFFICE, 3)
    log = EventLog(session)
    watch = EventWatch(session, log)
    session.tick()
    session.kidnap()
    session.brain.experience_map.suspect_kidnap()
    watch.watch()
    session.evaluation.kidnaps[-1].carried(session.time_s, False)
    assert [event.text for event in log.events if event.kind == "lost"] == ["image and sonars jumped: kidnapped?"]
    session.tick()
    assert session.evaluation.kidnaps[-1]._noticed


@pytest.mark.parametrize("drives", [True, False])
def test_an_alarm_is_only_suspected_where_driving_may_explain_it(drives: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who stands still would wait for ever for what tells it."""
    session = Session(OFFICE, 3)
    session.drive(0.2 * drives, 0.0)
    for _ in range(20):
        session.tick()
    detector, map_ = session.brain.kidnap_detector, session.brain.experience_map
    alarms = iter([True])
    monkeypatch.setattr(detector, "observe", lambda *_: next(alarms, False))
    detector.sure = False
    session.tick()
    assert map_.suspects_kidnap == drives
    assert session.brain.carried != drives


def test_each_other_place_that_is_believed_after_a_kidnap_is_marked() -> None:
    """*Why there?* is about the last one: the first may have been wrong."""
    session = Session(OFFICE, 3)
    watch, noted = EventWatch(session, EventLog(session)), list[str]()
    map_ = SimpleNamespace(belief=None, submaps=SimpleNamespace(merged=0))
    watch._session = SimpleNamespace(time_s=1.0, brain=SimpleNamespace(experience_map=map_))  # type: ignore[assignment]
    watch._log = SimpleNamespace(note=lambda _kind, text: noted.append(text))  # type: ignore[assignment]
    watch.reasons = SimpleNamespace(believes=lambda _event, _belief: None)  # type: ignore[assignment]
    for x in (None, 0.0, 0.3, None, 0.5, 6.0, 6.2):
        map_.belief = None if x is None else SimpleNamespace(pose=Pose2(x, 0.0, 0.0), log_odds=2.0)
        watch._watch_belief(True)
    assert [text.split(" 0.0 s")[0] for text in noted] == ["a place", "another place"]


def test_a_closed_loop_is_marked_and_says_what_was_linked(carried: Carried) -> None:
    closures, map_ = reasons_of(carried.history, "closure"), carried.session.brain.experience_map
    assert closures
    births = carried.session.evaluation.births(len(map_))
    for closure in closures:
        start, end = closure.experiences
        by_echoes = closure.text.startswith("beside")
        assert ((end, start) if by_echoes else (start, end)) in map_.transitions.row_of
        assert births[start, 3] - births[end, 3] > 0, "back at an older one"
        assert closure.without == tuple(seen.view for seen in closure.views)


def test_no_loop_is_closed_in_the_dark() -> None:
    """By odometry alone the robot believes to be back, and recognises nothing."""
    session = Session(OFFICE, 3)
    watch, known = EventWatch(session, EventLog(session)), MagicMock()
    watch._session = known
    watch._log, watch.reasons, watch.closures = MagicMock(), MagicMock(), MagicMock()
    known.time_s, known.estimate.created, known.brain.lost = 2 * LONG_AGO_S, False, False
    known.brain.echo_closures.count = 0
    known.brain.experience_map.transitions.row_of = {(9, 2)}
    known.evaluation.births.return_value = np.zeros((10, 4))
    marked = list[int]()
    for sees, here in ((False, 9), (False, 2), (True, 9), (True, 2)):
        known.brain.params.local_view.enabled, known.brain.experience_map.here = sees, here
        watch._new = NEW_GROUND
        watch._watch_closures()
        marked.append(watch.closures.closed.call_count)
    assert marked == [0, 0, 0, 1]


def test_a_false_look_says_which_view_was_right() -> None:
    history = watched(Session(OFFICE, 5, Config().with_value("local_view.false_positives", 0.1)), 200)
    false = reasons_of(history, "false")
    assert false
    for look in false:
        reported, right = (seen.view for seen in look.views)
        assert f"view {reported} reported instead of {right}" in look.text
        assert look.without == (reported,)
    with pytest.raises(
        ValueError, match="event must be a recent snap, closure, false positive, loss or belief, got 777"
    ):
        history.events.reasons.of(777)
