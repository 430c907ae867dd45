"""What a snapshot says about the engine, and that building it changes nothing."""

from __future__ import annotations

import math
from copy import deepcopy

import numpy as np
import pytest

from app.session import Session
from app.views import map_layers, snapshots, throttle
from app.views.history import History
from app.views.places import known_places
from app.views.snapshots import Snapshots
from app.views.throttle import Slow
from sim2d import load_world
from tests.unit.app.engines import an_engine
from web import messages as m

OFFICE = load_world("office")


@pytest.fixture(scope="module")
def session() -> Session:
    """A minute of exploring."""
    session = Session(OFFICE, 5)
    for _ in range(600):
        session.tick()
    return session


def build(session: Session) -> m.Snapshot:
    made = Snapshots(session, History(session), 1, ())
    return made.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)


def test_occupancy_is_the_engine_s_of_that_moment(session: Session) -> None:
    layer = build(session).occupancy
    assert layer is not None
    brain = session.brain
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


def test_without_sonars_there_is_no_occupancy(session: Session) -> None:
    kept, session.brain.occupancy = session.brain.occupancy, None
    assert build(session).occupancy is None
    session.brain.occupancy = kept


def test_goal_memory_has_times_once_there_is_a_goal(session: Session) -> None:
    before = build(session).goal_memory
    assert before is not None
    assert (before.links, before.goal, before.seconds) == (len(session.brain.goal_memory), None, None)
    session.pilot.set_goal(0)
    layer = build(session).goal_memory
    session.pilot.cancel_goal()
    assert layer is not None
    assert layer.goal is not None
    assert layer.seconds is not None
    x, y = layer.goal
    assert layer.seconds[y, x] == 0
    state = session.brain.experience_map.cell_state(0)
    assert math.hypot(x - state[0], y - state[1]) < 1
    assert layer.direction_rad is None or -math.pi <= layer.direction_rad <= math.pi


def test_the_attractor_s_invariants_are_shown(session: Session) -> None:
    cells = build(session).pose_cells
    assert cells.total == pytest.approx(1, abs=1e-5)
    assert cells.least > 0


def test_a_slow_part_is_built_when_time_has_come_and_something_has_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(throttle.time, "perf_counter", lambda: now[0])
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


def test_the_hypotheses_of_the_robot_are_shown_where_they_are(session: Session) -> None:
    map_ = session.brain.experience_map
    evidence, here = map_.evidence, map_.robot_here
    told = build(session).belief
    assert told is not None
    assert told.off_m == map_.pose_filter.sigma_m
    kept = deepcopy(evidence.__dict__)
    evidence.end()
    evidence.doubt(len(map_))
    for away, odds in ((3.0, 1.0), (5.0, 2.0), (0.1, 0.5)):  # the last is where it is
        evidence._rows[evidence._count, :4] = here.x + away, here.y, here.heading_rad, odds
        evidence._count += 1
    told = build(session).belief
    assert told is not None
    total = sum(math.exp(odds) for odds in (1.0, 2.0, 0.5, 0.0, -evidence.params.unnoticed))
    found = [(other.x - here.x, other.heading_rad, other.share) for other in told.others]
    assert found == [
        pytest.approx((5.0, here.heading_rad, math.exp(2.0) / total)),
        pytest.approx((3.0, here.heading_rad, math.exp(1.0) / total)),
    ]
    evidence.__dict__.update(kept)


def test_what_stands_still_is_shown_as_it_is(monkeypatch) -> None:
    """The slow parts, too: while it is paused no later snapshot would catch up."""
    for slow in ("OCCUPANCY_EVERY_S", "PLACES_EVERY_S"):
        monkeypatch.setattr(snapshots, slow, math.inf)
    monkeypatch.setattr(map_layers, "MAP_EVERY_S", math.inf)
    engine = an_engine(OFFICE, seed=5)
    first = engine.snapshot()
    engine.running = True
    for _ in range(1700):  # it has been in the library by then
        engine.tick()
    late = engine.snapshot()
    session = engine.run.session
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
