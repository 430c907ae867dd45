"""What leads to a moment, as the engine hands it out between two ticks; the situation is made of it later."""

from __future__ import annotations

import io
from pathlib import Path

from app.companion import digest_of
from app.order_book import Order
from app.runs.header import Beginning, header_of
from app.session import Session
from app.situations.situation import Situation
from disk import encode, write_state
from ratslam_core import RatSlam
from web.messages.situation import Look


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
