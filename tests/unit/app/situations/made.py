"""A run with orders of many kinds, and the situation that it is in."""

from __future__ import annotations

from dataclasses import replace

from app.config import Config
from app.order_book import Order
from app.runs.header import beginning_of, header_of
from app.session import Session
from app.situations import Situation
from sim2d import Box, World, load_world
from web.messages import CameraAt, Look

LOOK = Look(plate="map", tab="Memory", camera=CameraAt(position=(1.0, -20.5, 1 / 3), look_at=(0, 2, 0), fov_rad=0.5))


def a_situation(
    ticks: int = 120, *, boxes: bool = False, edits: bool = False, world: World | None = None, look: Look = LOOK
) -> Situation:
    session = Session(world or load_world("office"), 5, Config().with_values({"pilot.cruise_speed": 0.31}))
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
