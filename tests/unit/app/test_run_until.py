"""`run_until`: it stops in the very tick, says so, and the run is the one that it is without waiting."""

from __future__ import annotations

import pytest

from app.engine.engine import Engine
from app.evaluation.agreement import Coverage
from app.protocol.conditions import Waiting, read_until
from app.session import Session
from app.views.events import NOTHING_NEW
from app.views.history import History

from .engines import an_engine, tell
from .sessions import OFFICE


def run_until(engine: Engine, what: str, most: int = 5000, **fields: object) -> tuple[str, str]:
    """Give the command and run ahead; returns for what it waited, and how that ended."""
    tell(engine, type="run_until", what=what, **fields)
    assert engine.runs_ahead
    while engine.runs_ahead and most > 0:
        engine.run_ahead(0.01)
        most -= 1
    return state_of(engine)


def state_of(engine: Engine) -> tuple[str, str]:
    until = engine.snapshot().until
    assert until is not None
    return until.what, until.state


def test_it_stops_exactly_when_the_robot_comes_to_the_place() -> None:
    by_hand = Session(OFFICE, 3)
    waiting = Waiting(read_until({"what": "place", "place": (2.0, 1.0)}), by_hand, History(by_hand))
    while not waiting.met():
        by_hand.tick()
    engine = an_engine(OFFICE, 3)
    assert run_until(engine, "place", x=2.0, y=1.0) == ("place", "met")
    assert not engine.running
    assert engine.run.session.tick_count == by_hand.tick_count
    assert engine.run.session.state_hash() == by_hand.state_hash()
    assert "the robot comes to the place, after" in engine.run.event_log.events[-1].text
    engine.tick()
    assert engine.snapshot().until is None


def test_when_it_comes_to_a_place_by_name_its_map_knows_that_place() -> None:
    engine = an_engine(OFFICE, 3)
    assert run_until(engine, "place", place="kitchen") == ("place", "met")
    assert {place.name: place.map_xy is not None for place in engine.snapshot().places}["kitchen"]


def test_it_says_when_it_did_not_happen_in_time() -> None:
    engine = an_engine(OFFICE)
    assert run_until(engine, "closure", within_s=2.0) == ("closure", "too late")
    assert engine.run.session.tick_count == 20
    assert "did not happen within 2 s" in engine.run.event_log.events[-1].text


def test_a_kidnapped_robot_is_run_until_it_is_lost() -> None:
    engine = an_engine(OFFICE)
    for _ in range(300):
        engine.tick()
    tell(engine, type="kidnap", x=9.0, y=7.0)
    assert run_until(engine, "lost", within_s=60) == ("lost", "met")
    assert engine.run.history.events.lost


def test_a_packet_put_in_makes_two() -> None:
    engine = an_engine(OFFICE)
    x = int(engine.run.session.brain.pose_cells.winner.x + 20) % 64
    tell(engine, type="inject_packet", x=x, y=10, share=0.4)
    assert run_until(engine, "packets", count=2, within_s=5) == ("packets", "met")
    assert engine.run.session.tick_count == 1


def test_it_runs_until_everything_is_explored() -> None:
    """It says so, and goes on by visiting old places; one that explores by chance cannot tell."""
    engine = an_engine(OFFICE)
    assert run_until(engine, "explored", within_s=1800) == ("explored", "met")
    session, events = engine.run.session, engine.run.event_log.events
    covered = Coverage().follow(session.simulator.free_space, session.evaluation.path)
    assert covered > 0.8  # 0.88 to 0.99 with eight seeds
    assert NOTHING_NEW in [event.text for event in events]
    engine.run.session.set_parameter("pilot.seek", False)
    with pytest.raises(ValueError, match=r"switch pilot\.seek on"):
        tell(engine, type="run_until", what="explored")


def test_what_cannot_happen_is_refused_in_a_sentence_and_a_pause_breaks_it_off() -> None:
    engine = an_engine(OFFICE)
    refused: list[tuple[dict[str, object], str]] = [
        ({"what": "found again"}, "kidnap it first"),
        ({"what": "goal reached"}, "has no goal"),
        ({"what": "place"}, '"place" goes with place'),
        ({"what": "place", "place": "castle"}, "no place 'castle'; expected one of: kitchen"),
        ({"what": "place", "place": "kitchen", "x": 1.0, "y": 1.0}, "either place or x and y"),
        ({"what": "lost", "place": "kitchen"}, "nothing else does"),
    ]
    for fields, words in refused:
        with pytest.raises(ValueError, match=words):
            tell(engine, type="run_until", **fields)
        assert not engine.runs_ahead
    tell(engine, type="run_until", what="closure")
    engine.run_ahead(0.0)
    tell(engine, type="pause")
    assert (state_of(engine), engine.runs_ahead) == (("closure", "broken off"), False)
