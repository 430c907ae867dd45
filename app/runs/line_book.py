"""The lines of a run's file, from what the engine tells."""

from __future__ import annotations

import base64
from typing import Any

from app.order_book import Order, overtakes
from app.runs.journal import Journal
from app.runs.world_edits import edit_of, require_room

TICKS_A_LINE = 500  # at most: what was told since the keeper looked last is one line


class LineBook:
    """Ticks are gathered to lines; every other line comes behind all ticks up to its own."""

    def __init__(self, journal: Journal, world_text: str, tick: int, orders: int = 0, edited_bytes: int = 0) -> None:
        """world_text: as last edited; tick: the last one in the journal, which has so many orders and such edits."""
        self._journal, self._text, self._tick = journal, world_text, tick
        self._pulses = b""
        self.is_empty = tick == 0
        self._orders, self._edited_bytes = orders, edited_bytes
        self._waiting: Order | None = None  # another may come that does alone what both do

    def tick(self, tick: int, pulse: bytes) -> None:
        try:
            self._settle()
        finally:  # a full disk keeps nothing out of the file: it waits in the journal
            self._tick, self._pulses, self.is_empty = tick, self._pulses + pulse, False
        if tick % TICKS_A_LINE == 0:
            self.flush()

    def flush(self) -> None:
        """Write the ticks that wait for their line, and what waits for the disk."""
        try:
            self._ticks()
        finally:
            self._settle()
        self._journal.flush()

    def _ticks(self) -> None:
        if self._pulses:
            pulses, self._pulses = base64.b64encode(self._pulses).decode(), b""
            self._journal.add({"tick": self._tick, "pulses": pulses})

    def order(self, order: Order) -> None:
        """ValueError: a run has no room for so many."""
        try:
            if self._waiting is not None and not overtakes(order, self._waiting):
                self._settle()
        finally:
            self._waiting, self.is_empty = order, False

    def _settle(self) -> None:
        """The order that waits is one of its own."""
        order, self._waiting = self._waiting, None
        if order is None:
            return
        self._orders += 1
        try:
            require_room(self._orders, self._edited_bytes)
        except ValueError:
            self._ticks()  # the last that can be run again
            raise
        line: dict[str, Any] = {"tick": order.tick, "order": order.name, "values": order.values}
        if "world" in order.values:
            text = order.values["world"]
            line |= {"values": {key: value for key, value in order.values.items() if key != "world"}}
            line |= {"edit": edit_of(self._text, text)}
            self._edited_bytes += len(text)
            require_room(self._orders, self._edited_bytes)
            self._text = text
        self._add(line)

    def hash(self, tick: int, state_hash: str, experiences: int) -> None:
        self._add({"tick": tick, "hash": state_hash, "experiences": experiences})

    def again(self, version: str) -> None:
        """Another program goes on with the run."""
        self._add({"tick": self._tick, "again": version})

    def end(self, why: str) -> None:
        self._add({"tick": self._tick, "end": why})

    def _add(self, line: dict[str, Any]) -> None:
        try:
            self.flush()
        finally:
            self._journal.add(line)
