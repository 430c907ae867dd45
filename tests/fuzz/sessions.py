"""Whole sessions that were spoilt and signed again, and what one that is accepted all the same is made to do."""

from __future__ import annotations

import io
from functools import cache
from random import Random

from app.session import Session, spread_goals
from app.session_snapshot import read_session, take_session
from disk import State, write_state
from sim2d import load_world
from tests.fuzz.brains import file_of, state_of
from tests.fuzz.mutators import bytes_spoilt

WORLDS = ("living", "loop")


@cache
def bases() -> tuple[State, ...]:
    """Sessions that have driven, been carried off, and are on their way to a goal."""
    return tuple(take_session(_driven(world)) for world in WORLDS)


def _driven(world: str) -> Session:
    session = Session(load_world(world), 2)
    for tick in range(220):
        if tick == 120:
            session.kidnap()
        if tick == 180:
            session.pilot.set_goal(spread_goals(session, 1)[0])
        session.tick()
    return session


@cache
def _packed() -> tuple[bytes, ...]:
    return tuple(file_of(base.tree, base.arrays) for base in bases())


def file_spoilt(rng: Random) -> bytes:
    """A session's file with other bytes."""
    return bytes_spoilt(rng.choice(_packed()), rng, rng.choice(_packed()))


def state_spoilt(rng: Random) -> bytes:
    """A session's file with another state, and a digest that fits."""
    return file_of(*state_of(rng.choice(bases()), rng))


def use(data: bytes) -> str:
    """Go on with the session, partly by hand and after a kidnap, and save it again. Returns what became of it."""
    session = read_session(io.BytesIO(data))
    for tick in range(12):
        if tick == 4:
            session.pilot.drive(0.3, -0.5)
        if tick == 8:
            session.kidnap()
            session.set_mode("explore")
        session.tick()
    session.state_hash()
    write_state(take_session(session), io.BytesIO())
    return "taken"


def warm() -> None:
    """Compile whatever a case needs."""
    for data in _packed():
        use(data)
