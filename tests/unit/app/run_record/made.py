"""A run with orders of many kinds, and the situation that it is in; and situations in an engine."""

from __future__ import annotations

from dataclasses import replace

from app.commands import carry_out
from app.config import Config
from app.engine.engine import Engine
from app.orders import Order
from app.run_record.header import beginning_of, header_of
from app.run_record.link import link_of, read_situation
from app.run_record.situation import ReplaySpec, Situation
from app.session import Session
from sim2d import Box, World
from tests.unit.app.engines import an_engine, run_for
from tests.unit.app.sessions import OFFICE
from web import messages as m
from web.messages import CameraAt, Look

LOOK = Look(plate="map", tab="Memory", camera=CameraAt(position=(1.0, -20.5, 1 / 3), look_at=(0, 2, 0), fov_rad=0.5))


def a_situation(
    ticks: int = 120, *, boxes: bool = False, edits: bool = False, world: World | None = None, look: Look = LOOK
) -> Situation:
    session = Session(world or OFFICE, 5, Config().with_values({"pilot.cruise_speed": 0.31}))
    header, orders = header_of(beginning_of(session)), list[Order]()
    session.on_order = orders.append
    for tick in range(ticks):
        if tick == ticks // 4:
            session.kidnap(2.0 + 0.01 / 3, 6.0, 0.1)
        if ticks // 3 <= tick < ticks // 2:
            session.drive(0.1 + tick / 1000, 0.3)
        if tick == ticks // 2:
            session.set_mode("explore")
            session.tag("the kitchen")
        if boxes and tick == ticks // 2:
            session.put_box(Box("crate", 9.0, 1.0 + 1 / 3, 0.4, 0.4, colour=(10, 20, 30)))
        if edits and tick == ticks // 2 + 3:
            session.edit_world(replace(session.world, title="Another title"))
        session.tick()
    session.set_parameters({"robot.gyro_bias": 0.02})  # at the last tick: it counts
    return Situation(header, tuple(orders), session.tick_count, session.state_hash(), look)


def moment_of(engine: Engine) -> Situation:
    """What its page would share, by way of a link."""
    answer = carry_out(engine, m.ReadSituation())
    assert isinstance(answer, m.Accepted)
    assert isinstance(answer.result, ReplaySpec)
    link, why = link_of(answer.result.situation(m.Look()))
    assert link is not None, why
    return read_situation(link)


def again(situation: Situation) -> bool:
    return situation.verdict(situation.play())[0]


def opened(situation: Situation) -> Engine:
    """An engine that was at the seventh tick of another run."""
    engine = an_engine(OFFICE)
    run_for(engine, 7)
    answer = carry_out(engine, m.OpenSituation(situation))
    assert isinstance(answer, m.Accepted), answer
    return engine


def played(situation: Situation) -> tuple[Engine, m.SituationView]:
    """An engine that has played it up to its moment, and what it says of it."""
    engine = opened(situation)
    while engine.runs_ahead:
        engine.run_ahead(0.05)
    return engine, view_of(engine)


def view_of(engine: Engine) -> m.SituationView:
    view = engine.snapshot().situation
    assert view is not None
    return view
