"""Sessions that have run for a while."""

from __future__ import annotations

from app.config import Config
from app.session import Session
from sim2d import World, load_world

OFFICE = load_world("office")


def a_session(ticks: int = 0, seed: int = 3, world: World = OFFICE, config: Config | None = None) -> Session:
    session = Session(world, seed, config)
    for _ in range(ticks):
        session.tick()
    return session
