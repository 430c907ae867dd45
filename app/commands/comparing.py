"""A second brain on the same senses: beginning and ending it. The orders themselves: app/comparing.py."""

from __future__ import annotations

from collections.abc import Mapping

from app.commands.outcome import Outcome, attempt
from app.companion import Companion
from app.comparing import config_beside
from app.config import Config, Value
from app.config.pairs import engine_of, pair_of
from app.engine.engine import Engine
from app.played_session import PlayedSession
from app.views.beside import differences_of
from web import messages as m


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
    return attempt("since", command.since, lambda: _begin(engine, command.since, first, second, values))


def end_comparison(engine: Engine, _: m.EndComparison) -> Outcome:
    """The first brain goes on by itself; the last figures of both stay among the events."""
    session = engine.run.session
    words = None if session.companion is None else figures_of(engine)

    def end() -> None:
        session.end_companion()
        engine.run.history.watch_companion()
        engine.run.event_log.note("brain", f"the comparison ends: {words}")

    return attempt("type", "end_comparison", end)


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
    """What the two are called, and in what they differ. ValueError: neither or both are told."""
    if (command.pair is None) == (command.values is None):
        raise ValueError("compare_brains takes either a pair or values")
    if command.pair is not None:
        pair = pair_of(command.pair, config)
        return pair.first, command.name or pair.second, pair.values
    return engine_of(config), command.name or "otherwise", command.values or {}


def _begin(engine: Engine, since: str, first: str, second: str, values: Mapping[str, Value]) -> None:
    if since == "beginning":
        _restart(engine)
    _give(engine, first, second, values, anew=since == "beginning")


def _restart(engine: Engine) -> None:
    """The same again: a trial that is watched, a recording, or a run in the same world with the same seed and parameters."""
    run = engine.run
    if run.trial is not None and run.trial.state == "running":
        engine.begin_trial(run.trial.trial, run.trial.title)
    elif isinstance(run.session, PlayedSession):
        engine.begin_recording(run.session.player)
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
