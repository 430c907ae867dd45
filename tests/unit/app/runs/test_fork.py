"""A branch is kept as a run of its own, which begins with the other's past."""

from __future__ import annotations

from app.commands import carry_out
from app.config import Config
from app.engine.engine import Engine
from app.engine.pace import Pace
from app.engine.watchdog import Watchdog
from app.runs.folder import all_runs
from app.runs.keeper import RunKeeper
from app.runs.replay import replay
from app.runs.run_file import open_run
from sim2d import load_world
from web import messages as m


def test_each_branch_is_kept_and_runs_again() -> None:
    complaints: list[str] = []
    keeper = RunKeeper(complaints.append)
    keeper.start()
    engine = Engine(
        load_world("office"),
        Pace(0.0),
        Watchdog(60.0, lambda: None),
        running=True,
        answer=lambda *_: None,
        keeper=keeper,
    )
    engine.begin(load_world("office"), 3, Config())

    def drive(ticks: int) -> None:
        for _ in range(ticks):
            engine.tick()

    drive(150)
    carry_out(engine, m.Kidnap(type="kidnap", x=2.0, y=6.0))
    drive(60)
    first = engine.run.session.state_hash()
    carry_out(engine, m.Seek(type="seek", tick=150))
    carry_out(engine, m.GoOnFromHere(type="go_on_from_here"))
    carry_out(engine, m.SetMode(type="set_mode", mode="manual"))
    drive(45)
    second = engine.run.session.state_hash()
    carry_out(engine, m.ChangeBranch(type="change_branch", number=1))
    assert engine.run.session.state_hash() == first
    drive(20)
    longer = engine.run.session.state_hash()
    keeper.stop()
    assert complaints == []
    ends = {}
    for folder in all_runs():
        run = open_run(folder)
        ends[run.last_tick] = (replay(run).state_hash(), [order.name for order in run.orders])
    assert ends == {230: (longer, ["kidnap"]), 195: (second, ["set_mode"])}
