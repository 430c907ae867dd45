"""Which places of the office the map knows: those at which the robot has made an experience, where the map has it."""

from __future__ import annotations

import numpy as np

from app.views.office import REACH_M, known_places

from .sessions import OFFICE, a_session


def test_a_place_is_known_where_an_experience_was_made_near_it_and_the_goal_there_is_one() -> None:
    session, known = a_session(seed=5), set[bool]()
    for _ in range(4):
        for _ in range(400):
            session.tick()
        map_, places = session.brain.experience_map, known_places(session)
        births = session.evaluation.births(len(map_.poses))
        assert [place.name for place in places] == [place.name for place in OFFICE.places]
        for place in places:
            away = np.hypot(births[:, 0] - place.x, births[:, 1] - place.y)
            assert (place.map_xy is not None) == bool((away <= REACH_M).any())
            known.add(place.map_xy is not None)
            if place.map_xy is not None:
                assert tuple(map_.poses[int(away.argmin()), :2].tolist()) == place.map_xy
                assert away[session.set_goal(*place.map_xy)] <= REACH_M
                session.cancel_goal()
    assert known == {True, False}  # some soon, some later


def test_at_first_no_place_is_known_but_one_where_the_robot_stands() -> None:
    session = a_session()
    truth = session.truth
    assert truth is not None
    for place in known_places(session):
        near = np.hypot(place.x - truth.x, place.y - truth.y) <= REACH_M
        assert near or place.map_xy is None
