"""Commands to the brain: reading it, replacing it, a second one on the same senses (the orders themselves: app/session.py),
a packet put in by hand, and parameters, one by one or as a preset."""

from __future__ import annotations

from collections.abc import Mapping

from app.commands.outcome import Outcome
from app.companion import Companion
from app.config import Config, Value
from app.config.presets import engine_of, pair_of, values_of
from app.engine.engine import Engine
from app.run_record.reader import KeptRun
from app.session import Session, config_beside
from app.views.beside import differences_of
from disk import copy_state
from ratslam_core import RatSlam
from web import messages as m
from web.messages import InjectPacket


def read_brain(engine: Engine, _: m.ReadBrain) -> Outcome:
    session = engine.run.session
    return m.Accepted(session.tick_count, copy_state(session.brain))


def use_brain(engine: Engine, request: m.UseBrain) -> Outcome:
    """Begin a new run with a foreign brain. If that fails, the old run goes on."""
    session, brain = engine.run.session, request.brain
    seed = session.seed if request.seed is None else request.seed
    world = engine.world
    try:
        if request.world is not None and request.world.name != world.name:
            world = engine.library.read(request.world)
        if not isinstance(brain, RatSlam):
            raise TypeError(f"it is a {type(brain).__name__}")
        new = engine.begin(world, seed, engine.next_config.with_engine(brain.params), brain)
    except Exception as error:
        return m.Refused("brain", None, f"this brain cannot be used here: {error}")
    new.event_log.note("brain", f"woke up with {len(brain.experience_map)} experiences")
    return m.Accepted(0)


def go_on(engine: Engine, request: m.GoOn) -> Outcome:
    """Go on with a kept run in the session where it was left. If that fails, the run of now goes on."""
    run, session = request.run, request.session
    if not (isinstance(run, KeptRun) and isinstance(session, Session)):
        return m.Refused("run", None, "this is no run that was kept")
    try:
        engine.go_on(run, session)
    except Exception as error:
        return m.Refused("run", run.name, f"this run cannot go on here: {error}")
    return m.Accepted(session.tick_count)


def compare_brains(engine: Engine, command: m.CompareBrains) -> Outcome:
    """From now on with a copy, or in a run that begins again as the one that there is."""
    config = engine.config_to_begin if command.since == "beginning" else engine.run.session.config
    try:
        first, second, values = _wanted(command, config)
        changed = config_beside(config, values)
    except ValueError as error:
        return m.Refused("pair" if command.values is None else "values", command.pair or command.values, str(error))
    if changed == config:
        return m.Refused("values", command.values, "the first brain has these parameters already: nothing would differ")
    if command.since == "beginning":
        _restart(engine)
    _give(engine, first, second, values, anew=command.since == "beginning")
    return None


def end_comparison(engine: Engine, _: m.EndComparison) -> Outcome:
    """The first brain goes on by itself; the last figures of both stay among the events."""
    session = engine.run.session
    words = None if session.companion is None else figures_of(engine)

    session.end_companion()
    engine.run.history.watch_companion()
    engine.run.event_log.note("brain", f"the comparison ends: {words}")


def begin_again(engine: Engine, before: Companion | None) -> None:
    """The run has just begun again, and with it the second brain that there was."""
    if before is not None:
        _give(engine, before.first, before.name, before.values, anew=True)


def figures_of(engine: Engine) -> str:
    """Both brains in figures, and since when they differ."""
    view = engine.run.snapshots.beside()
    if view is None or engine.run.session.companion is None:
        return "nothing was compared"
    sides = [
        f"{side.name}: {side.experiences} experiences, {side.relocalisations} relocalisations"
        + ("" if side.error_map_m is None else f", map error {side.error_map_m:.2f} m")
        for side in (view.first, view.second)
    ]
    seconds = engine.run.session.time_s - view.since_s
    apart = differences_of(engine.run.session.companion)
    since = f"; different since tick {apart[0].tick}" if apart else "; no difference"
    return f"after {seconds:.0f} s {'; '.join(sides)}{since}"


def _wanted(command: m.CompareBrains, config: Config) -> tuple[str, str, Mapping[str, Value]]:
    """What the two are called, and in what they differ. ValueError: neither or both are given."""
    if (command.pair is None) == (command.values is None):
        raise ValueError("compare_brains takes either a pair or values")
    if command.pair is not None:
        pair = pair_of(command.pair, config)
        return pair.first, command.name or pair.second, pair.values
    return engine_of(config), command.name or "otherwise", command.values or {}


def _restart(engine: Engine) -> None:
    """The same again: a trial that is watched, a recording, or a run in the same world with the same seed and parameters."""
    run = engine.run
    if run.trial is not None and run.trial.state == "running":
        engine.begin_trial(run.trial.trial, run.trial.title)
    elif (player := run.session.player) is not None:
        engine.begin_recording(player)
    else:
        before = None if run.trial is not None else run.config_before
        engine.begin(engine.world, run.session.seed, engine.config_to_begin)
        engine.run.config_before = before  # what a lesson has set goes with the runs that begin from it


def _give(engine: Engine, first: str, second: str, values: Mapping[str, Value], *, anew: bool) -> None:
    run = engine.run
    run.session.begin_companion(first, second, dict(values), anew)
    run.history.watch_companion()
    run.snapshots.refresh()
    begins = "from the beginning" if anew else "as a copy that differs from here on"
    run.event_log.note("brain", f"two brains on the same senses: {first} and, {begins}, {second}")


def inject_packet(engine: Engine, command: InjectPacket) -> Outcome:
    run, c = engine.run, command

    run.event_log.note("packet", run.session.put_packet(c.x, c.y, c.heading_rad, c.share))
    run.snapshots.walk = None  # it shows the pose cells as they were before the packet


def set_parameter(engine: Engine, command: m.SetParameter) -> Outcome:
    session, name, value = engine.run.session, command.name, command.value
    try:
        live = session.set_parameter(name, value)
    except ValueError as error:
        known = any(name == dotted for dotted, _, _ in session.config.items())
        field, wrong = ("value", value) if known else ("name", name)
        return m.Refused(field, wrong, str(error))
    engine.run.event_log.note("parameter", f"{name} = {value}" + ("" if live else ", from the next reset on"))
    return None


def use_preset(engine: Engine, command: m.UsePreset) -> Outcome:
    waiting = engine.run.session.set_parameters(values_of(command.name))
    later = f"; from the next reset on: {', '.join(waiting)}" if waiting else ""
    engine.run.event_log.note("office", f"preset {command.name}{later}")
