"""Pause, resume, single ticks, single stages of a tick, speed, reset; and playing a recording that the server has opened."""

from __future__ import annotations

from app.commands.brain import begin_again
from app.commands.outcome import Later, Outcome
from app.engine.engine import Engine
from app.recordings.playing import Player
from app.views.snapshots import recording_view
from web import messages as m


def pause(engine: Engine, _: m.Pause) -> Outcome:
    engine.running = False
    engine.break_off()


def resume(engine: Engine, command: m.Resume) -> Outcome:
    refused = engine.pause_for(command.type)
    engine.break_off()
    engine.running = refused is None
    engine.pace.hurry()
    return refused


def step(engine: Engine, command: m.Step) -> Outcome:
    return engine.pause_for(command.type) or Later(command.ticks)


def set_speed(engine: Engine, command: m.SetSpeed) -> Outcome:
    engine.pace.speed = command.factor
    engine.pace.hurry()


def step_stage(engine: Engine, command: m.StepStage) -> Outcome:
    """Show the next or the previous stage of the recorded tick. After the last stage, run and record another tick."""
    refused = engine.pause_for(command.type)
    if refused is not None:
        return refused
    run = engine.shown
    engine.break_off()
    if run.walk(command.back):
        return None
    if command.back:
        return m.Refused("back", True, "there is no stage before this one; go forwards")
    recorder = run.recorder()
    engine.tick(recorder)
    if engine.fault is None:
        run.show(recorder)
    return None


def reset(engine: Engine, command: m.Reset) -> Outcome:
    session = engine.run.session
    beside = session.companion
    world, name = engine.world, command.world
    try:
        player = session.player
        if name is None and player is not None:
            engine.begin_recording(player, command.seed)
            begin_again(engine, beside)
            return None
        if name is not None and name != world.name:
            world = engine.library.world(name)
        engine.begin(world, session.seed if command.seed is None else command.seed, engine.next_config)
        begin_again(engine, beside)
    except ValueError as error:
        return m.Refused("world", name or world.name, str(error))
    return None


def play_recording(engine: Engine, request: m.PlayRecording) -> Outcome:
    """Begin a run that plays it. If that fails, the old run goes on."""
    try:
        if not isinstance(request.player, Player):
            raise TypeError(f"it is a {type(request.player).__name__}")
        run = engine.begin_recording(request.player)
    except Exception as error:
        return m.Refused("recording", None, f"this recording cannot be played: {error}")
    about = run.session.recording
    assert about is not None
    engine.running = not run.session.source.over
    return m.Accepted(0, recording_view(about, run.session.source.over))
