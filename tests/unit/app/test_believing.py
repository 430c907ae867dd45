"""A robot that was carried acts where it believes itself to be, and what it learns meanwhile belongs to where it maps."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.session import is_lost
from app.views.belief import belief_of, possible_places, state_of
from app.views.history import History
from ratslam_core import Pose2

from .sessions import a_session

pytestmark = pytest.mark.slow


def test_who_believes_is_not_lost_and_what_is_made_is_of_the_submap() -> None:
    session = a_session(seed=6)
    map_, cells, apart = session.brain.experience_map, session.brain.pose_cells, list[float]()
    for _ in range(1800):
        session.tick()
        if (state := state_of(map_, map_.robot, map_.submaps.current)) is not None:
            apart.append(cells.cells_apart(state[0], state[1], cells.winner.x, cells.winner.y))
    # a place stands for the state that the pose cells have there: the winning packet's, to within an experience's zone
    assert len(apart) > 1700
    assert np.median(apart) < 1
    assert np.quantile(apart, 0.9) < 2 * map_.params.zone_xy
    assert state_of(map_, map_.robot.compose(Pose2(50.0, 0.0, 0.0)), map_.submaps.current) is None
    assert state_of(map_, map_.robot, 7) is None
    known = len(map_)
    history, births = History(session), session.evaluation.births(known)
    session.kidnap()
    believed = made = 0
    while session.time_s < 400 and not (believed and not map_.carried):
        session.tick()
        history.watch()
        if not map_.carried:
            continue
        told = belief_of(session)
        assert math.isinf(told.off_m)
        assert told.places == len(possible_places(map_))
        assert is_lost(session) == (map_.belief is None) == (told.odds is None)
        if map_.belief is not None:
            believed += 1
            made += session.estimate.created
            assert map_.active < known <= map_.here
            assert session.estimate.experience == map_.active
            assert told.odds is not None
            assert told.odds > 1
        if session.estimate.created:
            assert session.evaluation.births(len(map_))[map_.here, 3] == session.time_s
    assert min(believed, made) >= 5
    assert np.array_equal(session.evaluation.births(known), births, equal_nan=True)
    assert not session.brain.lost
    assert [event.kind for event in history.log.events].count("lost") == 1  # however often the belief changes
