"""Going back in a recording: any moment is as it was, and what goes on from it is what would have come."""

from __future__ import annotations

import math
import random

import pytest
from PIL import Image

from app.engine.engine import Engine
from app.recordings.opening import open_recording
from app.recordings.playing import Player
from app.recordings.recording import About, Moment
from app.run_record import keyframes
from app.run_record.keyframes import TimeMachine
from app.session import Session, played_session
from app.sources.recorded import Reel
from app.views.history import History
from tests.unit.app.engines import an_engine, of_kind, run_for, tell
from tests.unit.app.made_recordings import MadeRecording, recorded
from tests.unit.app.made_scans import ANGLES, room
from tests.unit.app.sessions import OFFICE

pytestmark = pytest.mark.slow

TICKS = 240


@pytest.fixture(scope="module")
def made() -> MadeRecording:
    return recorded(TICKS)


@pytest.fixture(scope="module")
def player(made: MadeRecording) -> Player:
    return Player(made, 1)


@pytest.fixture(scope="module")
def pictures(made: MadeRecording, tmp_path_factory: pytest.TempPathFactory) -> Player:
    """The pictures of a drive in a folder, one of which is broken, with a CSV of gyro and throttle; one comes late."""
    folder, rows = tmp_path_factory.mktemp("pictures"), ["image,time_s,yaw_rate,throttle"]
    for k, moment in enumerate(made.moments()):
        assert moment.image is not None
        Image.fromarray(moment.image).save(folder / f"{k}.png")
        late = 4.0 if k > 150 else 0.0
        rows.append(f"{k}.png,{k / 10 + late},{moment.yaw_rate},{0.2 if moment.speed else 0.0}")
    (folder / "90.png").write_bytes(b"no picture")
    (folder / "drive.csv").write_text("\n".join(rows))
    return Player(open_recording(folder), 1)


@pytest.fixture(scope="module")
def scans() -> Player:
    """A robot with a laser goes round in a room of 8 m x 5 m, once and a half."""
    moments = list[Moment]()
    for k in range(100):
        heading = 0.1 * k
        ranges = room(0.8 * math.sin(heading), 0.8 * (1 - math.cos(heading)), heading)
        moments.append(Moment(k, float(k), 1.0, speed=0.08 * (k > 0), yaw_rate=0.1 * (k > 0), ranges_m=ranges))
    made = MadeRecording(moments, "scans")
    has = frozenset({"speed", "yaw rate", "ranges"})
    made.about = About("scans", "made", 100, 99.0, has, None, tuple(ANGLES.tolist()), 20.0)
    return Player(made, 1)


def state_of(session: Session) -> tuple[object, ...]:
    return session.state_hash(), session.frame.image.tobytes(), session.time_s, session.truth, session.source.over


@pytest.mark.parametrize("name", ["player", "pictures", "scans"])
def test_any_moment_is_as_it_was(name: str, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """20 random moments of each, with orders in between, looked at in any order."""
    monkeypatch.setattr(keyframes, "AGAIN_MS", 0.0)  # as of a recording whose moments take long: each 60th is kept
    monkeypatch.setattr(keyframes, "LOOK_AFTER", 60)
    session = played_session(request.getfixturevalue(name))
    history = History(session)
    past = TimeMachine(session, history)
    session.on_order = past.note_order
    rng, were = random.Random(5), dict[int, tuple[object, ...]]()
    chosen = set(rng.sample(range(90 if name == "scans" else TICKS - 5), 20))
    while not session.source.over:
        if session.tick_count in chosen:
            were[session.tick_count] = state_of(session)
        if session.tick_count == 40:
            session.set_parameters({"pose_cells.inhibit": 0.0021})
            session.tag("here")
        if session.tick_count == 70:
            session.forget_view(0)
        session.tick()
        history.watch()
        past.ticked()
    end = session.state_hash()
    assert [frame.tick for frame in past.live.keyframes] == list(range(0, session.tick_count + 1, 60))
    for tick in rng.sample(sorted(were), 20):
        again = past.moment(past.live, tick).session
        assert isinstance(again, Session)
        assert state_of(again) == were[tick]
    assert session.state_hash() == end


# ------------------------------------------------------------ in the engine


def playing(player: Player, ticks: int) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_recording(player)
    run_for(engine, ticks)
    return engine


def test_looking_back_pauses_and_changes_nothing(player: Player, monkeypatch: pytest.MonkeyPatch) -> None:
    engine = playing(player, 42)
    then = engine.run.session.state_hash()
    run_for(engine, 58)
    now = engine.run.session.state_hash()
    engine.running = True
    tell(engine, type="seek", time_s=4.2)
    past = engine.snapshot()
    assert (past.tick, past.time_s, past.running) == (42, 4.2, False)
    assert past.time is not None
    assert (past.time.past, past.time.end_tick, past.time.begin_s) == (True, 100, 0.0)
    assert engine.shown.session.state_hash() == then, "the moment is what playing up to it made"
    with pytest.raises(ValueError, match="this is the past"):
        tell(engine, type="inject_packet", x=3, y=4)

    def is_now() -> bool:
        return (engine.time.past, engine.snapshot().tick, engine.run.session.state_hash()) == (None, 100, now)

    for order in ({"type": "back_to_now"}, {"type": "seek", "tick": 100}):  # its last moment is the present
        tell(engine, **order)
        assert is_now()
        tell(engine, type="seek", time_s=4.2)
    tell(engine, type="back_to_now")

    def gone(*_: object) -> Moment:
        raise ValueError("made: the file is not there any more")

    monkeypatch.setattr(Reel, "at", gone)
    with pytest.raises(ValueError, match="the file is not there any more"):
        tell(engine, type="seek", tick=50)
    assert is_now(), "a moment that cannot be read again leaves it as it is"


def test_the_past_plays_to_the_present_also_at_the_end_of_the_recording(player: Player) -> None:
    engine = playing(player, TICKS - 1)
    assert engine.run.session.source.over
    tell(engine, type="seek", tick=TICKS - 4)
    tell(engine, type="resume")
    run_for(engine, 2)
    assert (engine.running, engine.snapshot().tick) == (True, TICKS - 2)
    run_for(engine, 1)
    assert (engine.running, engine.time.past) == (False, None)
    assert len(of_kind(engine, "recording")) == 1, "the past does not end once more"
    with pytest.raises(ValueError, match="the recording has ended"):
        tell(engine, type="resume")


def test_a_branch_without_a_change_comes_out_the_same_and_one_with_it_does_not(player: Player) -> None:
    engine = playing(player, 120)
    first, config = engine.run.session.state_hash(), engine.next_config
    for value, same in ((None, True), (0.0035, False)):
        tell(engine, type="seek", tick=60)
        tell(engine, type="go_on_from_here")
        if value is not None:
            tell(engine, type="set_parameter", name="pose_cells.inhibit", value=value)
        run_for(engine, 60)
        assert (engine.run.session.state_hash() == first) == same
        assert engine.fault is None
    tell(engine, type="compare_branch", number=1)
    shown = engine.snapshot().time
    assert shown is not None
    assert [side.number for side in shown.sides] == [3, 1]
    assert shown.differs.startswith("first difference at tick 61; told before it: set_parameters in 3, nothing in 1")
    tell(engine, type="change_branch", number=1)
    assert engine.run.session.state_hash() == first
    tell(engine, type="compare_branch", number=2)
    shown = engine.snapshot().time
    assert shown is not None
    assert "are the same up to tick 120" in shown.differs
    tell(engine, type="reset")
    assert engine.run.session.recording is not None
    tell(engine, type="reset", world="office")
    assert (engine.run.session.recording, engine.run.session.config) == (None, config), "left for the office"


def test_looping_over_uneven_times(pictures: Player) -> None:
    engine = playing(pictures, 200)
    begin_s, end_s = 4.0 + 151 / 10, 4.0 + 152.5 / 10
    tell(engine, type="seek", time_s=15.5)
    assert engine.snapshot().time_s == 15.0, "the last moment before the gap"
    tell(engine, type="loop", begin_s=begin_s, end_s=end_s)
    tell(engine, type="seek", time_s=begin_s)
    begin = engine.snapshot()
    assert begin.time_s == pytest.approx(begin_s)
    tell(engine, type="resume")
    run_for(engine, 3)
    assert engine.snapshot().tick == begin.tick, "past the end of the loop it begins anew"
