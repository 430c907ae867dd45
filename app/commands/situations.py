"""What leads to the moment that is shown, opening what leads to another, and leaving it before it is there."""

from __future__ import annotations

from pathlib import Path

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from app.engine.run import Run
from app.order_book import Order
from app.runs.folder import BRAIN
from app.runs.header import Beginning
from app.runs.run_file import KeptRun
from app.situations import LedHere, Situation
from ratslam_core import RatSlam
from web import messages as m

PLAYING = "a situation is being played up to its moment; wait until it is there, or leave it"
WHILE_PLAYING = {m.LeaveSituation, m.Inspect, m.SetSpeed, m.Reset, m.WatchExperiment}


def read_situation(engine: Engine, _: m.ReadSituation) -> Outcome:
    first, orders = engine.time.led_here()
    began, brain, earlier = _beginning_of(first)
    return m.Accepted(engine.shown.session.tick_count, LedHere(began, brain, [*earlier, *orders], engine.shown.session))


def open_situation(engine: Engine, request: m.OpenSituation) -> Outcome:
    if not isinstance(request.situation, Situation):
        return m.Refused("situation", None, "this is no situation")
    try:
        engine.open_situation(request.situation)
    except Exception as error:
        return m.Refused("situation", None, f"it cannot be played here: {error}")
    return None


def leave_situation(engine: Engine, _: m.LeaveSituation) -> Outcome:
    if engine.run.ahead is None or engine.run.ahead.state != "playing":
        return m.Refused("type", "leave_situation", "no situation is being played up to its moment")
    engine.leave_situation()
    return None


def waits(engine: Engine, command: object) -> m.Refused | None:
    """While a situation is played, nothing may change it; the orders are its own."""
    ahead = engine.run.ahead
    if ahead is None or ahead.state != "playing" or type(command) in WHILE_PLAYING:
        return None
    return m.Refused("type", getattr(command, "type", ""), PLAYING)


def _beginning_of(run: Run) -> tuple[Beginning, RatSlam | Path | None, list[Order]]:
    """What a run began from, the brain that it began with, and the orders of the kept run that it goes on with."""
    began = run.beginning
    assert began is not None  # a recording is refused before
    if isinstance(began, KeptRun):
        header = began.header
        first = Beginning(header.world, header.world_name, header.seed, header.config, header.brain, header.trial)
        return first, began.folder / BRAIN if header.brain else None, began.orders
    return began, run.first_brain, []
