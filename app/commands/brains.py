"""Reading the brain, replacing it by another, and going on with a run that was kept."""

from __future__ import annotations

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from app.runs.run_file import KeptRun
from app.session import Session
from disk import copy_state
from ratslam_core import RatSlam
from web import messages as m


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
