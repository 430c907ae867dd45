"""The ring under a dragged robot and the answer to the command agree, since both ask `RobotFit`."""

from __future__ import annotations

import re
from functools import lru_cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.session import Session
from app.views.history import History
from app.views.snapshots import Snapshots
from sim2d import load_world
from web.messages import Snapshot


@lru_cache(maxsize=1)
def session() -> Session:
    """The living office after eight seconds, a door half shut, people on their way."""
    made = Session(load_world("living"), 3)
    made.simulator.set_door("laboratory door", False)
    for _ in range(80):
        made.tick()
    made.simulator.set_door("meeting room door", False)
    made.tick()
    return made


@lru_cache(maxsize=1)
def snapshot() -> Snapshot:
    made = Snapshots(session(), History(session()), 1, ())
    return made.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)


def ring(x: float, y: float) -> str | None:
    """What the viewer is told about a place; None: the ring is teal."""
    return snapshot().no_room(x, y)


def command(x: float, y: float) -> str | None:
    try:
        session().kidnap(x, y, 0.0)
    except ValueError as error:
        return str(error)
    return None


near_things = st.sampled_from(
    [(7.0, 3.3), (12.9, 4.0), (11.5, 5.4), (10.9, 5.4), (7.0, 5.4), (6.4, 5.4), (1.9, 5.9), (2.5, 5.4), (0.3, 0.3)]
).flatmap(lambda at: st.tuples(*(st.floats(at[k] - 0.8, at[k] + 0.8) for k in (0, 1))))
near_people = st.tuples(st.integers(0, 2), st.floats(-0.6, 0.6), st.floats(-0.6, 0.6)).map(
    lambda who: tuple((session().simulator.actors.walkers.xy[who[0]] + who[1:]).tolist())
)
anywhere = st.tuples(st.floats(-1.0, 15.0), st.floats(-1.0, 10.0))


@settings(max_examples=400)
@given(near_things | near_people | anywhere)
@pytest.mark.slow
def test_what_the_ring_says_is_what_the_command_answers(place: tuple[float, float]) -> None:
    assert ring(*place) == command(*place)


def test_each_of_them_says_what_is_in_the_way() -> None:
    actors = session().simulator.actors
    x1, y1, x2, y2 = actors.segments[2].tolist()
    ada = tuple(actors.walkers.xy[0].tolist())
    for place, words in (
        (ada, r"is 0\.000 m from person 'Ada'; the robot needs 0\.22 m"),
        ((7.0, 3.3), r"is 0\.000 m from box 'parcel'"),
        (((x1 + x2) / 2, (y1 + y2) / 2 - 0.1), r"is 0\.\d+ m from doors\[2\] \(laboratory door\)"),
        ((0.1, 0.5), r"from walls\[\d+\]"),
        ((-1.0, 2.0), "is outside of living"),
    ):
        said = command(*place)
        assert said is not None
        assert re.search(words, said)
        assert ring(*place) == said
