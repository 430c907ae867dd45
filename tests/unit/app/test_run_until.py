"""`run_until`: it stops in the very tick, says so, and the run is the one that it is without waiting."""

from __future__ import annotations

import pytest

from app.lessons.conditions import Waiting, read_until
from app.session import Session
from app.views.history import History

from .engines import an_engine, tell
from .sessions import OFFICE


def runs(engine, most: int = 5000) -> None:
    while engine.runs_ahead and most > 0:
        engine.run_ahead(0.01)
        most -= 1


def state_of(engine) -> tuple[str, str]:
    until = engine.snapshot().until
    assert until is not None
    return until.what, until.state


def test_it_stops_exactly_when_the_robot_comes_to_the_place() -> None:
    by_hand = Session(OFFICE, 3)
    history = History(by_hand)
    waiting = Waiting(read_until({"what": "place", "place": (2.0, 1.0)}), by_hand, history)
    while not waiting.met():
        by_hand.tick()
    engine = an_engine(OFFICE, 3)
    tell(engine, type="run_until", what="place", x=2.0, y=1.0)
    assert engine.runs_ahead
    runs(engine)
    assert (state_of(engine), engine.running) == (("place", "met"), False)
    assert engine.run.session.tick_count == by_hand.tick_count
    assert engine.run.session.state_hash() == by_hand.state_hash()
    assert "the robot comes to the place, after" in engine.run.event_log.events[-1].text
    engine.tick()
    assert engine.snapshot().until is None


def test_it_says_when_it_did_not_happen_in_time() -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="run_until", what="closure", within_s=2.0)
    runs(engine)
    assert (state_of(engine), engine.run.session.tick_count) == (("closure", "too late"), 20)
    assert "did not happen within 2 s" in engine.run.event_log.events[-1].text


def test_a_kidnapped_robot_is_run_until_it_is_lost() -> None:
    engine = an_engine(OFFICE)
    for _ in range(300):
        engine.tick()
    tell(engine, type="kidnap", x=9.0, y=7.0)
    tell(engine, type="run_until", what="lost", within_s=60)
    runs(engine)
    assert state_of(engine) == ("lost", "met")
    assert engine.run.history.events.lost


def test_a_packet_put_in_makes_two() -> None:
    engine = an_engine(OFFICE)
    cells = engine.run.session.brain.pose_cells
    tell(engine, type="inject_packet", x=int(cells.winner.x + 20) % 64, y=10, share=0.4)
    tell(engine, type="run_until", what="packets", count=2, within_s=5)
    runs(engine)
    assert (state_of(engine), engine.run.session.tick_count) == (("packets", "met"), 1)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"what": "found again"}, "kidnap it first"),
        ({"what": "goal reached"}, "has no goal"),
        ({"what": "place"}, '"place" goes with place'),
        ({"what": "place", "place": "castle"}, "no place 'castle'; expected one of: kitchen"),
        ({"what": "place", "place": "kitchen", "x": 1.0, "y": 1.0}, "either place or x and y"),
        ({"what": "lost", "place": "kitchen"}, "nothing else does"),
    ],
)
def test_what_cannot_happen_is_refused_in_a_sentence(fields: dict[str, object], words: str) -> None:
    engine = an_engine(OFFICE)
    with pytest.raises(ValueError, match=words):
        tell(engine, type="run_until", **fields)
    assert not engine.runs_ahead


def test_a_pause_breaks_it_off() -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="run_until", what="closure")
    engine.run_ahead(0.0)
    tell(engine, type="pause")
    assert state_of(engine) == ("closure", "broken off")
    assert not engine.runs_ahead
