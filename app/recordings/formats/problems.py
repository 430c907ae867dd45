"""What is wrong with a recording, in sentences: the first ones of each kind, and how many more there are. And how much
of each source was read, which is counted where it comes in and again where it is used."""

from __future__ import annotations

from app.recordings.recording import Count
from disk.words import plain

TOLD = 10  # sentences of one kind


class Problems:
    """Collects sentences. The same one counts once, so that a recording may be read more than once."""

    def __init__(self) -> None:
        self._told: dict[str, dict[str, None]] = {}
        self._more: dict[str, int] = {}
        self._there: dict[str, int] = {}
        self._read: dict[str, int] = {}

    def seen(self, source: str) -> None:
        """One more message, line or picture of this source has come, whatever becomes of it."""
        self._there[source] = self._there.get(source, 0) + 1

    def read(self, source: str) -> None:
        """One of them is used."""
        self._read[source] = self._read.get(source, 0) + 1

    @property
    def counts(self) -> tuple[Count, ...]:
        """Of every source of which something has come."""
        return tuple(Count(source, self._read.get(source, 0), there) for source, there in self._there.items())

    def add(self, kind: str, where: str, what: str) -> None:
        """kind: of which the first few are told; where: the message, line or file; what: is wrong with it."""
        sentence = f"{where}: {plain(what)}"
        told = self._told.setdefault(kind, {})
        if len(told) < TOLD:
            told[sentence] = None
        elif sentence not in told:
            self._more[kind] = self._more.get(kind, 0) + 1

    def begin(self) -> None:
        """The recording is read from its beginning again: what was only counted is counted anew."""
        self._more.clear()
        self._there.clear()
        self._read.clear()

    def __bool__(self) -> bool:
        return bool(self._told)

    @property
    def sentences(self) -> tuple[str, ...]:
        lines = [sentence for told in self._told.values() for sentence in told]
        return (*lines, *(f"and {count} more: {kind}" for kind, count in self._more.items()))
