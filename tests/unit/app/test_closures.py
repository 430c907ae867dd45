"""A loop closure keeps the map as it was the tick before and as its correction left it; nothing of it reaches the session."""

from __future__ import annotations

import numpy as np
import pytest

from app.session import Session
from app.views.closures import SETTLES_S
from app.views.history import History
from sim2d import load_world
from web.messages import Closure

TICKS = 1050


@pytest.fixture(scope="module")
def closed() -> tuple[History, Session, list[np.ndarray]]:
    """A drive around a block until the first loop has closed and settled, with the map after each tick."""
    session = Session(load_world("loop"), 7)
    history, maps = History(session), [session.brain.experience_map.poses[:, :2].astype(np.float32)]
    for _ in range(TICKS):
        session.tick()
        history.watch()
        maps.append(session.brain.experience_map.poses[:, :2].astype(np.float32))
    return history, session, maps


def tick_of(closure: Closure) -> int:
    return round(closure.time_s / 0.1)


def test_it_has_the_map_of_the_tick_before(closed: tuple[History, Session, list[np.ndarray]]) -> None:
    history, _, maps = closed
    assert history.log.closures
    for closure in history.log.closures:
        assert np.array_equal(closure.before_xy, maps[tick_of(closure) - 1])
        assert closure.links.max() < len(closure.before_xy)
        assert closure.end < len(closure.before_xy)


def test_it_has_the_map_as_its_correction_left_it(closed: tuple[History, Session, list[np.ndarray]]) -> None:
    history, session, maps = closed
    for closure, following in zip(history.log.closures, [*history.log.closures[1:], None], strict=True):
        last = min(session.time_s, closure.time_s + SETTLES_S, following.time_s if following else np.inf)
        until = maps[: round(last / 0.1) + 1]
        known = [step[: len(closure.before_xy)] for step in until[-12:] if len(step) >= len(closure.before_xy)]
        assert any(np.array_equal(closure.after_xy, step) for step in known)
        moved = np.hypot(*(closure.after_xy - closure.before_xy).T).max()
        assert closure.moved_m == pytest.approx(float(moved))
    assert (
        max(closure.moved_m for closure in history.log.closures) > 0.2
    )  # the block was not where it was believed to be


def test_what_is_kept_of_it_belongs_to_its_time(
    closed: tuple[History, Session, list[np.ndarray]],
) -> None:
    history, session, _ = closed
    first = history.log.closures[0]
    assert history.log.until(first.time_s - 0.1, session).closures == ()
    assert history.log.until(first.time_s, session).closures == (first,)
    for array in (first.before_xy, first.after_xy, first.links):
        assert not array.flags.writeable
