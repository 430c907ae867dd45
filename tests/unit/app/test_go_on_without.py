"""What would have come of it without the views that led to a snap: another branch, from before they did."""

from __future__ import annotations

import pytest

from .engines import an_engine, of_kind, run_for, tell
from .sessions import OFFICE

pytestmark = pytest.mark.slow


def test_without_the_views_that_led_to_it_there_is_no_such_snap() -> None:
    engine = an_engine(OFFICE, 4)
    run_for(engine, 2400)
    tell(engine, type="kidnap")
    while not (snaps := of_kind(engine, "snap")):
        run_for(engine, 1)
        assert engine.run.session.time_s < 600, "it never relocalised"
    why = engine.run.history.events.reasons.of(snaps[0].number)
    end, views, old = engine.run.session.state_hash(), why.without, engine.run
    tell(engine, type="go_on_without", event=snaps[0].number)
    session = engine.run.session
    assert (engine.run is old, engine.running) == (False, False)
    assert why.since_s - 0.21 < session.time_s < why.since_s
    assert all(len(session.brain.view_links.of(view)[0]) == 0 for view in views)
    while session.time_s < why.time_s:
        run_for(engine, 1)
    assert of_kind(engine, "snap") == []
    assert f"view {', '.join(map(str, views))}" in of_kind(engine, "branch")[-1].text
    tell(engine, type="change_branch", number=1)
    assert engine.run.session.state_hash() == end, "the run as it was stays"


def test_what_was_not_led_to_by_a_view_is_refused() -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 20)
    words = "event must be a recent snap, closure, false positive, loss or belief, got 7"
    with pytest.raises(ValueError, match=words):
        tell(engine, type="go_on_without", event=7)
    assert engine.run.session.tick_count == 20


def test_who_inspects_what_is_not_there_yet_at_an_earlier_moment_sees_nothing_of_it() -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 100)
    tell(engine, type="inspect", experience=len(engine.run.session.brain.experience_map) - 1)
    assert engine.snapshot().inspected is not None
    tell(engine, type="seek", tick=20)
    assert engine.snapshot().inspected is None
    tell(engine, type="back_to_now")
    assert engine.snapshot().inspected is not None
