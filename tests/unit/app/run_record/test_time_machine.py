"""Any moment of a run can be made again, bit for bit, and gone on from; looking back changes nothing."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from app.engine import work
from app.engine.engine import Engine
from app.engine_thread import EngineThread
from app.run_record.keyframes import PastRoom, TimeMachine
from app.session import Session
from app.views.history import History
from sim2d import load_world
from tests.patience import PATIENCE_S
from tests.unit.app.engine_threads import accept, snapshot
from tests.unit.app.engines import an_engine, tell
from tests.unit.app.sessions import OFFICE
from web import messages as m

pytestmark = pytest.mark.slow


def an_old_engine(ticks: int) -> Engine:
    engine = an_engine(OFFICE)
    run_for(engine, ticks)
    return engine


def run_for(engine: Engine, ticks: int) -> None:
    for _ in range(ticks):
        engine.tick()


def time_of(engine: Engine) -> m.TimeView:
    view = engine.snapshot().time
    assert view is not None
    return view


def state_of(session: Session, history: History) -> tuple[object, ...]:
    series, trails = history.series, history.trails
    counts = (series.error_map_m, series.coverage, series.map_turn_rad, trails.robot.tolist(), trails.packet.tolist())
    return session.state_hash(), *counts, history.visits.views.of(0)


def test_any_moment_is_as_it_was() -> None:
    session = Session(load_world("living"), 3)
    history = History(session)
    machine = TimeMachine(session, history)
    session.on_order = machine.note_order
    rng, were = random.Random(4), dict[int, tuple[object, ...]]()
    for tick in range(700):
        if rng.random() < 0.02:
            were[tick] = state_of(session, history)
        if tick == 330:
            session.kidnap()
        if tick in (100, 500):
            session.set_mode("manual" if tick == 100 else "explore")
            session.drive(0.4, 0.0)  # against a wall, sooner or later
        if tick == 160:
            session.set_mode("explore")
        session.tick()
        history.watch()
        machine.ticked()
    end = session.state_hash()
    for tick in rng.sample(sorted(were), 9):
        moment = machine.moment(machine.live, tick)
        assert state_of(moment.session, moment.history) == were[tick], tick
    assert session.state_hash() == end
    with pytest.raises(ValueError, match="tick must be from 0 to 700, got 701"):
        machine.moment(machine.live, 701)


@pytest.mark.long
def test_keyframes_stay_under_their_budget_and_the_first_is_never_dropped() -> None:
    session = Session(OFFICE, 5)
    history = History(session)
    machine = TimeMachine(session, history, PastRoom(8_000_000))
    hashes = {}
    for tick in range(2500):
        if tick % 500 == 7:
            hashes[tick] = session.state_hash()
        session.tick()
        history.watch()
        machine.ticked()
    ticks = [frame.tick for frame in machine.live.keyframes]
    assert machine.nbytes <= 8_000_000
    assert (ticks[0], ticks[-1]) == (0, 2500)
    assert len(ticks) < 26  # one every ten seconds, if there were room for all
    for tick, state_hash in hashes.items():
        assert machine.moment(machine.live, tick).session.state_hash() == state_hash


def test_looking_back_pauses_and_changes_nothing() -> None:
    engine = an_old_engine(200)
    tell(engine, type="kidnap")
    run_for(engine, 100)
    now, events = engine.run.session.state_hash(), engine.run.event_log.events
    engine.running = True
    tell(engine, type="seek", time_s=10.0)
    past, time = engine.snapshot(), time_of(engine)
    assert (past.tick, past.time_s, past.running, past.events) == (100, 10.0, False, events)
    assert (time.past, time.end_tick, time.end_s) == (True, 300, 30.0)
    for fields in ({"type": "kidnap"}, {"type": "drive", "speed": 0.1, "yaw_rate": 0.0}, {"type": "undo_edit"}):
        with pytest.raises(ValueError, match="this is the past: go on from here, or come back to now"):
            tell(engine, **fields)
    tell(engine, type="back_to_now")
    present = engine.snapshot()
    assert (present.tick, present.running) == (300, False)
    assert (engine.run.session.state_hash(), engine.run.event_log.events) == (now, events)


def test_the_past_plays_to_the_present_and_stops_there_and_a_loop_goes_round() -> None:
    engine = an_old_engine(60)
    with pytest.raises(ValueError, match="a loop needs begin_s"):
        tell(engine, type="loop", begin_s=2.0, end_s=2.0)
    tell(engine, type="loop", begin_s=2.0, end_s=2.3)
    tell(engine, type="seek", tick=21)
    seen = []
    for _ in range(6):
        engine.tick()
        seen.append(engine.snapshot().tick)
    assert seen == [22, 23, 20, 21, 22, 23]
    tell(engine, type="loop")
    run_for(engine, 2)
    assert engine.snapshot().tick == 25
    tell(engine, type="seek", tick=57)
    tell(engine, type="resume")
    assert engine.running
    run_for(engine, 2)
    assert engine.snapshot().tick == 59
    tell(engine, type="seek", tick=50)
    run_for(engine, 9)
    assert engine.running  # it played on from there
    run_for(engine, 1)
    assert (engine.running, engine.time.past, engine.run.session.tick_count) == (False, None, 60)
    tell(engine, type="seek", time_s=1e6)
    assert engine.time.past is None


def test_a_branch_without_the_kidnap_is_the_run_that_was_never_kidnapped() -> None:
    engine, calm = an_old_engine(170), an_old_engine(230)
    tell(engine, type="kidnap")
    run_for(engine, 60)
    kidnapped = engine.run.session.state_hash()
    with pytest.raises(ValueError, match="this is the present"):
        tell(engine, type="go_on_from_here")
    tell(engine, type="seek", tick=170)
    tell(engine, type="go_on_from_here")
    assert (engine.running, engine.time.past) == (False, None)
    events = [(event.kind, event.text) for event in engine.run.event_log.events]
    assert events == [("branch", "2 leaves branch 1 here")]
    run_for(engine, 60)
    assert engine.run.session.state_hash() == calm.run.session.state_hash()
    assert time_of(engine).branches == (m.BranchView(1, None, 0.0, 23.0), m.BranchView(2, 1, 17.0, 23.0))
    tell(engine, type="compare_branch", number=1)
    view = time_of(engine)
    assert [(side.number, side.time_s) for side in view.sides] == [(2, 23.0), (1, 23.0)]
    told = "first difference at tick 171; told before it: nothing in 2, kidnap in 1; first view"
    assert view.differs.startswith(told)
    tell(engine, type="seek", tick=160)
    one, other = time_of(engine).sides
    assert (one.time_s, other.time_s) == (16.0, 16.0)
    assert (one.xy == other.xy).all()
    with pytest.raises(ValueError, match="branch 2 is the live one"):
        tell(engine, type="compare_branch", number=2)
    tell(engine, type="seek", tick=90)  # before the branch: of its parent
    assert engine.snapshot().tick == 90
    tell(engine, type="change_branch", number=1)
    assert engine.run.session.state_hash() == kidnapped
    with pytest.raises(ValueError, match="there is no branch 3"):
        tell(engine, type="change_branch", number=3)
    tell(engine, type="seek", tick=200)
    tell(engine, type="change_branch", number=2)
    run_for(engine, 1)
    assert engine.snapshot().tick == 231
    tell(engine, type="seek", tick=229)
    run_for(engine, 2)
    assert engine.run.session.tick_count == 231
    tell(engine, type="reset")
    assert len(time_of(engine).branches) == 1


def test_a_moment_that_cannot_be_played_again_leaves_the_present_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    engine = an_old_engine(40)
    before = engine.run.session.state_hash()
    tell(engine, type="seek", tick=10)
    tell(engine, type="resume")

    def spoilt(*_: object) -> bool:
        raise RuntimeError("spoilt")

    with monkeypatch.context() as patch:
        patch.setattr(engine.time, "play", spoilt)
        assert engine.tick()
    assert (engine.time.past, engine.fault, engine.running) == (None, None, False)
    assert engine.run.event_log.events[-1].text == "the past could not be played again: RuntimeError: spoilt"
    assert engine.run.session.state_hash() == before
    tell(engine, type="resume")
    engine.tick()
    assert engine.run.session.tick_count == 41


def test_a_long_way_is_gone_in_slices_and_a_newer_wish_ends_it(
    start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The slices are as short as they can be, so that nothing depends on how fast the machine is."""
    engine = start()
    accept(engine, m.Step(type="step", ticks=140))
    engine._engine.slices.first_s = 0.0
    monkeypatch.setattr(work, "SLICE_S", 0.0)
    first = engine.submit(m.Seek(type="seek", tick=139))
    second = engine.submit(m.Seek(type="seek", tick=120))
    assert isinstance(first.result(PATIENCE_S), m.Accepted)
    assert second.result(PATIENCE_S) == m.Accepted(120)
    now = snapshot(engine)
    assert now.time is not None
    assert (now.tick, now.running, now.time.doing) == (120, False, "")
    dropped = engine.submit(m.Seek(type="seek", tick=130))
    accept(engine, m.BackToNow(type="back_to_now"))
    assert isinstance(dropped.result(PATIENCE_S), m.Accepted)
    assert snapshot(engine).tick == 140
