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
from app.recordings.playing import Player
from app.recordings.recording import Moment, Wanted, every
from app.session import played_session
from tests.unit.app.engines import an_engine, tell
from tests.unit.app.made_recordings import MadeRecording, recorded
from tests.unit.app.sessions import OFFICE
from web import messages as m
from web.http.state import page_fields, state, to_json
from web.panel.truth import numbers

TICKS = 60


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


def to_the_end(engine: Engine) -> str:
    """Play on; returns what the session is then."""
    engine.running = True
    while engine.running:
        engine.tick()
    return engine.run.session.state_hash()


def reset(engine: Engine, **fields: object) -> m.Accepted | m.Refused:
    return carry_out(engine, m.Reset.model_validate({"type": "reset", **fields}))  # type: ignore[return-value]


def test_it_is_what_the_player_makes_of_the_recording_whether_there_is_a_truth_or_not(
    player: Player, blind: Player
) -> None:
    session, steps = played_session(player), list(player.steps())
    views = [session.estimate.recognition.view]
    while not session.source.over:
        session.tick()
        views.append(session.estimate.recognition.view)
    *_, unseeing = blind.steps()
    assert views == [step.estimate.recognition.view for step in steps]
    for other in (steps[-1], unseeing):
        assert np.array_equal(session.brain.experience_map.poses, other.brain.experience_map.poses)


def test_it_pauses_at_its_end_says_so_and_comes_out_the_same_again(player: Player) -> None:
    engine = playing(player)
    first = to_the_end(engine)
    assert engine.run.session.tick_count == TICKS - 1
    assert [e.text for e in engine.run.event_log.events if e.kind == "recording"] == ["the recording has ended"]
    assert engine.snapshot().recording is not None
    for kind in ("resume", "step"):
        with pytest.raises(ValueError, match="the recording has ended"):
            tell(engine, type=kind)
    assert engine.run.session.state_hash() == first
    reset(engine)
    assert (engine.run.session.tick_count, engine.run.session.source.over) == (0, False)
    assert to_the_end(engine) == first
    reset(engine, seed=9)
    assert engine.run.session.seed == 9
    assert player.seed == 1, "the player of others stays as it was"


def test_steps_beyond_the_end_are_answered_with_the_last_moment(player: Player) -> None:
    answers: list[int] = []
    engine = Engine(
        OFFICE, Pace(0.0), Watchdog(1e9, lambda: None), running=False, answer=lambda _, said: answers.append(said.tick)
    )
    engine.begin_recording(player)
    engine.steps.add(m.Request(m.Pause(type="pause"), None), 1000)  # type: ignore[arg-type]
    while engine.steps:
        engine.step()
    assert (answers, engine.fault) == ([TICKS - 1], None)


STAYS, NO_OFFICE = "cannot be sent, driven or carried", "it has no office"
REFUSED: list[tuple[dict[str, object], str]] = [
    ({"type": "set_goal", "x": 0.0, "y": 0.0}, STAYS),
    ({"type": "go_to_tag", "name": "here"}, STAYS),
    ({"type": "cancel_goal"}, STAYS),
    ({"type": "set_mode", "mode": "explore"}, STAYS),
    ({"type": "drive", "speed": 0.1, "yaw_rate": 0.0}, STAYS),
    ({"type": "kidnap"}, STAYS),
    ({"type": "set_door", "name": "a", "open": True}, NO_OFFICE),
    ({"type": "set_lamp", "name": "a", "on": True}, NO_OFFICE),
    ({"type": "put_box", "name": "a", "x": 0, "y": 0, "width": 1, "depth": 1, "height": 1}, NO_OFFICE),
    ({"type": "remove_box", "name": "a"}, NO_OFFICE),
    ({"type": "undo_edit"}, NO_OFFICE),
    ({"type": "redo_edit"}, NO_OFFICE),
    ({"type": "set_parameter", "name": "robot.max_speed", "value": 0.3}, "robot.max_speed is for the simulator"),
    ({"type": "use_preset", "name": "ideal"}, "is for the simulator"),
]


def test_an_order_that_it_cannot_carry_out_is_refused_and_changes_nothing(
    player: Player, subtests: pytest.Subtests
) -> None:
    engine = playing(player)
    before = engine.run.session.state_hash()
    for fields, words in REFUSED:
        with subtests.test(str(fields["type"])):
            with pytest.raises(ValueError, match=words):
                tell(engine, **fields)
            assert engine.run.session.state_hash() == before
    refused = carry_out(engine, m.ReadWorld())  # type: ignore[arg-type]
    assert isinstance(refused, m.Refused)
    assert NO_OFFICE in refused.reason


def test_what_concerns_the_brain_works(player: Player) -> None:
    engine = playing(player)
    for _ in range(20):
        engine.tick()
    tell(engine, type="set_parameter", name="pose_cells.inhibit", value=0.0021)
    assert engine.run.session.brain.params.pose_cells.inhibit == 0.0021
    tell(engine, type="tag", name="here")
    tell(engine, type="inject_packet", x=3, y=4)
    assert carry_out(engine, m.Inspect(type="inspect", experience=0)) == m.Accepted(20)
    assert isinstance(carry_out(engine, m.ReadBrain()), m.Accepted)
    shown = engine.snapshot()
    assert isinstance(shown.inspected, m.ExperienceReport)
    assert [place.name for place in shown.tags] == ["here"]


def test_with_truth_its_path_and_the_errors_are_shown(player: Player) -> None:
    engine = playing(player)
    to_the_end(engine)
    shown = engine.snapshot()
    assert shown.world is not None
    assert (shown.world.is_office, len(shown.world.walls), shown.coverage) == (False, 0, None)
    assert shown.truth is not None
    assert shown.error_map_m is not None
    assert shown.error_map_m < 0.1
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


def test_back_to_the_office_that_was_open_with_its_parameters(player: Player) -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="set_parameter", name="robot.gyro_bias", value=0.01)
    config = engine.run.session.config
    engine.begin_recording(player)
    assert engine.run.session.config == player.config
    reset(engine)
    assert engine.run.session.recording is not None, "without a world the recording begins again"
    assert reset(engine, world="office") == m.Accepted(0)
    assert (engine.run.session.recording, engine.run.session.config) == (None, config)
    engine.tick()
    assert engine.snapshot().world is not None


class Empty(MadeRecording):
    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:  # noqa: ARG002
        return iter(())


class Broken(MadeRecording):
    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        yield from list(super().moments(wanted))[:10]
        raise ValueError("made: picture 10 cannot be read")


def test_a_recording_without_a_moment_or_of_another_kind_leaves_the_run_as_it_is(moments: MadeRecording) -> None:
    engine, empty = an_engine(OFFICE), Player(moments, 1)
    run = engine.run
    empty.recording = Empty(list(moments.moments()))
    for player, words in ((empty, "made has no moment that can be played"), ("a text", "it is a str")):
        refused = carry_out(engine, m.PlayRecording(player))
        assert isinstance(refused, m.Refused)
        assert words in refused.reason
    assert engine.run is run


def test_a_recording_that_breaks_off_is_a_fault_and_can_be_begun_again(moments: MadeRecording) -> None:
    player = Player(moments, 1)
    player.recording = Broken(list(moments.moments()))
    engine = playing(player)
    to_the_end(engine)
    assert engine.fault is not None
    assert "picture 10 cannot be read" in engine.fault
    reset(engine)
    assert engine.fault is None
