"""A run up to a moment: what it began from, its orders, the hash of its state there, and from where it is looked at. The
engine hands out what leads to the moment between two ticks; the situation is made of it later."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from app.companion import digest_of
from app.order_book import SMALLEST_M, Order, carry_out
from app.runs.header import Beginning, Header, header_of
from app.session import Session
from disk import encode, write_state
from ratslam_core import RatSlam
from ratslam_core.brain_file import read_brain
from sim2d import world_from_json
from web.messages.situation import Look

TELL_AFTER = 10  # ticks between two calls of `tell`


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """header: of the program that made it. orders: all that lead to the moment, oldest first; those of the last tick, too,
    if they had been given. state_hash: of the session then. second_hash: of the second brain then; None: there was none, or the
    program that made the link did not say. brain: the file of the one that the run began with."""

    header: Header
    orders: tuple[Order, ...]
    tick: int
    state_hash: str
    look: Look = Look()
    brain: bytes | None = None
    notes: tuple[str, ...] = ()  # why it may come out differently here
    second_hash: str | None = None

    def begin(self, brain: RatSlam | None = None) -> Session:
        """The session before its first tick. brain: its own, if that has been read already. ValueError says why it cannot
        begin."""
        header = self.header
        world = world_from_json(header.world, f"the world {header.world_name}", SMALLEST_M)
        return Session(world, header.seed, header.config, brain or self.first_brain())

    def first_brain(self) -> RatSlam | None:
        """The brain that the run began with, if it was not a new one. ValueError says what is wrong with it."""
        return None if self.brain is None else read_brain(io.BytesIO(self.brain))

    def play(self, tell: Callable[[int], object] = lambda _ticks: None) -> Session:
        """The session at the moment. ValueError: an order cannot be carried out."""
        session = self.begin()
        orders = list(self.orders[::-1])
        while True:
            while orders and orders[-1].tick <= session.tick_count:
                carry_out(session, orders.pop())
            if session.tick_count >= self.tick:
                return session
            session.tick()
            if session.tick_count % TELL_AFTER == 0:
                tell(TELL_AFTER)

    def verdict(self, session: Session) -> tuple[bool, str]:
        """Whether the session, which has come to the moment, is the same as the one that was linked, and what to say."""
        found, second = session.state_hash(), digest_of(session.companion)
        same_second = self.second_hash is None or second == self.second_hash
        if found == self.state_hash and same_second:
            beside = f", and {second[:12]} of the second brain" if second is not None and self.second_hash else ""
            not_said = " Its link says nothing of the second brain." if second is not None and not beside else ""
            return True, f"The same, bit for bit: state hash {found[:12]}{beside} at tick {self.tick}.{not_said}"
        header = self.header
        made = f"version {header.version}, Python {header.python}, numpy {header.numpy}, {header.platform}"
        by = "this version of the program" if header.same_program else "another version of the program"
        because = "".join(f" {note}" for note in self.notes)
        if found != self.state_hash:
            what = f"state hash {found[:12]} at tick {self.tick}, the link says {self.state_hash[:12]}"
        else:
            whose = "there is no second brain" if second is None else f"the second brain's hash is {second[:12]}"
            what = f"{whose} at tick {self.tick}, the link says {(self.second_hash or '')[:12]}"
        return False, f"Not the same: {what}. It was made by {by} ({made}).{because}"


class LedHere:
    """brain: the one that the run began with, or its file. `situation` takes a while; it may be called from another thread."""

    def __init__(self, began: Beginning, brain: RatSlam | Path | None, orders: list[Order], session: Session) -> None:
        self._began, self._brain, self._orders = began, brain, orders
        self.tick, self.time_s, self.state_hash = session.tick_count, session.time_s, session.state_hash()
        self.second_hash = digest_of(session.companion)
        self.world, self.seed = session.world.name, session.seed

    def situation(self, look: Look) -> Situation:
        """OSError: the brain that a kept run began with cannot be read."""
        header = header_of(self._began)
        return Situation(
            header, tuple(self._orders), self.tick, self.state_hash, look, self._file(), second_hash=self.second_hash
        )

    def _file(self) -> bytes | None:
        if isinstance(self._brain, Path):
            return self._brain.read_bytes()
        if self._brain is None:
            return None
        file = io.BytesIO()
        write_state(encode(self._brain), file)
        return file.getvalue()
