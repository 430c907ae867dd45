"""A run as data: what it began from, and each order that it was given, with its tick. That is enough to make it again, bit
for bit. Read this first.

A run that was kept, a situation, a moment of the past and a branch that goes on from it, a run that is gone on with after a
crash: each is a use of `replay`.
"""

from __future__ import annotations

import math
import struct
import zlib
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.orders import SMALLEST_M, Order, carry_out, check_order
from app.run_record.header import Header

if TYPE_CHECKING:  # they load all kernels, and `ratslam runs` only lists
    from app.sensor_input import Lap
    from app.session import Session
    from ratslam_core import RatSlam


def _tick(session: Session, watch: Lap | None) -> None:
    session.tick(watch)


def replay(
    session: Session,
    orders_after: Callable[[int], Iterable[Order]],
    until: float = math.inf,
    *,
    give: Callable[[Session, Order], object] = carry_out,
    tick: Callable[[Session, Lap | None], object] = _tick,
) -> Generator[Session, Lap | None]:
    """Run a session on by its orders: it is yielded as it is, and after each tick up to `until`. The orders of a tick are
    given when the next one is asked for; what is sent then watches it.

    orders_after: those that were given after a tick and before the next. give, tick: another way to do that.
    ValueError: an order cannot be carried out.
    """
    while True:
        watch = yield session
        for order in orders_after(session.tick_count):
            try:
                give(session, order)
            except Exception as error:  # it may be of another version, or of somebody who made it up
                words = f"the order {order.name} of tick {order.tick} cannot be carried out: {error}"
                raise ValueError(words) from error
        if session.tick_count >= until or session.source.over:
            return
        tick(session, watch)


def orders_at(orders: Sequence[Order], tick: int) -> Sequence[Order]:
    """Those of this tick. orders: by tick."""
    first = bisect_left(orders, tick, key=lambda order: order.tick)
    return orders[first : bisect_right(orders, tick, first, key=lambda order: order.tick)]


@dataclass(slots=True)
class RunRecord:
    """orders: by tick; those of the last one, too, if they had been given. tick: the last that is known to have been run."""

    header: Header
    orders: Sequence[Order]
    tick: int

    @property
    def name(self) -> str:
        return f"of {self.header.world_name}"

    def begin(self, brain: RatSlam | None = None) -> Session:
        """The session before its first tick. brain: its own, if that has been read already. ValueError says why it cannot
        begin."""
        from app.session import Session
        from sim2d import world_from_json

        header = self.header
        if header.recording is not None:
            return self._recorded()
        world = world_from_json(header.world, f"the world {header.world_name}", SMALLEST_M)
        return Session(world, header.seed, header.config, brain or self.first_brain())

    def first_brain(self) -> RatSlam | None:
        """The brain that the run began with; None: a new one. ValueError says what is wrong with it."""
        return None

    def _recorded(self) -> Session:
        """ValueError: its recording has moved, has changed, or cannot be played."""
        from app.recordings.opening import fingerprint
        from app.recordings.playing import Player
        from app.recordings.reader_process import ReaderProcess
        from app.session import played_session

        header, kept = self.header, self.header.recording
        assert kept is not None
        path = Path(kept.path)
        whose = f"the run {self.name} plays the recording {path}"
        try:
            if not path.exists():
                raise ValueError(f"{whose}, which is not there any more: put it back to go on with the run")
            same = fingerprint(path) == kept.digest
        except OSError as error:
            raise ValueError(f"{whose}, which cannot be read: {error.strerror or error}") from None
        if not same:
            raise ValueError(f"{whose}, which has changed since: the run cannot be played again")
        return played_session(Player(ReaderProcess(path), header.seed, header.config, path), header.seed)

    def orders_after(self, tick: int) -> Sequence[Order]:
        return orders_at(self.orders, tick)

    def replay(self, until: int | None = None, session: Session | None = None) -> Generator[Session, Lap | None]:
        """Run it again, as `replay` does. until: the last tick, by default that of the run. session: one of this run to go on
        from, before the orders of its tick."""
        last = self.tick if until is None else min(until, self.tick)
        return replay(self.begin() if session is None else session, self.orders_after, last, give=_checked)

    def play(self) -> Session:
        """The session at the end of the run, with all orders. ValueError: it cannot be run again."""
        session = self.begin()
        for _ in self.replay(session=session):
            pass
        return session


def _checked(session: Session, order: Order) -> None:
    check_order(order)
    carry_out(session, order)


CHECKSUM_BYTES = 4
_NUMBERS = struct.Struct("<12d")


def tick_checksum(session: Session) -> bytes:
    """A checksum of the tick that the session has just run: ground truth, what is sensed, pose estimate. It
    costs some microseconds; a `state_hash` ten thousand times that.

    Of the picture it holds how much it differs from the most similar view: a sum over the picture alone would cost more
    than all the rest.
    """
    truth, frame, estimate = session.truth, session.frame, session.estimate
    x, y, heading_rad = (truth.x, truth.y, truth.heading_rad) if truth else (0.0, 0.0, 0.0)  # a recording may have none
    pose, packet, seen = estimate.pose_map_robot, estimate.packet, estimate.recognition
    numbers = _NUMBERS.pack(
        x, y, heading_rad, frame.odometry_speed, frame.odometry_yaw_rate, pose.x, pose.y,
        pose.heading_rad, packet.mass, estimate.experience, seen.view, seen.difference,
    )  # fmt: skip
    return zlib.crc32(numbers).to_bytes(CHECKSUM_BYTES, "little")
