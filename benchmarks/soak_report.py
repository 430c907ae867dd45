"""The rows of a soak, and the verdict on them."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

MOST_NEW_THREADS = 4  # pools that fill up later than the first quarter
MOST_STILL_S = 20.0
MOST_NEW_FILES = 8  # a page that is being loaded
HEAD = (
    f"{'min':>6} {'sim h':>6} {'x':>5} {'tick ms':>8} {'worst':>6} {'cpu ms':>6} {'MB':>6} {'page MB':>7} {'thr':>4} "
    f"{'files':>5} {'views':>6} {'exp.':>6} {'links':>6} {'map m':>6} {'odo m':>6}  doing"
)


@dataclass(frozen=True, slots=True)
class Row:
    minute: float  # since the first row, wall time
    time_s: float  # simulated
    tick: int
    factor: float  # simulated seconds a second since the row before
    tick_ms: float | None  # as the page's Tick tab says, mean of the last hundred; None: it could not be read
    worst_ms: float | None
    cpu_ms: float  # the whole server's processor time for a tick, since the row before
    memory_mb: float
    browser_mb: float
    threads: int
    files: int
    views: int
    experiences: int
    links: int
    map_error_m: float | None
    odometry_error_m: float | None
    doing: str
    fault: str | None

    def __str__(self) -> str:
        return (
            f"{self.minute:6.1f} {self.time_s / 3600:6.2f} {self.factor:5.1f} {_ms(self.tick_ms):>8} "
            f"{_ms(self.worst_ms):>6} {self.cpu_ms:6.2f} {self.memory_mb:6.1f} {self.browser_mb:7.0f} {self.threads:4} "
            f"{self.files:5} {self.views:6} {self.experiences:6} {self.links:6} {_ms(self.map_error_m):>6} "
            f"{_ms(self.odometry_error_m):>6}  {self.doing}"
        )


@dataclass(frozen=True, slots=True)
class Findings:
    lines: tuple[str, ...]
    wrong: tuple[str, ...]  # empty: it soaked well


def judge(rows: Sequence[Row], troubles: Sequence[str]) -> Findings:
    """The verdict. Memory is reported beside the growth of the map but not judged, since a growing map needs memory."""
    if len(rows) < 2:
        return Findings((), ("too few rows to say anything", *troubles))
    first, half, last = rows[0], rows[len(rows) // 2 :], rows[-1]
    quarter = max(1, len(rows) // 4)
    early, late = rows[:quarter], rows[-quarter:]
    lines = (
        f"{last.minute:.0f} min, {(last.time_s - first.time_s) / 3600:.1f} h simulated, "
        f"{last.tick - first.tick} ticks; x{statistics.median(row.factor for row in rows):.1f} in the median, "
        f"x{min(row.factor for row in rows):.1f} at least",
        "memory " + ", ".join(f"{rows[at].memory_mb:.0f} MB {where}" for at, where in _milestones(len(rows))),
        f"second half: {_hourly(half, 'memory_mb'):+.1f} MB an hour, with {_hourly(half, 'experiences'):+.0f} experiences, "
        f"{_hourly(half, 'views'):+.0f} views and {_hourly(half, 'links'):+.0f} links an hour",
        f"the browser's {first.browser_mb:.0f} MB became {last.browser_mb:.0f} MB, "
        f"{_hourly(half, 'browser_mb'):+.1f} MB an hour in the second half",
        f"threads {first.threads} at first, {last.threads} at last; files {first.files} and {last.files}",
        f"a tick takes {_ms(_middle(early, 'tick_ms'))} ms in the first quarter, {_ms(_middle(late, 'tick_ms'))} ms in "
        f"the last, {_ms(max((row.worst_ms for row in rows if row.worst_ms is not None), default=None))} ms at worst; "
        f"server {_middle(early, 'cpu_ms'):.2f} and {_middle(late, 'cpu_ms'):.2f} ms of processor",
    )
    return Findings(lines, (*_faults(rows, early, late), *troubles))


def _faults(rows: Sequence[Row], early: Sequence[Row], late: Sequence[Row]) -> list[str]:
    wrong = [f"stopped at minute {row.minute:.1f}: {row.fault}" for row in rows if row.fault is not None][:1]
    still = sum(row.minute - before.minute for before, row in pairwise(rows) if row.tick == before.tick)
    if 60 * still > MOST_STILL_S:
        wrong.append(f"the engine stood still for {still:.1f} min")
    for what, most in (("threads", MOST_NEW_THREADS), ("files", MOST_NEW_FILES)):
        new = _middle(late, what) - _middle(early, what)
        if new > most:
            wrong.append(f"{new:.0f} {what} more in the last quarter than in the first, at most {most} are well")
    if all(row.tick_ms is None for row in rows):
        wrong.append("the page never told a tick's time")
    return wrong


def _milestones(count: int) -> list[tuple[int, str]]:
    last = count - 1
    return [(0, "at first"), (last // 4, "after a quarter"), (last // 2, "at half time"), (last, "at last")]


def _middle(rows: Sequence[Row], field: str) -> float:
    known = [value for row in rows if (value := getattr(row, field)) is not None]
    return statistics.median(known) if known else float("nan")


def _hourly(rows: Sequence[Row], field: str) -> float:
    """The growth per hour: the slope of the straight line through the rows."""
    if len(rows) < 2:
        return float("nan")
    hours = np.array([row.minute / 60 for row in rows])
    return float(np.polyfit(hours, [getattr(row, field) for row in rows], 1)[0])


def _ms(value: float | None) -> str:
    return "-" if value is None or math.isnan(value) else f"{value:.2f}"
