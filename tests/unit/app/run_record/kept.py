"""Runs that keep themselves as files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from app.run_record.header import beginning_of
from app.run_record.reader import KeptRun, open_run
from app.run_record.writer import RunKeeper
from app.session import Session
from sim2d import load_world
from tests.unit.app.engines import an_engine, not_begun
from tests.unit.app.sessions import OFFICE

TICKS = 150
Orders = dict[int, Callable[[Session], object]]


def keep_one(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    seed: int = 3,
    ticks: int = TICKS,
    complaints: list[str] | None = None,
    orders: Orders | None = None,
) -> tuple[KeptRun, str]:
    """A short run with orders, by the tick before which they are given, kept in this folder; and its state_hash at the end."""
    orders = orders or {ticks // 3: lambda s: s.kidnap(), ticks // 2: lambda s: s.drive(0.2, 0.1)}
    monkeypatch.setenv("RATSLAM_RUNS", str(folder))
    session = Session(load_world("living"), seed)
    keeper = RunKeeper((complaints if complaints is not None else []).append)
    keeper.start()
    feed = keeper.feed(session, beginning_of(session))
    session.on_order = feed.order
    keeper.begin(feed)
    for tick in range(ticks):
        if tick in orders:
            orders[tick](session)
        session.tick()
        feed.tick(session)
    session.set_mode("explore")
    keeper.stop()
    return open_run("last"), session.state_hash()


def keep_ticks(session: Session, ticks: int, complain: Callable[[str], object] = print) -> KeptRun:
    """The run of a session that has just begun, of so many ticks, as a program keeps it that then ends."""
    keeper = RunKeeper(complain)
    keeper.start()
    feed = keeper.feed(session, beginning_of(session))
    session.on_order = feed.order
    keeper.begin(feed)
    for _ in range(ticks):
        session.tick()
        feed.tick(session)
    feed.leave(session)
    keeper.stop()
    return open_run("last")


class Keeping:
    """An engine whose runs keep themselves."""

    def __init__(self, *, begins: bool = True) -> None:
        self.complaints: list[str] = []
        self.keeper = RunKeeper(self.complaints.append)
        self.keeper.start()
        self.engine = (an_engine if begins else not_begun)(OFFICE, keeper=self.keeper)

    def stop(self) -> str:
        """The hash at its end."""
        self.keeper.stop()
        assert self.complaints == []
        return self.engine.run.session.state_hash()
