"""What a snapshot says about the engine, of one moment and read-only; building it changes nothing, and what has not changed
is the same object."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import astuple

import numpy as np
import pytest

from app.session import Session
from app.views import arrays as shared_arrays
from app.views import map_layers, snapshots
from app.views.arrays import Slow
from app.views.history import History
from app.views.map_layers import STRONGEST
from app.views.office import known_places
from app.views.snapshots import Snapshots
from tests.unit.app.engines import an_engine
from web import messages as m

from .sessions import OFFICE, a_session


@pytest.fixture(scope="module")
def session() -> Session:
    """A minute of exploring."""
    return a_session(600, seed=5)


def made_of(session: Session) -> Snapshots:
    return Snapshots(session, History(session), 1, (("office", "Office"),))


def build(made: Snapshots) -> m.Snapshot:
    return made.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)


def snapshot(session: Session) -> m.Snapshot:
    return build(made_of(session))


def arrays(value: object, name: str = "snapshot") -> list[tuple[str, np.ndarray]]:
    if isinstance(value, np.ndarray):
        return [(name, value)]
    if isinstance(value, tuple):
        return [found for k, item in enumerate(value) for found in arrays(item, f"{name}[{k}]")]
    slots = getattr(type(value), "__slots__", ())
    return [found for slot in slots for found in arrays(getattr(value, slot), f"{name}.{slot}")]


# ---------------------------------------------------------------- its rows, its moment


@pytest.mark.parametrize("with_goal", [False, True])
def test_snapshots_are_immutable_and_their_rows_agree(with_goal: bool) -> None:
    session = a_session(200)
    if with_goal:
        session.set_goal(0.0, 0.0)
        session.tick()
    now, map_ = snapshot(session), session.brain.experience_map
    found = arrays(now)
    assert len(found) > 20
    assert [name for name, array in found if array.flags.writeable] == []
    assert {now.experiences, *map(len, (now.map.ids, now.map.xy, now.map.heading_rad, now.times.seconds))} == {
        len(map_)
    }
    assert len(now.map.links) == now.links == map_.link_count
    assert now.map.links.max() < len(map_)
    assert now.times.to_goal is with_goal
    assert np.all(now.times.seconds >= 0)
    cells, activity = now.pose_cells, session.brain.pose_cells.activity
    assert len(cells.cells) == len(cells.activity) == min(cells.active_cells, STRONGEST)
    assert np.all(np.diff(cells.activity) <= 0)
    assert activity[tuple(cells.cells[0])] == cells.activity[0] == activity.max()
    assert (cells.total, cells.least > 0) == (pytest.approx(1, abs=1e-5), True)
    series, world = now.series, now.world
    assert len({*map(len, astuple(series))}) == 1
    assert now.coverage is not None
    assert series.explored_percent[-1] == 100 * now.coverage > 0
    assert world is not None
    assert len(world.walls) == len(world.wall_height_m) == len(world.wall_kind)
    assert (now.goal is not None) is with_goal
    if now.goal is not None:
        assert (now.goal.state, now.goal.experience) == ("tracking", session.pilot.goal)
        assert len(now.goal.route_xy) == len(now.goal.route_arrival_s) > 1


def test_a_snapshot_is_of_its_moment() -> None:
    """What the engine does later does not change the snapshot."""
    session = a_session(100)
    made = made_of(session)
    then = build(made)
    kept = [(name, array.copy()) for name, array in arrays(then)]
    for _ in range(60):
        session.tick()
        build(made)
    for (name, before), (_, now) in zip(kept, arrays(then), strict=True):
        assert np.array_equal(before, now, equal_nan=True), name


def test_the_first_snapshot_has_no_best_view() -> None:
    senses = snapshot(a_session()).senses
    assert (senses.best, senses.best_view, senses.difference) == (None, -1, math.inf)
    later = snapshot(a_session(20)).senses
    assert later.best is not None
    assert later.best.shape == later.seen.shape == (9, 12)
    assert later.camera.dtype == np.uint8


# ---------------------------------------------------------------- parts that are built now and then


def test_what_is_unchanged_is_the_same_object(monkeypatch: pytest.MonkeyPatch) -> None:
    session = a_session(50)
    made, clock = made_of(session), [100.0]
    monkeypatch.setattr("app.views.map_layers.time.perf_counter", lambda: clock[0])
    shown = [build(made)]

    def new(after_s: float) -> set[str]:
        """The parts that are other objects than in the snapshot before."""
        clock[0] += after_s
        shown.append(build(made))
        parts = ("world", "map", "times", "parameters")
        return {part for part in parts if getattr(shown[-1], part) is not getattr(shown[-2], part)}

    session.tick()
    assert new(0.1) == set()
    assert new(0.2) == {"times"}  # the map is not due
    assert "map" in new(0.3)
    made.refresh()
    assert "map" in new(0.0)
    session.set_goal(0.0, 0.0)
    assert "map" not in new(0.0)
    assert shown[-1].times.to_goal
    session.set_parameter("robot.light", 0.9)
    assert "parameters" in new(0.0)
    assert {p.name: p.value for p in shown[-1].parameters}["robot.light"] == 0.9


def test_a_slow_part_is_built_when_time_has_come_and_something_has_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(shared_arrays.time, "perf_counter", lambda: now[0])
    built: list[object] = []

    def make() -> object:
        built.append(object())
        now[0] += 0.1  # what it costs
        return built[-1]

    part = Slow(2.0, make)
    first = part.part(1)
    assert part.part(2) is first
    now[0] += 2.5
    assert part.part(3) is first  # it cost 0.1 s: rest for 3 s
    now[0] += 1.0
    assert part.part(1) is first  # paused: nothing new to see
    now[0] += 3.1
    assert part.part(4) is built[1]
    part.due = -math.inf  # a command has changed something while paused
    assert part.part(4) is built[2]


def test_what_stands_still_is_shown_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """The slow parts, too: while it is paused no later snapshot would catch up."""
    for slow in ("OCCUPANCY_EVERY_S", "PLACES_EVERY_S"):
        monkeypatch.setattr(snapshots, slow, math.inf)
    monkeypatch.setattr(map_layers, "MAP_EVERY_S", math.inf)
    engine = an_engine(OFFICE, seed=5)
    first = engine.snapshot()
    engine.running = True
    for tick in range(300):
        if tick == 100:
            engine.run.session.kidnap(1.0, 7.0)  # into the library
        engine.tick()
    late, session = engine.snapshot(), engine.run.session
    engine.running = False  # as at the end of a recording: no command comes, which would have everything drawn anew
    still = engine.snapshot()
    assert (late.places, late.occupancy) == (first.places, first.occupancy)
    assert still.places == known_places(session) != first.places
    assert len(still.map.ids) == len(session.brain.experience_map)
    assert still.occupancy is not None
    assert session.brain.occupancy is not None
    np.testing.assert_array_equal(still.occupancy.cells, session.brain.occupancy.probability)
    again = engine.snapshot()
    assert (again.places, again.map, again.occupancy) == (still.places, still.map, still.occupancy)


# ---------------------------------------------------------------- what the brain knows


def test_occupancy_is_the_engine_s_of_that_moment(session: Session) -> None:
    layer, brain = snapshot(session).occupancy, session.brain
    assert layer is not None
    assert brain.occupancy is not None
    assert brain.map_grid is not None
    np.testing.assert_array_equal(layer.cells, brain.occupancy.probability)
    drawn = brain.map_grid.draw(brain.experience_map.poses)
    for _ in range(30):
        session.tick()  # draws the past moment, not the present one
    picture = layer.draw_map()
    np.testing.assert_array_equal(picture.probability, drawn.probability)
    assert (picture.origin_xy_m, picture.cell_m) == (drawn.origin_xy_m, drawn.cell_m)
    assert not picture.probability.flags.writeable
    kept, brain.occupancy = brain.occupancy, None  # without sonars
    assert snapshot(session).occupancy is None
    brain.occupancy = kept


def test_goal_memory_has_times_once_there_is_a_goal(session: Session) -> None:
    before = snapshot(session).goal_memory
    assert before is not None
    assert (before.links, before.goal, before.seconds) == (len(session.brain.goal_memory), None, None)
    session.pilot.set_goal(0)
    layer = snapshot(session).goal_memory
    session.pilot.cancel_goal()
    assert layer is not None
    assert layer.goal is not None
    assert layer.seconds is not None
    x, y = layer.goal
    assert layer.seconds[y, x] == 0
    state = session.brain.experience_map.cell_state(0)
    assert math.hypot(x - state[0], y - state[1]) < 1
    assert layer.direction_rad is None or -math.pi <= layer.direction_rad <= math.pi


def test_the_hypotheses_of_the_robot_are_shown_where_they_are(session: Session) -> None:
    map_ = session.brain.experience_map
    evidence, here = map_.evidence, map_.robot_here
    kept = deepcopy(evidence.__dict__)
    evidence.end()
    evidence.doubt(len(map_))
    for away, odds in ((3.0, 1.0), (5.0, 2.0), (0.1, 0.5)):  # the last is where it is, and speaks against no other
        evidence._rows[evidence._count, :4] = here.x + away, here.y, here.heading_rad, odds
        evidence._count += 1
    told = snapshot(session).belief
    assert told is not None
    assert told.off_m == map_.pose_filter.sigma_m
    total = sum(math.exp(odds) for odds in (1.0, 2.0, 0.0, 0.0, -evidence.params.unnoticed))
    assert [(other.x - here.x, other.heading_rad, other.share) for other in told.others] == [
        pytest.approx((away, here.heading_rad, math.exp(odds) / total)) for away, odds in ((5.0, 2.0), (3.0, 1.0))
    ]
    evidence.__dict__.update(kept)


def test_its_errors_are_told_apart_and_who_is_lost_is_told() -> None:
    engine = an_engine(OFFICE, seed=5)
    for _ in range(300):
        engine.tick()
    told, judged = engine.snapshot(), engine.run.history.series
    assert (told.error_map_m, told.error_odometry_m) == (judged.error_map_m, judged.error_odometry_m)
    assert told.error_map_m != told.error_odometry_m
    assert not told.lost
    engine.run.session.brain.declare_kidnapped()
    assert engine.snapshot().lost
