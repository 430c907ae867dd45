"""Moments that somebody names."""

from __future__ import annotations

from app.commands.outcome import Outcome, attempt
from app.engine.engine import Engine
from web import messages as m


def put_bookmark(engine: Engine, command: m.PutBookmark) -> Outcome:
    """Of the moment that is shown, or another name for that of a tick."""

    def put() -> None:
        run, shown = engine.run, engine.shown.session
        tick, time_s = shown.tick_count, shown.time_s
        if command.tick is not None:
            before = run.bookmarks.at(command.tick)
            tick, time_s = before.tick, before.time_s
        run.bookmarks.put(tick, time_s, command.name)
        run.keep_bookmarks()

    return attempt("name", command.name, put)


def remove_bookmark(engine: Engine, command: m.RemoveBookmark) -> Outcome:
    def remove() -> None:
        engine.run.bookmarks.remove(command.tick)
        engine.run.keep_bookmarks()

    return attempt("tick", command.tick, remove)
