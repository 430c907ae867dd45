"""Which time of a message counts: that in its header, or that at which it was written down."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

_WINDOW_NS = 10 * 10**9
_APART_S = 0.5  # clocks that tell of one moment differ by less: it is more than a message is on its way
_MANY = 0.25  # of the windows in which they were compared
_REAL = 0.5  # a bag that was written anew in a moment has no times of its own


@dataclass
class Stamps:
    """What is known of a topic's times after all of its messages have gone by."""

    first_ns: int = 0
    last_ns: int = 0
    missing: bool = False  # a header without a time
    back: bool = False  # times that go back
    wrote_ns: list[int] = field(default_factory=list[int])  # when the first and the last one was written down
    late_ns: dict[int, int] = field(default_factory=dict[int, int])  # the least from header to record, by windows

    def note(self, stamp_ns: int, time_ns: int) -> None:
        """stamp_ns: in the header; time_ns: when it was written down."""
        self.missing |= stamp_ns <= 0
        self.back |= stamp_ns < self.last_ns
        self.first_ns, self.last_ns = self.first_ns or stamp_ns, stamp_ns
        self.wrote_ns = [self.wrote_ns[0] if self.wrote_ns else time_ns, time_ns]
        window, late = time_ns // _WINDOW_NS, time_ns - stamp_ns
        self.late_ns[window] = min(late, self.late_ns.get(window, late))


@dataclass(frozen=True, slots=True)
class Times:
    """Which times count."""

    stamped: bool  # those in the headers
    why: str = ""  # not, in words
    problem: bool = False  # whether that is a fault of the recording


def times_of(topics: Mapping[str, Stamps | None]) -> Times:
    """[ours] topics: those that are used; None: of a type without a time.

    Headers tell better when something was than the record does. But each may have been filled in by another clock, which
    shows where messages that were written down together have headers far apart.
    """
    stamps = {name: stamp for name, stamp in topics.items() if stamp is not None and stamp.wrote_ns}
    for name, stamp in topics.items():
        if stamp is None:
            return Times(False, f"{name} has no time of its own")
    for name, stamp in stamps.items():
        if stamp.missing:
            return Times(False, f"headers of {name} are without a time")
        if stamp.back:
            return Times(False, f"times in the headers of {name} go back")
    if (apart := _apart(stamps)) is None or not _real(list(stamps.values())):
        return Times(True)
    one, other, seconds = apart
    return Times(False, f"the clocks of {one} and {other} are {seconds:.6g} s apart in their headers", True)


def _apart(stamps: Mapping[str, Stamps]) -> tuple[str, str, float] | None:
    """Two topics whose clocks differ, and by how much (s), in the middle of the windows in which they do."""
    found, compared = list[tuple[float, str, str]](), 0
    for window in sorted({window for stamp in stamps.values() for window in stamp.late_ns}):
        late = sorted((stamp.late_ns[window], name) for name, stamp in stamps.items() if window in stamp.late_ns)
        if len(late) > 1:
            compared += 1
            (least, one), (most, other) = late[0], late[-1]
            if most - least > _APART_S * 1e9:
                found.append(((most - least) / 1e9, min(one, other), max(one, other)))
    if not found or len(found) <= _MANY * compared:
        return None
    seconds, one, other = sorted(found)[len(found) // 2]
    return one, other, seconds


def _real(stamps: Sequence[Stamps]) -> bool:
    """Whether messages were written down when they came."""
    wrote = max(s.wrote_ns[1] for s in stamps) - min(s.wrote_ns[0] for s in stamps)
    return wrote >= _REAL * max(s.last_ns - s.first_ns for s in stamps)
