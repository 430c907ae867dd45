"""Which handler carries out which command. People give commands, the server makes requests; both are handled alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.commands import brain, office, protocol, robot, time, transport
from app.commands.brain import inject_packet
from app.commands.outcome import Later, Outcome, Working
from app.config.presets import values_of
from app.engine.engine import Engine
from web import messages as m
from web.messages.commands import CommandModel, Needs

LACKS: dict[Needs, str] = {
    "robot": "a recording plays: its robot goes where it went, and cannot be sent, driven or carried",
    "office": "a recording plays: it has no office",
    "link": "a recording plays: a link or a file of it would have to hold the recording; share that instead",
}
PAST = "this is the past: go on from here, or come back to now"
PLAYING = "a situation is being played up to its moment; wait until it is there, or leave it"

Handler = Callable[[Engine, Any], Outcome]  # Any: an instance of the class that is the key in the table

COMMANDS: dict[type[CommandModel], Handler] = {
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
    m.SetParameter: brain.set_parameter,
    m.UsePreset: brain.use_preset,
    m.SetDoor: office.set_door,
    m.SetLamp: office.set_lamp,
    m.PutBox: office.put_box,
    m.RemoveBox: office.remove_box,
    m.EditWorld: office.edit_world,
    m.UndoEdit: office.undo_edit,
    m.RedoEdit: office.redo_edit,
    m.Inspect: robot.inspect,
    m.InjectPacket: inject_packet,
    m.WatchExperiment: protocol.watch_experiment,
    m.BeginLesson: protocol.begin_lesson,
    m.Predict: protocol.predict,
    m.Vote: protocol.vote,
    m.ShowLesson: protocol.show_lesson,
    m.LessonAgain: protocol.lesson_again,
    m.EndLesson: protocol.end_lesson,
    m.RunUntil: protocol.run_until,
    m.Seek: time.seek,
    m.BackToNow: time.back_to_now,
    m.GoOnFromHere: time.go_on_from_here,
    m.GoOnWithout: time.go_on_without,
    m.ChangeBranch: time.change_branch,
    m.CompareBranch: time.compare_branch,
    m.Loop: time.loop,
    m.GoBack: time.go_back,
    m.PutBookmark: time.put_bookmark,
    m.RemoveBookmark: time.remove_bookmark,
    m.CompareBrains: brain.compare_brains,
    m.EndComparison: brain.end_comparison,
}
REQUESTS: dict[type, Handler] = {
    m.ReadExperience: robot.read_experience,
    m.Warn: robot.warn,
    m.ReadBrain: brain.read_brain,
    m.ReadSession: robot.read_session,
    m.UseBrain: brain.use_brain,
    m.GoOn: brain.go_on,
    m.ReadWorld: office.read_world,
    m.ReadFiled: office.read_filed,
    m.OpenWorld: office.open_world,
    m.WorldSaved: office.world_saved,
    m.WorldDeleted: office.world_deleted,
    m.WorldRestored: office.world_restored,
    m.PlayRecording: transport.play_recording,
    m.ReadSituation: time.read_situation,
    m.OpenSituation: time.open_situation,
}


def carry_out(engine: Engine, command: m.Command | m.EngineRequest) -> m.Accepted | m.Refused | Later | Working:
    """Carry out a command between two ticks. A refusal names the field, its value and the reason."""
    kind = type(command)
    if kind not in COMMANDS and kind not in REQUESTS:
        raise TypeError(f"nobody carries out {getattr(command, 'type', kind.__name__)}")
    why = _hindrance(engine, command)
    if why:
        return m.Refused("type", getattr(command, "type", kind.__name__), why)
    if isinstance(command, CommandModel):
        outcome = _commanded(engine, COMMANDS[type(command)], command)
    else:
        outcome = REQUESTS[kind](engine, command)
    return m.Accepted(engine.shown.session.tick_count) if outcome is None else outcome


def _hindrance(engine: Engine, command: object) -> str:
    """Why the rules of a command, which it carries itself, forbid it now; empty if they do not."""
    needs: Needs | None = getattr(command, "needs", None)
    if needs is not None and engine.run.session.source.world is None:
        return LACKS[needs]
    if isinstance(command, CommandModel):
        if engine.time.past is not None and not command.in_the_past:
            return PAST
        if engine.run.replay is not None and engine.run.replay.state == "playing" and not command.while_playing:
            return PLAYING
    return ""


def _commanded(engine: Engine, handler: Handler, command: CommandModel) -> Outcome:
    """Call the handler, then rebuild what the snapshot shows and log every new warning of the config. What it raises as
    ValueError is a refusal."""
    run, before = engine.run, engine.run.session.warnings
    try:
        outcome = handler(engine, command)
    except ValueError as error:
        values = tuple(command.model_dump(exclude_none=True).get(name) for name in command.at.split(", "))
        outcome = m.Refused(command.at, values[0] if len(values) == 1 else values, str(error))
    if outcome is None:
        engine.shown.snapshots.refresh()
        _ordered(engine, command)
    for words in run.session.warnings:
        if words not in before:
            run.event_log.note("warning", words)
    return outcome


def _ordered(engine: Engine, command: CommandModel) -> None:
    """An order has been carried out: a trial that is being watched may end by it, or become another run."""
    before = engine.run.config_before
    if before is not None and isinstance(command, (m.SetParameter, m.UsePreset)):
        # What somebody sets is wanted in the next run, too; what the trial or lesson had set goes with it.
        one = isinstance(command, m.SetParameter)
        engine.run.config_before = before.with_values({command.name: command.value} if one else values_of(command.name))
    for supervisor in engine.run.supervisors:
        if command.ends:
            supervisor.ordered(command.ends)
        elif command.alters:
            supervisor.alter()
