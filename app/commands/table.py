"""Which handler carries out which command. People give commands, the server makes requests; both are handled alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.commands import (
    bookmarks,
    brains,
    comparing,
    editing,
    lessons,
    looking,
    office,
    parameters,
    recordings,
    robot,
    situations,
    time,
    transport,
    worlds,
)
from app.commands.experiments import after_order, watch_experiment
from app.commands.inject_packet import inject_packet
from app.commands.needs import lacking
from app.commands.outcome import Later, Outcome, Working
from app.engine.engine import Engine
from web import messages as m

Handler = Callable[[Engine, Any], Outcome]  # Any: an instance of the class that is the key in the table

COMMANDS: dict[type, Handler] = {
    m.SetGoal: robot.set_goal,
    m.CancelGoal: robot.cancel_goal,
    m.Tag: robot.tag,
    m.Untag: robot.untag,
    m.GoToTag: robot.go_to_tag,
    m.SetMode: robot.set_mode,
    m.Drive: robot.drive,
    m.Kidnap: robot.kidnap,
    m.Pause: transport.pause,
    m.Resume: transport.resume,
    m.Step: transport.step,
    m.StepStage: transport.step_stage,
    m.SetSpeed: transport.set_speed,
    m.Reset: transport.reset,
    m.SetParameter: parameters.set_parameter,
    m.UsePreset: parameters.use_preset,
    m.SetDoor: office.set_door,
    m.SetLamp: office.set_lamp,
    m.PutBox: office.put_box,
    m.RemoveBox: office.remove_box,
    m.EditWorld: editing.edit_world,
    m.UndoEdit: editing.undo_edit,
    m.RedoEdit: editing.redo_edit,
    m.Inspect: looking.inspect,
    m.InjectPacket: inject_packet,
    m.WatchExperiment: watch_experiment,
    m.BeginLesson: lessons.begin_lesson,
    m.Predict: lessons.predict,
    m.Vote: lessons.vote,
    m.ShowLesson: lessons.show_lesson,
    m.LessonAgain: lessons.lesson_again,
    m.EndLesson: lessons.end_lesson,
    m.RunUntil: lessons.run_until,
    m.Seek: time.seek,
    m.BackToNow: time.back_to_now,
    m.GoOnFromHere: time.go_on_from_here,
    m.GoOnWithout: time.go_on_without,
    m.ChangeBranch: time.change_branch,
    m.CompareBranch: time.compare_branch,
    m.Loop: time.loop,
    m.LeaveSituation: situations.leave_situation,
    m.PutBookmark: bookmarks.put_bookmark,
    m.RemoveBookmark: bookmarks.remove_bookmark,
    m.CompareBrains: comparing.compare_brains,
    m.EndComparison: comparing.end_comparison,
}
REQUESTS: dict[type, Handler] = {
    m.ReadExperience: looking.read_experience,
    m.Warn: looking.warn,
    m.ReadBrain: brains.read_brain,
    m.ReadSession: looking.read_session,
    m.UseBrain: brains.use_brain,
    m.GoOn: brains.go_on,
    m.ReadWorld: worlds.read_world,
    m.ReadFiled: worlds.read_filed,
    m.OpenWorld: worlds.open_world,
    m.WorldSaved: worlds.world_saved,
    m.WorldDeleted: worlds.world_deleted,
    m.WorldRestored: worlds.world_restored,
    m.PlayRecording: recordings.play_recording,
    m.ReadSituation: situations.read_situation,
    m.OpenSituation: situations.open_situation,
}


def carry_out(engine: Engine, command: m.Command | m.EngineRequest) -> m.Accepted | m.Refused | Later | Working:
    """Carry out a command between two ticks. A refusal names the field, its value and the reason."""
    kind = type(command)
    refused = lacking(engine.run.session, command)
    if refused is not None:
        return refused
    if kind in REQUESTS:
        outcome = REQUESTS[kind](engine, command)
    elif engine.time.past is not None and kind not in time.IN_THE_PAST:
        outcome = m.Refused("type", getattr(command, "type", ""), time.PAST)
    elif kind in COMMANDS:
        outcome = situations.waits(engine, command) or _commanded(engine, COMMANDS[kind], command)
    else:
        raise TypeError(f"nobody carries out {getattr(command, 'type', kind.__name__)}")
    return m.Accepted(engine.shown.session.tick_count) if outcome is None else outcome


def _commanded(engine: Engine, handler: Handler, command: object) -> Outcome:
    """Call the handler, then rebuild what the snapshot shows and log every new warning of the config."""
    run, before = engine.run, engine.run.session.warnings
    outcome = handler(engine, command)
    if outcome is None:
        engine.shown.snapshots.refresh()
        after_order(engine, command)
    for words in run.session.warnings:
        if words not in before:
            run.event_log.note("warning", words)
    return outcome
