"""A tick stage by stage: the record is what the engine did."""

from __future__ import annotations

import numpy as np
import pytest

from app.config import Config
from app.session import KEPT, SECOND, Session, Stopwatch
from app.views.history import History
from app.views.snapshots import Snapshots
from app.views.tick_stages import TITLES, Activity, TickRecorder, Walk, excited, inhibited, normalised
from ratslam_core import PoseCellParams, PoseCells
from ratslam_core.slam import STAGES

from .sessions import a_session


def recorded(session: Session) -> tuple[Walk, dict]:
    """A walk through the next tick, and the parts before it."""
    snapshots = Snapshots(session, History(session), 1, ())
    before = snapshots.parts()
    recorder = TickRecorder(session, before)
    session.tick(recorder)
    snapshots.refresh()
    return recorder.walk(snapshots.parts()), before


def activity_of(pose_cells: PoseCells) -> Activity:
    cells, values = pose_cells.active
    order = np.argsort(cells[:, 3])
    return Activity(cells[order, 3].astype(np.int64), values[order].astype(np.float64))


@pytest.mark.parametrize("size", [(8, 8, 36), (64, 64, 36)])
@pytest.mark.parametrize("way", [0.0, 0.9, 3.1])
def test_the_stages_lead_where_the_engine_went(size: tuple[int, int, int], way: float) -> None:
    params = PoseCellParams(n_x=size[0], n_y=size[1], n_theta=size[2])
    pose_cells, rng = PoseCells(params), np.random.default_rng(4)
    for _ in range(6):
        pose_cells.integrate(way * params.cell_m, 0.1)
        cells = rng.choice(len(pose_cells.slot), 40, replace=False).astype(np.int32)
        pose_cells.inject(cells, np.full(40, 0.004, np.float32))
        now = normalised(inhibited(excited(activity_of(pose_cells), params), params))
        pose_cells.attract()
        engine = activity_of(pose_cells)
        mine, its = np.zeros(len(pose_cells.slot)), np.zeros(len(pose_cells.slot))
        mine[now.flat], its[engine.flat] = now.values, engine.values
        assert np.abs(mine - its).max() < 2e-6


def test_every_stage_is_told_in_the_order_of_the_engine() -> None:
    seen: list[str] = []
    session = a_session(10, seed=5)
    session.tick(seen.append)
    assert tuple(seen) == STAGES
    walk, before = recorded(session)
    assert [stage.name for stage in walk.view.stages] == list(TITLES)
    assert all(stage.words.endswith(".") and len(stage.words) < 160 for stage in walk.view.stages)
    assert walk.parts is before
    assert walk.moved(-1) is None


def test_each_stage_shows_pose_cells_and_map_as_they_were() -> None:
    session = a_session(200, seed=5)
    walk: Walk | None
    walk, before = recorded(session)
    parts = {}
    while walk is not None:
        parts[walk.view.stages[walk.view.at].name] = walk.parts
        walk = walk.moved(1)
    cells = {name: part["pose_cells"] for name, part in parts.items() if "pose_cells" in part}
    assert cells["image"] is cells["view match"] is before["pose_cells"]
    assert cells["injection"].total >= 1 - 1e-5
    assert cells["path integration"].total == pytest.approx(cells["injection"].total, rel=1e-5)
    assert cells["excitation"].total == pytest.approx(cells["path integration"].total, rel=1e-5)
    assert cells["excitation"].active_cells > cells["path integration"].active_cells
    assert cells["inhibition"].active_cells < cells["excitation"].active_cells
    assert cells["inhibition"].total < cells["excitation"].total
    assert cells["normalisation"].total == pytest.approx(1, abs=1e-5)
    assert cells["normalisation"].active_cells == cells["inhibition"].active_cells
    assert cells["inhibition"].least > 0
    assert parts["normalisation"]["map"] is before["map"]
    assert len(parts["experience"]["map"].ids) == len(session.brain.experience_map)
    assert len(parts["experience"]["times"].seconds) == len(session.brain.experience_map)
    assert parts["correction"] == {}  # the end of the tick


PHRASES = {
    "view match": ("a new one is stored as #", "it is recognised"),
    "injection": ("Nothing is injected: the view is new", "of the activity, over its links to"),
    "experience": ("is made, linked from #", "it stays active"),
    "correction": ("the farthest experience moved",),
}


@pytest.mark.slow
def test_what_is_new_recognised_or_silent_is_said() -> None:
    """Thirty ticks of every fifty seconds, until each has happened once: all do within twenty minutes."""
    missing = {(name, phrase) for name, phrases in PHRASES.items() for phrase in phrases}
    session = a_session(30, seed=5)
    while missing:
        assert session.tick_count < 12000, missing
        for _ in range(30):
            told = {stage.name: stage.words for stage in recorded(session)[0].view.stages}
            missing -= {(name, phrase) for name, phrase in missing if phrase in told[name]}
        for _ in range(470 * bool(missing)):
            session.tick()


def test_blind_and_standing_there_is_nothing_to_tell() -> None:
    session = a_session(10, seed=5, config=Config().with_value("local_view.enabled", False))
    session.set_mode("manual")
    for _ in range(30):
        session.tick()
    walk, _ = recorded(session)
    words = {stage.name: stage.words for stage in walk.view.stages}
    assert words["view match"].endswith("no view is active.")
    assert words["injection"] == "Nothing is injected: there is no view."


def test_the_stopwatch_keeps_a_hundred_ticks(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr("app.session.time.perf_counter", lambda: now[0])
    watch = Stopwatch(("a", "b"))
    assert watch.mean_and_worst_ms == {"a": (0.0, 0.0), "b": (0.0, 0.0)}
    for tick in range(KEPT + 50):
        watch.start()
        for part, took_s in (("a", 0.5 if tick == 20 else 0.002), ("b", 0.001), ("a", 0.003)):
            now[0] += took_s  # the longest is so long ago that it is forgotten
            watch.lap(part)
        watch.finish()
    told = watch.mean_and_worst_ms
    assert (told["a"], told["b"]) == (pytest.approx((5.0, 5.0)), pytest.approx((1.0, 1.0)))


def test_the_parts_of_a_tick_are_timed_apart() -> None:
    told = a_session(50).stopwatch.mean_and_worst_ms
    assert list(told) == ["pilot", "office and senses", *STAGES, "judging", SECOND]
    assert told.pop(SECOND) == (0, 0)  # there is no second brain
    assert all(0 < mean <= worst for mean, worst in told.values())


def test_between_two_beats_a_tick_has_one_stage() -> None:
    session = a_session(10, seed=5, config=Config().with_value("robot.sensor_rate_hz", 20))
    between = session.brain.beats.due(session.frame.dt) == 0
    for _ in range(2):
        walk, _ = recorded(session)
        names = [stage.name for stage in walk.view.stages]
        assert names == (["image"] if between else list(TITLES))
        between = not between
