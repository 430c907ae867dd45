"""Commands to the office, presets, and parameters that change others with them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest

from app.config import Config, from_toml, to_toml
from app.config.presets import PRESETS, preset, preset_of
from app.engine.engine import Engine
from app.engine_thread import EngineThread
from app.session import Session
from app.views.history import History
from app.views.snapshots import Snapshots
from sim2d import Daylight, Door, Event, Lamp, OfficeParams, Person, SlowZone, World
from web import messages as m

from .engine_threads import accept
from .engines import an_engine, tell
from .worlds import room

PLAIN = room(start=(2.0, 2.0, 0.0))


def living_room() -> World:
    door = Door("lab", 3.0, 3.0, 0.0, 0.8, open=False)
    people = (Person("Ada", ((0.5, 0.5), (0.5, 3.5)), (0.0, 0.0)),)
    return replace(PLAIN, doors=(door,), lamps=(Lamp("sun", 2.0, 2.0, 3.0, 0.5),), people=people)


@pytest.fixture
def engine() -> Engine:
    return an_engine(living_room())


@pytest.fixture
def session(engine: Engine) -> Session:
    return engine.run.session


def shown(session: Session) -> Callable[[], m.Snapshot]:
    """One snapshot after another."""
    made = Snapshots(session, History(session), 1, ())
    return lambda: made.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)


def test_orders_do_what_they_say(engine: Engine, session: Session) -> None:
    assert tell(engine, type="set_door", name="lab", open=True) == "lab opens"
    assert tell(engine, type="set_lamp", name="sun", on=False) == "sun off"
    assert tell(engine, type="put_box", name="crate", x=3.2, y=1.0) == "crate put down"
    for _ in range(30):
        session.tick()
    living = session.simulator.actors
    assert (living.opening[0], bool(living.lamp_on[0])) == (1.0, False)
    assert [box.name for box in session.simulator.world.boxes] == ["crate"]
    assert tell(engine, type="remove_box", name="crate") == "crate taken away"
    assert session.simulator.world.boxes == ()
    assert session.world == living_room()  # a reset begins with the world as it was


def test_orders_that_cannot_be_change_nothing(engine: Engine, session: Session, subtests: pytest.Subtests) -> None:
    before = session.state_hash()
    orders: list[tuple[dict[str, object], str]] = [
        ({"type": "set_door", "name": "lap", "open": True}, r"no door named 'lap'; expected one of: lab"),
        ({"type": "set_lamp", "name": "x", "on": True}, r"no lamp named 'x'; expected one of: sun"),
        ({"type": "put_box", "name": "b", "x": 2.2, "y": 2.0}, r"box 'b' would cover the robot at \(2.00, 2.00\)"),
        ({"type": "put_box", "name": "b", "x": 9.0, "y": 2.0}, r"\(9, 2\) is outside of room"),
        ({"type": "remove_box", "name": "b"}, r"no box named 'b'; expected one of: none"),
        ({"type": "use_preset", "name": "b"}, r"unknown preset 'b'; expected one of: ours, paper-2004, .*, ideal"),
    ]
    for order, reason in orders:
        with subtests.test(reason):
            with pytest.raises(ValueError, match=reason):
                tell(engine, **order)
            assert session.state_hash() == before


def test_an_ideal_robot_reports_the_truth(engine: Engine, session: Session) -> None:
    assert tell(engine, type="use_preset", name="ideal") == "preset ideal"
    for _ in range(20):
        session.tick()
    truth = session.simulator.truth
    assert (session.frame.odometry_speed, session.frame.odometry_yaw_rate) == (truth.speed, truth.yaw_rate)


def test_presets_are_configs() -> None:
    for name in PRESETS:
        config = preset(name, Config())
        assert from_toml(to_toml(config)) == config
        assert {n: v for n, _, v in config.items()}.items() >= PRESETS[name].items(), name
    assert preset("pioneer-2dxe-2004", Config()) == preset("Pioneer 2DXE 2004", Config())  # on a command line
    for config, expected in (
        (preset("Pioneer 2DXE 2004", Config()), "Pioneer 2DXE 2004"), (preset("ideal", Config()), "ideal"),
        (Config(), "ours"), (Config().with_value("local_view.facing", False), ""),
        (preset("paper-2005", preset("ideal", Config())), "paper-2005"),
    ):  # fmt: skip
        assert preset_of(config) == expected


def test_a_preset_is_taken_whole_or_not_at_all(engine: Engine, session: Session) -> None:
    session.set_parameter("robot.robot_radius_m", 0.1)
    session.kidnap(0.15, 2.0, 0.0)
    before, config = session.state_hash(), session.config
    with pytest.raises(ValueError, match=r"robot_radius_m cannot become 0\.22 here: walls\[3\]"):
        tell(engine, type="use_preset", name="Pioneer 2DXE 2004")
    assert (session.state_hash(), session.config) == (before, config)
    session.kidnap(2.0, 2.0, 0.0)
    assert tell(engine, type="use_preset", name="Pioneer 2DXE 2004") == "preset Pioneer 2DXE 2004"
    assert session.simulator.params.robot_radius_m == 0.22
    assert session.set_parameters({"robot.light": 0.5, "pose_cells.n_x": 32}) == ["pose_cells.n_x"]


def test_who_tells_the_brain_another_field_of_view_hears_of_it(start: Callable[..., EngineThread]) -> None:
    engine = start(world=living_room())
    change = m.SetParameter(type="set_parameter", name="local_view.field_of_view", value=1.0)
    accept(engine, change)
    (words,) = [event.text for event in accept(engine, change).events if event.kind == "warning"]  # once, not twice
    assert "local_view.field_of_view is 1 rad but robot.camera_fov_rad is 0.872665 rad" in words
    assert [event.kind for event in accept(engine, m.Reset(type="reset")).events] == ["warning"]
    assert Config().warnings == preset("ideal", Config()).warnings == ()


def test_the_brain_is_told_of_another_field_of_view(session: Session) -> None:
    assert session.set_parameter("robot.camera_fov_rad", 2 * math.pi)
    assert session.brain.params.local_view.field_of_view == 2 * math.pi
    session.set_parameter("local_view.field_of_view", 1.0)  # a wrong value on purpose
    assert session.config.robot.camera_fov_rad == 2 * math.pi
    assert from_toml(to_toml(session.config)) == session.config
    assert from_toml("[local_view]\nfield_of_view = 1.0\n[robot]\ncamera_fov_rad = 2.0").local_view.field_of_view == 1.0


def test_office_switches_act_at_once(session: Session) -> None:
    session.tick()
    assert session.simulator.actors.walkers.present.all()
    assert session.set_parameter("office.people", False)
    session.tick()
    assert not session.simulator.actors.walkers.present.any()
    lit = session.frame.image.mean()
    assert session.set_parameter("office.lamps", False)
    session.tick()
    assert session.frame.image.mean() < 0.9 * lit


def test_the_living_layer_is_the_same_object_until_something_moves(engine: Engine, session: Session) -> None:
    snapshot = shown(session)

    def layer() -> m.LivingLayer:
        living = snapshot().living
        assert living is not None
        return living

    session.set_parameter("office.people", False)
    session.tick()
    still = layer()
    assert layer() is still
    assert still.people.shape == (0, 5)
    assert still.doors == pytest.approx(np.array([[3.0, 3.0, 3.8, 3.0]]))
    tell(engine, type="set_door", name="lab", open=True)
    session.tick()
    assert layer() is not still
    assert layer().doors[0, 3] > 3.0
    tell(engine, type="put_box", name="crate", x=3.2, y=1.0)
    assert layer().boxes == pytest.approx(np.array([[3.2, 1.0, 0.5, 0.5, 0.6, 0.0]]))
    assert not layer().doors.flags.writeable


def test_what_is_shown_is_what_the_world_has_also_after_an_edit(engine: Engine, session: Session) -> None:
    snapshot = shown(session)
    numbers = ("door_s", "patience_least_s", "patience_most_s")
    assert snapshot().switches == ("people", "lamps", *numbers, "seed")
    tell(engine, type="put_box", name="crate", x=3.2, y=1.0)
    assert snapshot().switches == ("people", "lamps", *numbers, "boxes", "seed")
    world = session.simulator.world
    zone = SlowZone("carpet", ((0.5, 0.5), (1.0, 0.5), (1.0, 1.0)), 0.5)
    rest = {"daylight": Daylight((0.0,), (1.0,)), "script": (Event(900.0, "people_off"),), "slow_zones": (zone,)}
    doors = (replace(world.doors[0], period_s=60.0, open_s=30.0),)
    walls = (replace(world.walls[0], kind="glass"), *world.walls[1:])
    session.edit_world(replace(world, doors=doors, walls=walls, **rest))
    assert set(snapshot().switches) == {field.name for field in fields(OfficeParams)}  # something for each of them
    edited = room((0.5, 3.0, 1.5, 3.0), start=(2.0, 2.0, 0.0))
    session.edit_world(edited)
    assert session.world is edited  # it outlives a reset
    now = snapshot()
    assert now.world is not None
    assert (now.switches, now.living, len(now.world.walls)) == ((), None, len(PLAIN.walls) + 1)
