"""Figures beside their bars, made from the reports of runs."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

Report = dict[str, Any]
SOON_S = 120.0  # of a kidnap


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure, as a number and in words, beside its bar. Without a bar it is only told."""

    what: str
    value: float | None
    words: str
    bar: str = ""
    holds: bool | None = None


def of_run(run: Report) -> str:
    """One run in a line."""
    name = f"{run['name']}, seed {run['seed']}{', ' + run['variant'] if run['variant'] else ''}"
    if run["error"]:
        return f"{name}: failed: {run['error']}"
    words = [f"map {run['error_m']['map']} m"]
    if "deliveries" in run:
        words.append(f"{run['succeeded']} of {run['deliveries']} deliveries")
    for key, good, what in (("goals", "reached", "goals"), ("kidnaps", "recovered", "kidnaps recovered")):
        some = [one[good] for one in run.get(key, ()) if good in one]
        if some:
            words.append(f"{sum(some)} of {len(some)} {what}")
    return f"{name}: {', '.join(words)}; {run['real_time_factor']:g} x real time"


def at_most(what: str, value: float, bar: float, unit: str = "m") -> Figure:
    return Figure(what, _json(value), f"{value:.2f} {unit}", f"<= {bar:g} {unit}", value <= bar)


def at_least(what: str, value: float, bar: float, unit: str = "") -> Figure:
    return Figure(what, _json(value), f"{value:.2f} {unit}".strip(), f">= {bar:g} {unit}".strip(), value >= bar)


def share(what: str, good: int, of: int, least: float, words: str) -> Figure:
    """least: the share that has to be good; words: the bar as it is written."""
    return Figure(what, good, f"{good} of {of}", words, good >= math.ceil(least * of - 1e-9) and of > 0)


def errors(runs: list[Report]) -> list[float]:
    """The map error of each run; infinite for one that failed."""
    found = [None if run["error"] else run["error_m"]["map"] for run in runs]
    return [math.inf if error is None else error for error in found]


def map_errors(runs: list[Report], median: float | None, worst: float) -> Iterator[Figure]:
    metres = errors(runs)
    if median is not None:
        yield at_most("map error, median", statistics.median(metres), median)
    yield at_most("map error, worst", max(metres), worst)


def goals(runs: list[Report], least: float, words: str, median_miss: float | None = None) -> Iterator[Figure]:
    visits = [goal for run in runs if not run["error"] for goal in run["goals"]]
    yield share("goals", sum(goal["reached"] for goal in visits), len(visits), least, words)
    if median_miss is not None:
        misses = [math.inf if goal["miss_m"] is None else goal["miss_m"] for goal in visits]
        yield at_most("missed by, median", statistics.median(misses) if misses else math.inf, median_miss)


def loops(runs: list[Report]) -> Figure:
    """Whether every loop was closed in every run."""
    closed = sum(run["loops"]["closed"] for run in runs if not run["error"])
    of = sum(run["loops"]["of"] for run in runs if not run["error"])
    return share("loops closed", closed, of, 1.0, "all")


def kidnaps(runs: list[Report], beside: list[Report]) -> Iterator[Figure]:
    """beside: the same worlds and seeds without kidnaps."""
    all_ = [kidnap for run in runs if not run["error"] for kidnap in run["kidnaps"]]
    yield share("kidnaps recovered", sum(k["recovered"] for k in all_), len(all_), 0.97, "97 of 100")
    met = [k for k in all_ if k["met_s"] is not None and k["met_s"] <= SOON_S]
    soon = sum(k["recovered"] and k["after_s"] <= SOON_S for k in met)
    yield share("in two minutes, of those that met known ground", soon, len(met), 0.9, "90 of 100")
    after = [k["after_s"] for k in all_ if k["recovered"]]
    if after:
        words = f"{statistics.median(after):.0f} s in the median, {max(after):.0f} s at worst"
        yield Figure("recovered after", statistics.median(after), words)
    without = {(run["name"], run["seed"]): error for run, error in zip(beside, errors(beside), strict=True)}
    times: list[float] = []
    for run, error in zip(runs, errors(runs), strict=True):
        plain = without.get((run["name"], run["seed"]), math.inf)
        times.append(error / plain if 0 < plain < math.inf else math.inf)
    if times:
        yield Figure(
            "map error / without, median", _json(statistics.median(times)), f"{statistics.median(times):.2f} times"
        )
        yield at_most("map error / without, worst", max(times), 1.2, "times")


def revisits(runs: list[Report], beside: list[Report]) -> Figure:
    """The share of ticks on an old experience, as a part of what it is with everything off."""
    on, off = (statistics.fmean(_shares(some)) for some in (runs, beside))
    part = on / off if off > 0 else math.inf
    words = f"{part:.2f} ({on:.3f} / {off:.3f})"
    return Figure("ticks on an old experience, on / off", _json(part), words, ">= 0.8", part >= 0.8)


def _shares(runs: list[Report]) -> list[float]:
    return [run["revisit_share"] for run in runs if not run["error"]] or [0.0]


def deliveries(runs: list[Report]) -> Iterator[Figure]:
    for run in runs:
        if run["error"]:
            continue
        failed, of = len(run["failures"]), run["deliveries"]
        yield Figure(f"seed {run['seed']}: failures", failed, f"{failed} of {of}", "<= 1 of 1143", failed <= 1)
        yield from hours(run["growth"])


def hours(rows: list[dict[str, Any]]) -> Iterator[Figure]:
    """The last full hour against the second."""
    full = [row for row in rows if row["at_s"] % 3600 == 0]
    if len(full) < 3:
        yield Figure("last hour against the second", None, f"not judged: {len(full)} full hours, at least 3 are needed")
        return
    for key in ("views", "experiences", "links", "view_links", "rss_mb"):
        if full[1][key]:
            grown = full[-1][key] / full[1][key]
            yield at_most(f"{key}, last hour / second", grown, 1.10, "times")
    speed = full[-1]["real_time_factor"] / full[1]["real_time_factor"]
    yield at_least("speed, last hour / second", speed, 0.95, "times")  # a twentieth is the machine's noise


def speeds(runs: list[Report]) -> Iterator[Figure]:
    """How fast the first 20 minutes and the last were, each as long as four samples."""
    for run in runs:
        if not run["error"] and len(run["real_time_factors"]) >= 8:
            first, last = (statistics.harmonic_mean(run["real_time_factors"][at]) for at in (slice(4), slice(-4, None)))
            yield at_least(f"seed {run['seed']}: speed, first 20 min", first, 500, "x real time")
            yield at_least(f"seed {run['seed']}: speed, last 20 min", last, 400, "x real time")
            grown = run["growth"][-1]
            words = ", ".join(
                f"{grown[key]:,} {key.replace('_', ' ')}" for key in ("views", "experiences", "links", "view_links")
            )
            yield Figure("at the end", None, words)


def _json(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None
