"""A run to be exported, without a disk: a session that is ticked, and given orders as a kept run gives them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from app.config import Config
from app.session import Session
from sim2d import World

from .sessions import OFFICE


@dataclass
class AgainAndAgain:
    """Stands in for a kept run. orders: what is done after which tick."""

    last_tick: int
    world: World = OFFICE
    seed: int = 3
    config: Config | None = None
    orders: dict[int, Callable[[Session], object]] = field(default_factory=dict)
    name: str = "2026-01-02-office"

    @property
    def length_s(self) -> float:
        return self.last_tick / 10

    def replay(self, until: int | None = None) -> Iterator[Session]:
        session = Session(self.world, self.seed, self.config)
        yield session
        while session.tick_count < (self.last_tick if until is None else until):
            if session.tick_count in self.orders:
                self.orders[session.tick_count](session)
            session.tick()
            yield session


def silent(_simulated_s: float, _what: str) -> None:
    """Progress that nobody follows."""
