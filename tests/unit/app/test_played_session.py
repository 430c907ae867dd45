"""A recording plays in the engine as an office does: tick by tick, to its end; what it lacks is absent, and said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from app.commands import carry_out
from app.engine.engine import Engine
from app.engine.pace import Pace
from app.engine.watchdog import Watchdog
from app.played_session import PlayedSession
from app.recordings.playing import Player
from app.recordings.recording import Moment, Wanted, every
from sim2d import load_world
from tests.unit.app.engines import an_engine, tell
from tests.unit.app.made_recordings import MadeRecording, recorded
from web import messages as m
from web.http.state import page_fields, state, to_json
from web.panel.truth import numbers

TICKS = 60
OFFICE = load_world("office")


@pytest.fixture(scope="module")
def moments() -> MadeRecording:
    return recorded(TICKS)


@pytest.fixture(scope="module")
def player(moments: MadeRecording) -> Player:
    return Player(moments, 1)


@pytest.fixture(scope="module")
def blind(moments: MadeRecording) -> Player:
    """The same without truth."""
    return Player(MadeRecording([replace(moment, truth=None) for moment in moments.moments()]), 1)


def playing(player: Player) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_recording(player)
    return engine


def to_the_end(engine: Engine) -> None:
    engine.running = True
    while engine.running:
        engine.tick()


def test_it_is_what_the_player_makes_of_the_recording(player: Player) -> None:
    session, steps = PlayedSession(player), list(player.steps())
    seen = [session.estimate]
    while not session.over:
        session.tick()
        seen.append(session.estimate)
    assert [e.recognition.view for e in seen] == [step.estimate.recognition.view for step in steps]
    assert np.array_equal(session.brain.experience_map.poses, steps[-1].brain.experience_map.poses)


def test_the_same_again_and_another_seed_is_told(player: Player) -> None:
    engine = playing(player)
    to_the_end(engine)
    first = engine.run.session.state_hash()
    carry_out(engine, m.Reset(type="reset"))
    assert engine.run.session.tick_count == 0
    assert not engine.run.session.over
    to_the_end(engine)
    assert engine.run.session.state_hash() == first
    carry_out(engine, m.Reset(type="reset", seed=9))
    assert engine.run.session.seed == 9
    assert player.seed == 1, "the player of others stays as it was"


def test_it_pauses_at_its_end_and_says_so(player: Player) -> None:
    engine = playing(player)
    to_the_end(engine)
    session, events = engine.run.session, engine.run.event_log.events
    assert session.tick_count == TICKS - 1
    assert [event.text for event in events if event.kind == "recording"] == ["the recording has ended"]
    assert engine.snapshot().recording is not None
    before = session.state_hash()
    for kind in ("resume", "step"):
        with pytest.raises(ValueError, match="the recording has ended"):
            tell(engine, type=kind)
    assert engine.run.session.state_hash() == before


def test_steps_beyond_the_end_are_answered_with_the_last_moment(player: Player) -> None:
    answers: list[int] = []
    engine = Engine(
        OFFICE, Pace(0.0), Watchdog(1e9, lambda: None), running=False, answer=lambda _, said: answers.append(said.tick)
    )
    engine.begin_recording(player)
    engine.steps.add(m.Request(m.Pause(type="pause"), None), 1000)  # type: ignore[arg-type]
    while engine.steps:
        engine.step()
    assert answers == [TICKS - 1]
    assert engine.fault is None


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"type": "set_goal", "x": 0.0, "y": 0.0}, "cannot be sent, driven or carried"),
        ({"type": "go_to_tag", "name": "here"}, "cannot be sent, driven or carried"),
        ({"type": "cancel_goal"}, "cannot be sent, driven or carried"),
        ({"type": "set_mode", "mode": "explore"}, "cannot be sent, driven or carried"),
        ({"type": "drive", "speed": 0.1, "yaw_rate": 0.0}, "cannot be sent, driven or carried"),
        ({"type": "kidnap"}, "cannot be sent, driven or carried"),
        ({"type": "set_door", "name": "a", "open": True}, "it has no office"),
        ({"type": "set_lamp", "name": "a", "on": True}, "it has no office"),
        ({"type": "put_box", "name": "a", "x": 0, "y": 0, "width": 1, "depth": 1, "height": 1}, "it has no office"),
        ({"type": "remove_box", "name": "a"}, "it has no office"),
        ({"type": "undo_edit"}, "it has no office"),
        ({"type": "redo_edit"}, "it has no office"),
        ({"type": "set_parameter", "name": "robot.max_speed", "value": 0.3}, "robot.max_speed is for the simulator"),
        ({"type": "use_preset", "name": "ideal"}, "is for the simulator"),
    ],
)
def test_an_order_that_it_cannot_carry_out_is_refused_and_changes_nothing(
    player: Player, fields: dict[str, object], words: str
) -> None:
    engine = playing(player)
    before = engine.run.session.state_hash()
    with pytest.raises(ValueError, match=words):
        tell(engine, **fields)
    assert engine.run.session.state_hash() == before


def test_the_world_cannot_be_read_and_the_brain_can(player: Player) -> None:
    engine = playing(player)
    refused = carry_out(engine, m.ReadWorld())  # type: ignore[arg-type]
    assert isinstance(refused, m.Refused)
    assert "it has no office" in refused.reason
    brain = carry_out(engine, m.ReadBrain())
    assert isinstance(brain, m.Accepted)


def test_what_concerns_the_brain_works(player: Player) -> None:
    engine = playing(player)
    for _ in range(20):
        engine.tick()
    tell(engine, type="set_parameter", name="pose_cells.inhibit", value=0.0021)
    assert engine.run.session.brain.params.pose_cells.inhibit == 0.0021
    tell(engine, type="tag", name="here")
    tell(engine, type="inject_packet", x=3, y=4)
    assert carry_out(engine, m.Inspect(type="inspect", experience=0)) == m.Accepted(20)
    shown = engine.snapshot()
    assert isinstance(shown.inspected, m.ExperienceReport)
    assert [place.name for place in shown.tags] == ["here"]


def test_with_truth_its_path_and_the_errors_are_shown(player: Player) -> None:
    engine = playing(player)
    to_the_end(engine)
    shown = engine.snapshot()
    assert shown.world is not None
    assert not shown.world.is_office
    assert len(shown.world.walls) == 0
    assert shown.truth is not None
    assert shown.error_map_m is not None
    assert shown.error_map_m < 0.1
    assert shown.coverage is None
    low_x, low_y, high_x, high_y = shown.world.bounds
    assert (shown.trail >= (low_x, low_y)).all()
    assert (shown.trail <= (high_x, high_y)).all()
    assert not any("floor covered" in row[0] for row in numbers(shown).data["table"]["rows"])


def test_without_truth_nothing_of_it_is_shown(blind: Player) -> None:
    engine = playing(blind)
    to_the_end(engine)
    shown = engine.snapshot()
    assert (shown.world, shown.truth, shown.living, shown.office, shown.movements) == (None,) * 5
    assert (shown.error_map_m, shown.error_odometry_m, shown.coverage, shown.revisit_consistency) == (None,) * 4
    assert len(shown.trail) == 0
    assert np.isnan(shown.series.map_error_m).all()
    assert not any(row.name.split(".")[0] in ("robot", "office", "pilot") for row in shown.parameters)
    told, page = state(shown), page_fields(shown)
    assert (told["world"], told["robot"], told["mode"]) == (None, None, "recorded")
    assert (page["title"], page["recording"]["over"]) == ("made", True)
    to_json(told | page)


def test_truth_never_reaches_the_brain(player: Player, blind: Player) -> None:
    seeing, not_seeing = PlayedSession(player), PlayedSession(blind)
    for _ in range(TICKS - 1):
        seeing.tick()
        not_seeing.tick()
    assert np.array_equal(seeing.brain.experience_map.poses, not_seeing.brain.experience_map.poses)


def test_back_to_the_office_that_was_open_with_its_parameters(player: Player) -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="set_parameter", name="robot.gyro_bias", value=0.01)
    config = engine.run.session.config
    engine.begin_recording(player)
    assert engine.run.session.config == player.config
    carry_out(engine, m.Reset(type="reset"))
    assert engine.run.session.recording is not None, "without a world the recording begins again"
    assert carry_out(engine, m.Reset(type="reset", world="office")) == m.Accepted(0)
    assert engine.run.session.recording is None
    assert engine.run.session.config == config
    engine.tick()
    assert engine.snapshot().world is not None


def test_a_recording_without_a_moment_or_of_another_kind_leaves_the_run_as_it_is(moments: MadeRecording) -> None:
    class Empty(MadeRecording):
        def moments(self, wanted: Wanted = every) -> Iterator[Moment]:  # noqa: ARG002
            return iter(())

    engine = an_engine(OFFICE)
    run = engine.run
    empty = Player(moments, 1)
    empty.recording = Empty(list(moments.moments()))
    for player, words in ((empty, "made has no moment that can be played"), ("a text", "it is a str")):
        refused = carry_out(engine, m.PlayRecording(player))
        assert isinstance(refused, m.Refused)
        assert words in refused.reason
    assert engine.run is run


def test_a_recording_that_breaks_off_is_a_fault_and_can_be_begun_again(moments: MadeRecording) -> None:
    class Broken(MadeRecording):
        def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
            yield from list(super().moments(wanted))[:10]
            raise ValueError("made: picture 10 cannot be read")

    player = Player(moments, 1)
    player.recording = Broken(list(moments.moments()))
    engine = playing(player)
    to_the_end(engine)
    assert engine.fault is not None
    assert "picture 10 cannot be read" in engine.fault
    carry_out(engine, m.Reset(type="reset"))
    assert engine.fault is None
