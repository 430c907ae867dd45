"""The past of a run: looking at it, going on from it, branches, moments with a name; and situations, which lead to the
moment that is shown, or to another that is opened."""

from __future__ import annotations

from collections.abc import Generator

from app.commands.outcome import Outcome, Working
from app.engine.engine import Engine
from app.engine.work import Work
from app.run_record.reader import KeptRun
from app.run_record.situation import ReplaySpec, Situation
from web import messages as m


def seek(engine: Engine, command: m.Seek) -> Outcome:
    """Looking at the past pauses the present; while the past plays, it plays on from the new moment."""
    if (command.time_s is None) == (command.tick is None):
        return m.Refused("time_s", command.time_s, "seek takes either time_s or tick")
    time, before = engine.time, engine.slices.work
    playing = time.past is not None and (engine.running or (before is not None and before.plays))
    engine.break_off()
    engine.running = False
    tick = time.tick_at(command.time_s) if command.time_s is not None else command.tick or 0

    def steps() -> Generator[float]:
        yield from time.seeking(tick)
        engine.running = playing and time.past is not None

    work = Work("going there", steps(), moves=True)
    work.plays = playing
    return None if engine.work(work) else Working()


def back_to_now(engine: Engine, _: m.BackToNow) -> Outcome:
    if engine.time.past is not None:
        engine.running = False
        engine.break_off()
        engine.time.back_to_now()
    else:
        engine.break_off()


def go_on_from_here(engine: Engine, _: m.GoOnFromHere) -> Outcome:
    engine.go_on_from_here()


def go_on_without(engine: Engine, command: m.GoOnWithout) -> Outcome:
    """[ours] What would have come of it without the views that led to an event. test_go_on_without.py."""
    engine.running = False
    engine.break_off()
    report = engine.run.history.events.reasons.of(command.event)
    if not report.without:
        raise ValueError(f"no view led to event {command.event}: there is nothing to go on without")
    engine.time.seek(max(0, engine.time.tick_at(report.since_s) - 1))
    run = engine.go_on_from_here()
    known = [view for view in report.without if view < len(run.session.brain.local_view)]
    for view in known:
        run.session.forget_view(view)
    run.event_log.note("branch", f"the brain has forgotten where it saw view {', '.join(map(str, known))}")


def change_branch(engine: Engine, command: m.ChangeBranch) -> Outcome:
    engine.change_branch(command.number)


def compare_branch(engine: Engine, command: m.CompareBranch) -> Outcome:
    if command.number is None:
        engine.slices.drop(engine.shown.session.tick_count)
        engine.time.stop_comparing()
        return None
    work = Work("comparing the branches", engine.time.comparing(command.number), moves=False)
    return None if engine.work(work) else Working()


def loop(engine: Engine, command: m.Loop) -> Outcome:
    begin_s, end_s = command.begin_s, command.end_s
    if begin_s is None and end_s is None:
        engine.time.loop = None
        return None
    if begin_s is None or end_s is None or end_s - begin_s < 0.1:
        return m.Refused(
            "end_s", end_s, f"a loop needs begin_s and, at least 0.1 s later, end_s; got {begin_s} and {end_s}"
        )
    engine.time.loop = (begin_s, end_s)
    return None


def put_bookmark(engine: Engine, command: m.PutBookmark) -> Outcome:
    """Of the moment that is shown, or another name for that of a tick."""

    run, shown = engine.run, engine.shown.session
    tick, time_s = shown.tick_count, shown.time_s
    if command.tick is not None:
        before = run.bookmarks.at(command.tick)
        tick, time_s = before.tick, before.time_s
    run.bookmarks.put(tick, time_s, command.name)
    run.keep_bookmarks()


def remove_bookmark(engine: Engine, command: m.RemoveBookmark) -> Outcome:
    engine.run.bookmarks.remove(command.tick)
    engine.run.keep_bookmarks()


def read_situation(engine: Engine, _: m.ReadSituation) -> Outcome:
    first, orders = engine.time.origin()
    began = first.beginning
    assert began is not None  # a recording is refused before
    if isinstance(began, KeptRun):
        orders, began = [*began.orders, *orders], began.beginning
    session = engine.shown.session
    return m.Accepted(session.tick_count, ReplaySpec(began, orders, session))


def open_situation(engine: Engine, request: m.OpenSituation) -> Outcome:
    if not isinstance(request.situation, Situation):
        return m.Refused("situation", None, "this is no situation")
    try:
        engine.open_situation(request.situation)
    except Exception as error:
        return m.Refused("situation", None, f"it cannot be played here: {error}")
    return None


def go_back(engine: Engine, _: m.GoBack) -> Outcome:
    engine.go_back()
    return None
