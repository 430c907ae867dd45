"""A run up to a moment, to be given to others: with the hash of its state there, and from where it is looked at. The engine
hands out what leads to the moment between two ticks; the situation is made of it later."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

from app.companion import digest_of
from app.orders import Order
from app.run_record.header import Beginning, header_of
from app.run_record.record import RunRecord
from app.session import Session
from disk import encode, write_state
from ratslam_core import RatSlam
from ratslam_core.brain_file import read_brain
from web.messages.situation import Look


@dataclass(slots=True, eq=False)
class Situation(RunRecord):
    """The record of a run whose `tick` is the moment. state_hash: of the session then. second_hash: of the second brain then;
    None: there was none, or the program that made the link did not say. brain: the file of the one that the run began with."""

    state_hash: str
    look: Look = Look()
    brain: bytes | None = None
    notes: tuple[str, ...] = ()  # why it may come out differently here
    second_hash: str | None = None

    def first_brain(self) -> RatSlam | None:
        return None if self.brain is None else read_brain(io.BytesIO(self.brain))

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


class ReplaySpec:
    """What leads to a moment. `situation` takes a while; it may be called from another thread."""

    def __init__(self, began: Beginning, orders: list[Order], session: Session) -> None:
        self._began, self._orders = began, orders
        self.tick, self.time_s, self.state_hash = session.tick_count, session.time_s, session.state_hash()
        self.second_hash = digest_of(session.companion)
        self.world, self.seed = session.world.name, session.seed

    def situation(self, look: Look) -> Situation:
        """OSError: the brain that a kept run began with cannot be read."""
        return Situation(
            header_of(self._began), tuple(self._orders), self.tick, self.state_hash, look, self._file(),
            second_hash=self.second_hash,
        )  # fmt: skip

    def _file(self) -> bytes | None:
        brain = self._began.brain
        if isinstance(brain, Path):
            return brain.read_bytes()
        if brain is None:
            return None
        file = io.BytesIO()
        write_state(encode(brain), file)
        return file.getvalue()
