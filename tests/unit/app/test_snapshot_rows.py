"""A snapshot's arrays are read-only and of one moment; parts that have not changed are the same objects."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.session import Session
from app.views.history import History
from app.views.pose_cell_layer import STRONGEST
from app.views.snapshots import Snapshots
from web.messages import Snapshot

from .sessions import a_session


def arrays(value: object, name: str = "snapshot") -> list[tuple[str, np.ndarray]]:
    if isinstance(value, np.ndarray):
        return [(name, value)]
    if isinstance(value, tuple):
        return [found for k, item in enumerate(value) for found in arrays(item, f"{name}[{k}]")]
    slots = getattr(type(value), "__slots__", ())
    return [found for slot in slots for found in arrays(getattr(value, slot), f"{name}.{slot}")]


def snapshots(session: Session) -> Snapshots:
    return Snapshots(session, History(session), 1, (("office", "Office"),))


def build(made: Snapshots) -> Snapshot:
    return made.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)


@pytest.mark.parametrize("with_goal", [False, True])
def test_snapshots_are_immutable_and_their_rows_agree(with_goal: bool) -> None:
    session = a_session(200)
    if with_goal:
        session.set_goal(0.0, 0.0)
        session.tick()
    snapshot = build(snapshots(session))
    found = arrays(snapshot)
    assert len(found) > 20
    for name, array in found:
        assert not array.flags.writeable, name
    n = len(session.brain.experience_map)
    assert snapshot.experiences == n
    assert len(snapshot.map.ids) == len(snapshot.map.xy) == len(snapshot.map.heading_rad) == n
    assert len(snapshot.times.seconds) == n
    assert len(snapshot.map.links) == snapshot.links == session.brain.experience_map.link_count
    assert snapshot.map.links.max() < n
    assert snapshot.times.to_goal is with_goal
    assert np.all(snapshot.times.seconds >= 0)
    cells = snapshot.pose_cells
    assert len(cells.cells) == len(cells.activity) == min(cells.active_cells, STRONGEST)
    assert np.all(np.diff(cells.activity) <= 0)
    t, y, x = cells.cells[0]
    assert session.brain.pose_cells.activity[t, y, x] == cells.activity[0] == session.brain.pose_cells.activity.max()
    assert len({len(column) for column in (
        snapshot.series.time_s, snapshot.series.map_error_m, snapshot.series.views, snapshot.series.experiences
    )}) == 1  # fmt: skip
    assert len(snapshot.world.walls) == len(snapshot.world.wall_height_m) == len(snapshot.world.wall_kind)
    assert (snapshot.goal is not None) is with_goal
    if with_goal:
        assert snapshot.goal.state == "tracking"
        assert len(snapshot.goal.route_xy) == len(snapshot.goal.route_arrival_s) > 1
        assert snapshot.goal.experience == session.pilot.goal


def test_a_snapshot_is_of_its_moment() -> None:
    """What the engine does later does not change the snapshot."""
    session = a_session(100)
    made = snapshots(session)
    snapshot = build(made)
    kept = [(name, array.copy()) for name, array in arrays(snapshot)]
    for _ in range(60):
        session.tick()
        build(made)
    for (name, before), (_, now) in zip(kept, arrays(snapshot), strict=True):
        assert np.array_equal(before, now, equal_nan=True), name


def test_what_is_unchanged_is_the_same_object(monkeypatch: pytest.MonkeyPatch) -> None:
    session = a_session(50)
    made = snapshots(session)
    clock = [100.0]
    monkeypatch.setattr("app.views.map_layers.time.perf_counter", lambda: clock[0])
    first = build(made)
    clock[0] += 0.1
    session.tick()
    second = build(made)
    assert first.world is second.world
    assert first.map is second.map
    assert first.times is second.times
    assert first.parameters is second.parameters
    clock[0] += 0.2  # times are due, the map is not
    third = build(made)
    assert third.map is first.map
    assert third.times is not first.times
    clock[0] += 0.3
    fourth = build(made)
    assert fourth.map is not first.map
    made.refresh()
    fifth = build(made)
    assert fifth.map is not fourth.map
    session.set_goal(0.0, 0.0)
    sixth = build(made)
    assert sixth.map is fifth.map
    assert sixth.times.to_goal
    session.set_parameter("robot.light", 0.9)
    seventh = build(made)
    assert seventh.parameters is not first.parameters
    assert {p.name: p.value for p in seventh.parameters}["robot.light"] == 0.9


def test_the_first_snapshot_has_no_best_view() -> None:
    senses = build(snapshots(a_session())).senses
    assert (senses.best, senses.best_view, senses.difference) == (None, -1, math.inf)
    later = build(snapshots(a_session(20))).senses
    assert later.best is not None
    assert later.best.shape == later.seen.shape == (9, 12)
    assert later.camera.dtype == np.uint8
