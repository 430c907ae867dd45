"""A run that kept itself, as a file."""

from __future__ import annotations

from pathlib import Path

from app.runs.header import beginning_of
from app.runs.keeper import RunKeeper
from app.runs.run_file import KeptRun, open_run
from app.session import Session
from sim2d import load_world

TICKS = 150


def keep_one(
    folder: Path, monkeypatch, seed: int = 3, ticks: int = TICKS, complaints: list[str] | None = None
) -> tuple[KeptRun, str]:
    """A short run with orders, kept in this folder, and its state_hash at the end."""
    monkeypatch.setenv("RATSLAM_RUNS", str(folder))
    session = Session(load_world("living"), seed)
    keeper = RunKeeper((complaints if complaints is not None else []).append)
    keeper.start()
    book = keeper.book(session, beginning_of(session))
    session.on_order = book.order
    keeper.begin(book)
    for tick in range(ticks):
        if tick == ticks // 3:
            session.kidnap()
        if tick == ticks // 2:
            session.drive(0.2, 0.1)
        session.tick()
        book.tick(session)
    session.set_mode("explore")
    keeper.stop()
    return open_run("last"), session.state_hash()
