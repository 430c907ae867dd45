"""A branch is kept as a run of its own, which begins with the other's past. Named moments are kept with their run, go with a
branch as far as it shares them, and are there when the run goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.engine.engine import Engine
from app.run_record.bookmarks import FILE, MOST, Bookmarks, read_bookmarks
from app.run_record.folder import all_runs
from app.run_record.reader import open_run
from app.run_record.resume import replayed, resumed
from tests.unit.app.engines import an_engine, not_begun, run_for, tell
from tests.unit.app.sessions import OFFICE

from .kept import Keeping


def names(engine: Engine) -> list[tuple[int, str]]:
    view = engine.time.view()
    assert view is not None
    return [(row.tick, row.name) for row in view.bookmarks]


def test_each_branch_is_kept_with_its_bookmarks_and_runs_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    kept = Keeping()
    engine = kept.engine
    for name in ("soon", "the door"):
        run_for(engine, 20)
        tell(engine, type="put_bookmark", name=f" {name} ")
    run_for(engine, 5)
    tell(engine, type="kidnap", x=2.0, y=6.0)
    run_for(engine, 15)
    tell(engine, type="put_bookmark", name="late")
    first = engine.run.session.state_hash()
    tell(engine, type="seek", tick=45)
    tell(engine, type="put_bookmark", name="in the past")
    tell(engine, type="put_bookmark", name="the other door", tick=40)
    tell(engine, type="remove_bookmark", tick=20)
    of_first = [(40, "the other door"), (45, "in the past"), (60, "late")]
    assert names(engine) == of_first
    tell(engine, type="go_on_from_here")
    assert names(engine) == of_first[:2]
    tell(engine, type="set_mode", mode="manual")
    tell(engine, type="remove_bookmark", tick=40)
    run_for(engine, 3)
    second = engine.run.session.state_hash()
    tell(engine, type="change_branch", number=1)
    assert (names(engine), engine.run.session.state_hash()) == (of_first, first)
    tell(engine, type="put_bookmark", name="at last", tick=60)
    run_for(engine, 10)
    longer = kept.stop()
    runs = {run.tick: run for run in map(open_run, all_runs())}
    ends = {tick: (replayed(run).state_hash(), [order.name for order in run.orders]) for tick, run in runs.items()}
    assert ends == {70: (longer, ["kidnap"]), 48: (second, ["set_mode"])}
    marks = {tick: [row.name for row in read_bookmarks(run.folder).rows] for tick, run in runs.items()}
    assert marks == {70: ["the other door", "in the past", "at last"], 48: ["in the past"]}
    going_on = not_begun(OFFICE)
    going_on.go_on(runs[70], resumed(runs[70]))
    assert names(going_on)[-1] == (60, "at last")


def test_what_is_wrong_with_a_bookmark_is_said() -> None:
    marks = Bookmarks()
    for name in ("", "  ", "a\nb"):
        with pytest.raises(ValueError, match=r"needs a name|no control or bidirectional"):
            marks.put(1, 0.1, name)
    with pytest.raises(ValueError, match="no bookmark at tick 7; there are: none yet"):
        marks.remove(7)
    with pytest.raises(ValueError, match="there is no bookmark at tick 9; there are: none yet"):
        tell(an_engine(OFFICE), type="put_bookmark", name="a", tick=9)
    for tick in range(MOST):
        marks.put(tick, tick / 10, f"{tick}")
    marks.put(3, 0.3, "another name for one that is there")
    with pytest.raises(ValueError, match="would be bookmark number 101"):
        marks.put(MOST, 10.0, "one more")


def test_a_damaged_file_costs_the_bookmarks_alone(tmp_path: Path) -> None:
    for text in ("", "[", "{}", '[{"tick": -1, "time_s": 0, "name": "a"}]', '[{"tick": 1}]', "\x00"):
        (tmp_path / FILE).write_text(text)
        assert read_bookmarks(tmp_path).rows == (), text
