"""Going back in a recording: any moment is as it was, and what goes on from it is what would have come."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.engine.engine import Engine
from app.played_session import PlayedSession
from app.recordings.opening import open_recording
from app.recordings.playing import Player
from app.recordings.recording import About, Moment, Recording, Wanted, every
from app.time_machine import TimeMachine
from app.views.history import History
from sim2d import load_world
from tests.unit.app.engines import an_engine, tell
from tests.unit.app.made_recordings import MadeRecording, recorded
from web import messages as m

pytestmark = pytest.mark.slow

OFFICE, TICKS = load_world("office"), 240


@pytest.fixture(scope="module")
def made() -> MadeRecording:
    return recorded(TICKS)


@pytest.fixture(scope="module")
def player(made: MadeRecording) -> Player:
    return Player(made, 1)


def pictures(made: MadeRecording, folder: Path) -> Recording:
    """The pictures of a drive in a folder, one of which is broken, with a CSV of gyro and throttle; one comes late."""
    rows = ["image,time_s,yaw_rate,throttle"]
    for k, moment in enumerate(made.moments()):
        assert moment.image is not None
        Image.fromarray(moment.image).save(folder / f"{k}.png")
        late = 4.0 if k > 150 else 0.0
        rows.append(f"{k}.png,{k / 10 + late},{moment.yaw_rate},{0.2 if moment.speed else 0.0}")
    (folder / "90.png").write_bytes(b"no picture")
    (folder / "drive.csv").write_text("\n".join(rows))
    return open_recording(folder)


def scans() -> Recording:
    """A robot with a laser goes round in a room of 8 m x 5 m, once and a half."""
    angles, moments = np.radians(np.arange(-90.0, 90.0, 2.0)), list[Moment]()
    for k in range(100):
        heading = 0.1 * k
        x, y = 0.8 * math.sin(heading), 0.8 * (1 - math.cos(heading))
        c, s = np.cos(angles + heading), np.sin(angles + heading)
        with np.errstate(divide="ignore"):
            ahead = np.where(c > 0, (4.5 - x) / c, (-3.5 - x) / c)
            aside = np.where(s > 0, (3.0 - y) / s, (-2.0 - y) / s)
        ranges = np.minimum(np.abs(ahead), np.abs(aside))
        moments.append(Moment(k, float(k), 1.0, speed=0.08 * (k > 0), yaw_rate=0.1 * (k > 0), ranges_m=ranges))
    made = MadeRecording(moments, "scans")
    has = frozenset({"speed", "yaw rate", "ranges"})
    made.about = About("scans", "made", 100, 99.0, has, None, tuple(angles.tolist()), 20.0)
    return made


@pytest.mark.parametrize("name", ["a run of ours", "a folder of pictures", "scans"])
def test_any_moment_is_as_it_was(name: str, made: MadeRecording, tmp_path: Path) -> None:
    """20 random moments of each, with orders in between, looked at in any order."""
    recording = {
        "a run of ours": lambda: made,
        "a folder of pictures": lambda: pictures(made, tmp_path),
        "scans": scans,
    }
    session = PlayedSession(Player(recording[name](), 1))
    history = History(session)
    machine = TimeMachine(session, history)
    session.on_order = machine.told
    rng, were = random.Random(5), dict[int, tuple[object, ...]]()
    chosen = set(rng.sample(range(90 if name == "scans" else TICKS - 5), 20))

    def state() -> tuple[object, ...]:
        return session.state_hash(), session.frame.image.tobytes(), session.time_s, session.truth, session.over

    while not session.over:
        if session.tick_count in chosen:
            were[session.tick_count] = state()
        if session.tick_count == 40:
            session.set_parameters({"pose_cells.inhibit": 0.0021})
            session.tag("here")
        if session.tick_count == 70:
            session.forget_view(0)
        session.tick()
        history.watch()
        machine.ticked()
        if session.tick_count % 60 == 0:
            machine._keep()  # as of a recording whose moments take longer
    end = session.state_hash()
    assert len(were) == 20
    for tick in rng.sample(sorted(were), 20):
        again = machine.moment(machine.live, tick).session
        assert (again.state_hash(), again.frame.image.tobytes(), again.time_s, again.truth, again.over) == were[tick]
    assert session.state_hash() == end


# ------------------------------------------------------------ in the engine


def playing(player: Player, ticks: int) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_recording(player)
    run_for(engine, ticks)
    return engine


def run_for(engine: Engine, ticks: int) -> None:
    for _ in range(ticks):
        engine.tick()


def test_looking_back_pauses_and_changes_nothing(player: Player) -> None:
    engine = playing(player, 100)
    now, straight = engine.run.session.state_hash(), playing(player, 42).run.session.state_hash()
    engine.running = True
    tell(engine, type="seek", time_s=4.2)
    past = engine.snapshot()
    assert (past.tick, past.time_s, past.running) == (42, 4.2, False)
    assert past.time is not None
    assert (past.time.past, past.time.end_tick, past.time.begin_s) == (True, 100, 0.0)
    assert engine.shown.session.state_hash() == straight, "the moment is what playing up to it makes"
    with pytest.raises(ValueError, match="this is the past"):
        tell(engine, type="inject_packet", x=3, y=4)
    for order in ({"type": "back_to_now"}, {"type": "seek", "tick": 100}):  # its last moment is the present
        tell(engine, **order)
        assert engine.time.past is None
        assert engine.snapshot().tick == 100
        assert engine.run.session.state_hash() == now
        tell(engine, type="seek", time_s=4.2)


def test_the_past_plays_to_the_present_also_at_the_end_of_the_recording(player: Player) -> None:
    engine = playing(player, TICKS - 1)
    assert engine.run.session.over
    tell(engine, type="seek", tick=TICKS - 4)
    tell(engine, type="resume")
    run_for(engine, 2)
    assert engine.running
    assert engine.snapshot().tick == TICKS - 2
    run_for(engine, 1)
    assert not engine.running
    assert engine.time.past is None
    ends = [event for event in engine.run.event_log.events if event.kind == "recording"]
    assert len(ends) == 1, "the past does not end once more"
    with pytest.raises(ValueError, match="the recording has ended"):
        tell(engine, type="resume")


def test_a_branch_without_a_change_comes_out_the_same_and_one_with_it_does_not(player: Player) -> None:
    engine = playing(player, 120)
    first = engine.run.session.state_hash()
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
    tell(engine, type="compare_branch", number=2)
    tell(engine, type="change_branch", number=1)
    assert engine.run.session.state_hash() == first
    tell(engine, type="compare_branch", number=2)
    shown = engine.snapshot().time
    assert shown is not None
    assert "are the same up to tick 120" in shown.differs


def test_a_branch_can_be_left_for_the_office_with_its_parameters(player: Player) -> None:
    engine = playing(player, 30)
    config = engine.next_config
    tell(engine, type="seek", tick=10)
    tell(engine, type="go_on_from_here")
    tell(engine, type="reset")
    assert engine.run.session.recording is not None
    tell(engine, type="reset", world="office")
    assert engine.run.session.recording is None
    assert engine.run.session.config == config


def test_the_stages_of_a_moment_are_shown_and_change_nothing(player: Player) -> None:
    engine, other = playing(player, 50), playing(player, 51)
    tell(engine, type="step_stage")
    walk = engine.snapshot().walk
    assert walk is not None
    assert [stage.name for stage in walk.stages][:2] == ["image", "view match"]
    assert walk.stages[0].words.startswith("The recording tells of ")
    for _ in range(len(walk.stages) - 1):
        tell(engine, type="step_stage")
    tell(engine, type="step_stage", back=True)
    assert engine.run.session.state_hash() == other.run.session.state_hash()


def test_why_did_it_snap_and_what_would_have_come_without_that(made: MadeRecording, player: Player) -> None:
    """A drive that begins again where it began, as if somebody had carried the robot back."""
    once = list(made.moments())
    again = [
        replace(moment, frame=TICKS + k, time_s=(TICKS + k) / 10, image=moment.image ^ 1)  # type: ignore[operator]
        for k, moment in enumerate(once)
    ]
    engine = playing(Player(MadeRecording(once + again), 1, player.config), 2 * TICKS - 1)
    snaps = of_kind(engine, "snap")
    assert snaps
    assert snaps[0].time_s > TICKS / 10
    why = engine.run.history.events.reasons.of(snaps[0].number)
    assert why.without
    tell(engine, type="go_on_without", event=snaps[0].number)
    session = engine.run.session
    assert session.time_s < why.since_s
    assert all(len(session.brain.view_links.of(view)[0]) == 0 for view in why.without)
    while session.time_s < why.time_s:
        engine.tick()
    assert of_kind(engine, "snap") == []


def of_kind(engine: Engine, kind: str) -> list[m.Event]:
    return [event for event in engine.run.event_log.events if event.kind == kind]


def test_a_moment_that_cannot_be_read_again_leaves_the_present_as_it_is(made: MadeRecording) -> None:
    class Lost(MadeRecording):
        gone = False

        def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
            if self.gone:
                raise ValueError("made: the file is not there any more")
            return super().moments(wanted)

    lost = Lost(list(made.moments()))
    player = Player(lost, 1)
    engine = playing(player, 100)
    engine.run.session._reel._held.clear()  # type: ignore[attr-defined]
    now, lost.gone = engine.run.session.state_hash(), True
    with pytest.raises(ValueError, match="the file is not there any more"):
        tell(engine, type="seek", tick=50)
    assert engine.time.past is None
    assert engine.snapshot().tick == 100
    assert engine.run.session.state_hash() == now


def test_looping_over_uneven_times(made: MadeRecording, tmp_path: Path) -> None:
    engine = playing(Player(pictures(made, tmp_path), 1), 200)
    times = [4.0 + 151 / 10, 4.0 + 152.5 / 10]
    tell(engine, type="seek", time_s=15.5)
    assert engine.snapshot().time_s == 15.0, "the last moment before the gap"
    tell(engine, type="loop", begin_s=times[0], end_s=times[1])
    tell(engine, type="seek", time_s=times[0])
    assert engine.snapshot().time_s == pytest.approx(times[0])
    begin = engine.snapshot().tick
    tell(engine, type="resume")
    run_for(engine, 3)
    assert engine.snapshot().tick == begin, "past the end of the loop it begins anew"
    assert isinstance(engine.snapshot(), m.Snapshot)
