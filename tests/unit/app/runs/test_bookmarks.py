"""Named moments are kept with their run, go with a branch as far as it shares them, and are there when the run goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.commands import carry_out
from app.config import Config
from app.engine.engine import Engine
from app.engine.pace import Pace
from app.engine.watchdog import Watchdog
from app.runs.bookmarks import FILE, MOST, Bookmarks, read_bookmarks
from app.runs.folder import all_runs
from app.runs.keeper import RunKeeper
from app.runs.replay import replay, resumed
from app.runs.run_file import open_run
from sim2d import load_world
from tests.unit.app.engines import tell
from web import messages as m

OFFICE = load_world("office")


def kept_engine(keeper: RunKeeper) -> Engine:
    engine = Engine(
        OFFICE, Pace(0.0), Watchdog(60.0, lambda: None), running=True, answer=lambda *_: None, keeper=keeper
    )
    engine.begin(OFFICE, 3, Config())
    return engine


def names(engine: Engine) -> list[tuple[int, str]]:
    view = engine.time.view()
    assert view is not None
    return [(row.tick, row.name) for row in view.bookmarks]


def test_they_are_kept_with_the_run_and_its_branches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    complaints: list[str] = []
    keeper = RunKeeper(complaints.append)
    keeper.start()
    engine = kept_engine(keeper)
    for name in ("soon", "the door", "late"):
        for _ in range(20):
            engine.tick()
        tell(engine, type="put_bookmark", name=f" {name} ")
    tell(engine, type="seek", tick=45)
    tell(engine, type="put_bookmark", name="in the past")
    tell(engine, type="put_bookmark", name="the other door", tick=40)
    tell(engine, type="remove_bookmark", tick=20)
    assert names(engine) == [(40, "the other door"), (45, "in the past"), (60, "late")]
    tell(engine, type="go_on_from_here")
    assert names(engine) == [(40, "the other door"), (45, "in the past")]
    tell(engine, type="remove_bookmark", tick=40)
    for _ in range(3):
        engine.tick()
    tell(engine, type="change_branch", number=1)
    assert names(engine) == [(40, "the other door"), (45, "in the past"), (60, "late")]
    tell(engine, type="put_bookmark", name="at last", tick=60)  # nothing else is marked after it
    keeper.stop()
    assert complaints == []
    kept = {open_run(folder).last_tick: folder for folder in all_runs()}
    assert [row.name for row in read_bookmarks(kept[60]).rows] == ["the other door", "in the past", "at last"]
    assert [row.name for row in read_bookmarks(kept[48]).rows] == ["in the past"]
    run = open_run(kept[60])
    replay(run)  # they change nothing
    going_on = Engine(OFFICE, Pace(0.0), Watchdog(60.0, lambda: None), running=False, answer=lambda *_: None)
    going_on.go_on(run, resumed(run))
    assert names(going_on)[-1] == (60, "at last")


def test_what_is_wrong_is_said() -> None:
    marks = Bookmarks()
    for name in ("", "  ", "a\nb"):
        with pytest.raises(ValueError, match=r"needs a name|no control or bidirectional"):
            marks.put(1, 0.1, name)
    with pytest.raises(ValueError, match="no bookmark at tick 7; there are: none yet"):
        marks.remove(7)
    for tick in range(MOST):
        marks.put(tick, tick / 10, f"{tick}")
    marks.put(3, 0.3, "another name for one that is there")
    with pytest.raises(ValueError, match="would be bookmark number 101"):
        marks.put(MOST, 10.0, "one more")


@pytest.mark.parametrize("text", ["", "[", "{}", '[{"tick": -1, "time_s": 0, "name": "a"}]', '[{"tick": 1}]', "\x00"])
def test_a_damaged_file_costs_the_bookmarks_alone(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text)
    assert read_bookmarks(tmp_path).rows == ()


def test_at_no_tick_of_another_branch() -> None:
    engine = Engine(OFFICE, Pace(0.0), Watchdog(60.0, lambda: None), running=False, answer=lambda *_: None)
    engine.begin(OFFICE, 3, Config())
    refused = carry_out(engine, m.PutBookmark(type="put_bookmark", name="a", tick=9))
    assert isinstance(refused, m.Refused)
    assert refused.reason == "there is no bookmark at tick 9; there are: none yet"
