"""The time of a recording made one that never goes back, with a word wherever it had to be mended."""

from __future__ import annotations

from app.recordings.formats.problems import Problems

LATE_S = 1.0  # a message may come so much out of order
BREAK_S = 60.0  # a longer silence is taken as a break, or as a clock that was set
GOES_ON_S = 0.1  # so much passes in a break


class Clock:
    """[ours] Clocks of robots are set while they drive, and recordings are paused: time goes on after a break.

    test_recording_parts.py::test_a_clock_that_was_set_goes_on.
    """

    def __init__(self, problems: Problems) -> None:
        self._problems = problems
        self._shift = 0
        self._now: int | None = None

    def at(self, time_ns: int, where: str) -> int:
        """The mended time (ns)."""
        now = self._now
        if now is None:
            self._shift = -time_ns
            self._now = 0
            return 0
        time = time_ns + self._shift
        off = (time - now) / 1e9
        if off > BREAK_S or off < -LATE_S:
            way = f"{off:.6g} s on" if off > 0 else f"{-off:.6g} s back"
            self._problems.add(
                "jumps of the clock", where, f"the time jumps {way}; it is taken as a break of {GOES_ON_S:g} s"
            )
            time = now + round(GOES_ON_S * 1e9)
            self._shift = time - time_ns
        self._now = max(now, time)
        return self._now
