"""A loop closure keeps the map as it was the tick before and as its correction left it; nothing of it reaches the session."""

from __future__ import annotations

import numpy as np
import pytest

from app.session import Session
from app.views.events import SETTLES_S
from app.views.history import History
from sim2d import load_world

TICKS = 1050


def test_a_closure_has_the_map_before_it_and_as_its_correction_left_it() -> None:
    """A drive around a block until the first loop has closed and settled, with the map after each tick."""
    session = Session(load_world("loop"), 3)
    history, maps = History(session), [session.brain.experience_map.poses[:, :2].astype(np.float32)]
    for _ in range(TICKS):
        session.tick()
        history.watch()
        maps.append(session.brain.experience_map.poses[:, :2].astype(np.float32))
    closures = history.log.closures
    for closure, following in zip(closures, [*closures[1:], None], strict=True):
        known = len(closure.before_xy)
        assert np.array_equal(closure.before_xy, maps[round(closure.time_s / 0.1) - 1])
        assert max(closure.links.max(), closure.end) < known
        last = min(session.time_s, closure.time_s + SETTLES_S, following.time_s if following else np.inf)
        until = maps[: round(last / 0.1) + 1]
        assert any(np.array_equal(closure.after_xy, step[:known]) for step in until[-12:] if len(step) >= known)
        assert closure.moved_m == pytest.approx(float(np.hypot(*(closure.after_xy - closure.before_xy).T).max()))
    assert max(closure.moved_m for closure in closures) > 0.1  # the block was not where it was believed to be
    first = closures[0]  # what is kept of it belongs to its time
    assert history.log.until(first.time_s - 0.1, session).closures == ()
    assert history.log.until(first.time_s, session).closures == (first,)
    assert not any(array.flags.writeable for array in (first.before_xy, first.after_xy, first.links))


def test_a_loop_that_echoes_close_is_told_as_such() -> None:
    """No view is said to have been recognised, and the new experience is linked to the old one."""
    session = Session(load_world("office"), 3)
    history, echoes = History(session), session.brain.echo_closures
    tied = set[tuple[int, int]]()
    while not any(event.kind == "closure" and event.text.startswith("beside") for event in history.log.events):
        session.tick()
        history.watch()
        tied |= {echoes.last} if echoes.count else set()
        assert session.time_s < 300
    event = history.log.events[-1]
    why, closure = history.log.why[event.number], history.log.closures[-1]
    assert (closure.end, closure.start) in tied
    assert why.experiences == (closure.start, closure.end)
    assert not why.views
    assert any("walls sound" in words and f"experience {closure.end}" in words for _, words in why.chain)
