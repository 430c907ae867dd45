"""The turn of the map on its plate: it follows the office, whether anybody looks or not, and keeps still."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluation import alignment
from app.session import Session
from app.views.history import History
from app.views.map_turn import CALM_RAD, calm
from app.views.snapshots import Snapshots
from sim2d import load_world

ANGLES = st.floats(-math.pi, math.pi)


def apart(a: float, b: float) -> float:
    return abs(math.remainder(a - b, math.tau))


@pytest.mark.parametrize("seed", [5, 9])
def test_a_session_that_nobody_watched_is_shown_as_the_office_lies(seed: int) -> None:
    session = Session(load_world("office"), seed)
    history = History(session)
    turns = [history.series.map_turn_rad]
    for _ in range(410):
        session.tick()
        history.watch()
        turns.append(history.series.map_turn_rad)
    shown = Snapshots(session, history, 1, ()).build(running=True, speed=1.0, real_time_factor=1.0, fault=None)
    true, mapped, _ = session.evaluation.trajectories(session.brain.experience_map)
    assert apart(shown.map_turn_rad, alignment(mapped, true).heading_rad) <= CALM_RAD + 0.02
    assert sum(a != b for a, b in pairwise(turns)) <= 6  # it nearly always stands still


@given(ANGLES, ANGLES)
def test_what_is_shown_is_never_far_from_what_is_wanted(shown: float, wanted: float) -> None:
    assert apart(calm(shown, wanted), wanted) <= CALM_RAD + 1e-9
    assert calm(None, wanted) == pytest.approx(math.remainder(wanted, math.tau))


@given(ANGLES, st.lists(st.floats(-0.49, 0.49), min_size=1, max_size=20))
def test_what_trembles_within_the_limit_turns_once_at_most(middle: float, trembles: list[float]) -> None:
    wanted = [middle + share * CALM_RAD for share in trembles]
    shown, seen = middle + math.pi / 2, set()
    for angle in wanted:
        shown = calm(shown, angle)
        seen.add(shown)
    assert len(seen) == 1
