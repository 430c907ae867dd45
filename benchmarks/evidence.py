"""What an observation tells a robot that was carried away, and how soon it finds itself: what `extensions/evidence.py` rests on.

    python -m benchmarks.evidence fit                  # the curves, and how well those in use are calibrated
    python -m benchmarks.evidence prior                # how likely a place is that a view suggests, before it is weighed
    python -m benchmarks.evidence kidnaps office living --seeds 50 --minutes 12
    python -m benchmarks.evidence picture office --first 500006 --minutes 12 --out docs/pictures/evidence.svg

fit: robots drive over ground that they know. How alike are the views near where they truly are, and those near a wrong
place that looked right one or two units of way before? The logarithm of the ratio of both shares is what an observation
says. Calibrated: given a wrong place, the mean of e to that power is at most 1. Each world is asked with the curves that the
other worlds give, too. The same for echoes: how far apart are they from those of the nearest experience, where they agreed
a unit of way before?

prior: robots are carried as below. Of the places that views suggest while no hypothesis is right, some are. The prior is the
log odds that predict how many, together with what each view says for its place.

kidnaps: each robot explores, is carried 3 m or more and turned, and has two minutes; with --turn it is turned by 90 degrees
on the spot instead. One judge, the evaluation: where the active experience was made, and the robot beside it, within 1 m
and 0.6 rad for half a second.
"""

# matplotlib tells no types.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.config import Config
from app.session import Session
from ratslam_core.extensions.evidence import (
    AGAINST,
    APART_M,
    APART_NATS,
    CEILING,
    FOR,
    LIKE,
    LIKENESS,
    NATS,
    ODDS,
    PRIOR,
    RINGS,
    UNITS,
)  # fmt: skip
from ratslam_core.local_view.front_ends import FRONT_ENDS
from ratslam_core.types import Pose2, wrap_angles
from sim2d import load_world, world_names

WORLDS = ("office", "living", "campus", "corridors", "two-goals", "twins")
SEEDS = (910001, 910002)
OFF: dict[str, float | int | bool | str] = {"goal_memory.enabled": False, "occupancy.enabled": False}
EDGES = np.array([0.0, *(LIKENESS[:-1] + LIKENESS[1:]) / 2, 9.0])
AGREE_M = 0.16  # echoes no farther apart agree
BESIDE_M = 1.0  # the nearest experience
WRONG_M, WRONG_RAD = 2.0, 1.0  # a place is wrong if it is so far from the true one, or turned so far
SECONDS, EVERY_UNIT = 300, 0.25
NEAR_RIGHT_M, NEAR_RIGHT_RAD, STAYS = 1.0, 0.6, 6  # ticks
SOON, LATER = 1200, 600  # ticks in which it is to be found; and after which a wrong merge is asked for once more

Rows = NDArray[np.float64]
Job = tuple[str, int, float, str]  # world, seed, minutes of exploring, front end


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("what", choices=("fit", "prior", "kidnaps", "picture"))
    parser.add_argument("worlds", nargs="*", metavar="WORLD", help="default: " + ", ".join(WORLDS))
    parser.add_argument("--seeds", type=int, default=0, help="how many in each world (default: fit 2, others 10)")
    parser.add_argument("--first", type=int, default=0, help="the first of them (default: fit 910001, others 520000)")
    parser.add_argument("--out", type=Path, default=Path("evidence.svg"), help="of the picture")
    parser.add_argument("--minutes", type=float, default=8.0, help="of exploring before (default 8)")
    parser.add_argument(
        "--turn", action="store_true", help="kidnaps: turned by 90 degrees on the spot, not carried away"
    )
    parser.add_argument("--front-end", default="image and sonars", choices=list(FRONT_ENDS), help="of the local view")
    args = parser.parse_args()
    if unknown := set(args.worlds) - {name for name, _ in world_names()}:
        parser.error(f"no world is called {', '.join(sorted(unknown))}")
    first = args.first or (SEEDS[0] if args.what == "fit" else 520_000)
    seeds = range(first, first + (args.seeds or (len(SEEDS) if args.what == "fit" else 10)))
    jobs = [(world, seed, args.minutes, args.front_end) for world in args.worlds or WORLDS for seed in seeds]
    if args.what == "picture":
        _draw(_explored(jobs[0]), args.out)
        return 0
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        if args.what == "fit":
            told = list(pool.map(_likenesses, jobs))
            _print_fit([(job[0], rows) for job, rows in zip(jobs, told, strict=True)])
        elif args.what == "prior":
            _print_prior(list(zip(jobs, pool.map(_suggested, jobs), strict=True)))
        else:
            _print_kidnaps(list(zip(jobs, pool.map(_kidnapped, jobs, [args.turn] * len(jobs)), strict=True)))
    return 0


# ---------------------------------------------------------------- what an observation says


@dataclass(slots=True)
class _Wrong:
    """A place that looked right although it is wrong, and moves as the robot does."""

    x: float
    y: float
    heading: float
    agrees: bool  # the echoes with those of the place
    units: float = 0.0

    def move(self, way: float, turn: float) -> None:
        middle = self.heading + turn / 2
        self.x, self.y = self.x + way * math.cos(middle), self.y + way * math.sin(middle)
        self.heading, self.units = self.heading + turn, self.units + abs(way) + abs(turn)


def _likenesses(job: Job) -> Rows:
    """Rows: 1 for the true place, 0 for a wrong one; then the likeness of the nearest views of each ring, NaN for none; and
    how far apart echoes are, NaN where they did not agree a unit of way before.
    """
    # Along walls, over the same ground again and again: else it would seek new ground, where there is nothing to compare with.
    session = _explored(job, **{"pilot.seek": False})
    map_, view = session.brain.experience_map, session.brain.local_view
    births, kept = session.evaluation.births(len(map_)), map_.views.copy()
    rows: list[list[float]] = []
    wrong: list[_Wrong] = []
    units, agreed = 0.0, False
    for _ in range(SECONDS * 10):
        session.tick()
        way, turn = session.odometry.speed * session.odometry.dt, session.odometry.yaw_rate * session.odometry.dt
        for place in wrong:
            place.move(way, turn)
        units += abs(way) + abs(turn)
        if units < EVERY_UNIT or view.recognition.view < 0:
            continue
        units = 0.0
        known = np.where(map_.views[: len(kept)] == kept, kept, -1)
        looking = _Looking(session, births, known)
        truth = session.simulator.truth
        here = truth.x, truth.y, truth.heading_rad
        apart_m = looking.apart_m(*here)
        rows.append([1.0, *looking.rings(*here), apart_m if agreed else math.nan])
        agreed = apart_m <= AGREE_M
        for p in wrong:
            if 1.0 <= p.units < 1.0 + EVERY_UNIT:
                there = p.x, p.y, p.heading
                rows.append([0.0, *looking.rings(*there), looking.apart_m(*there) if p.agrees else math.nan])
        wrong = [place for place in wrong if place.units < 1.0 + EVERY_UNIT][-40:] + looking.wrong(wrong)
    return np.array(rows)


class _True:
    """The experiences where they truly were made."""

    def __init__(self, births: Rows) -> None:
        self.poses, self.submap_of = births[:, :3].copy(), np.zeros(len(births), np.int32)

    def __len__(self) -> int:
        return len(self.poses)


class _Looking:
    """One observation, compared with the stored views as if their map were true."""

    def __init__(self, session: Session, births: Rows, known: NDArray[np.int64]) -> None:
        self._truth, self._view = session.simulator.truth, session.brain.local_view
        self._births, self._known, self._scans = births, known, session.brain.scans
        self._own = np.flatnonzero(known >= 0)
        self._apart, self._shifts = self._view.apart_at(known[self._own], np.zeros(len(self._own), np.int64), 2)
        self._usual = max(float(np.partition(self._apart, len(self._apart) // 10)[len(self._apart) // 10]), 1e-9)

    def rings(self, x: float, y: float, heading: float) -> list[float]:
        turn = wrap_angles(heading - self._births[:, 2])
        away = np.hypot(self._births[:, 0] - x, self._births[:, 1] - y)
        found: list[float] = []
        for near_m, near_rad in RINGS:
            which = np.flatnonzero((self._known >= 0) & (away <= near_m) & (np.abs(turn) <= near_rad))
            if any(not math.isnan(likeness) for likeness in found) or not len(which):
                found.append(math.nan)  # a nearer ring counts, or there is nothing
                continue
            columns = turn[which] / self._view.column_rad if self._view.column_rad > 0 else 0.0 * turn[which]
            shifts = np.rint(columns).astype(np.int64)
            found.append(float(self._view.apart_at(self._known[which], shifts, 2)[0].min()) / self._usual)
        return found

    def apart_m(self, x: float, y: float, heading: float) -> float:
        """How far apart the echoes of now are from those of the nearest experience; NaN if none is near or too few are heard."""
        away = np.hypot(self._births[:, 0] - x, self._births[:, 1] - y)
        nearest = int(np.argmin(away))
        if self._scans is None or away[nearest] > BESIDE_M:
            return math.nan
        observation = Pose2(*self._births[nearest, :3].tolist()).inverse().compose(Pose2(x, y, heading))
        found = self._scans.match(_True(self._births), nearest, observation)
        return math.nan if found is None else found.apart_m

    def wrong(self, others: Sequence[_Wrong]) -> list[_Wrong]:
        """At most two new places that look right and are wrong, apart from these."""
        found: list[_Wrong] = []
        for i in np.argsort(self._apart, kind="stable")[:40]:
            x, y, heading = self._births[self._own[i], :3].tolist()
            heading += float(self._shifts[i]) * self._view.column_rad
            off_m = math.hypot(x - self._truth.x, y - self._truth.y)
            off = off_m > WRONG_M or abs(math.remainder(heading - self._truth.heading_rad, math.tau)) > WRONG_RAD
            new = all(math.hypot(x - p.x, y - p.y) > 0.7 for p in (*others, *found))
            if off and new and self._apart[i] <= LIKE * self._usual and len(found) < 2:
                found.append(_Wrong(x, y, heading, self.apart_m(x, y, heading) <= AGREE_M))
        return found


def _print_fit(told: Sequence[tuple[str, Rows]]) -> None:
    everything = np.concatenate([rows for _, rows in told])
    print("likeness           " + " ".join(f"{r:5.2f}" for r in LIKENESS))
    for ring, (near_m, near_rad) in enumerate(RINGS):
        print(f"{near_m:.1f} m, {near_rad:.2f} rad:  " + " ".join(f"{said:5.1f}" for said in _curve(everything, ring)))
    _print_echoes(told)
    print(
        "\nnats at the true place, at wrong ones, mean of e^nats there (calibrated: <= 1); again by the others' curves"
    )
    for world in dict.fromkeys(name for name, _ in told):
        own = np.concatenate([rows for name, rows in told if name == world])
        others = [rows for name, rows in told if name != world]
        curves = [_curve(np.concatenate(others), ring) for ring in range(len(RINGS) if others else 0)]
        print(f"{world:10s} {_calibration(own, NATS)}   {_calibration(own, np.array(curves)) if others else '-'}")


def _print_echoes(told: Sequence[tuple[str, Rows]]) -> None:
    """The curve of the mean of the worlds, and what that in use says in each."""
    edges = np.array([0.0, *(APART_M[:-1] + APART_M[1:]) / 2, 9.0])
    names, echoes = list(dict.fromkeys(name for name, _ in told)), 1 + len(RINGS)
    own = {each: np.concatenate([rows for name, rows in told if name == each]) for each in names}
    curve = np.mean([_curve(rows, echoes - 1, edges) for rows in own.values()], axis=0)
    print("\nechoes apart, m    " + " ".join(f"{apart:5.2f}" for apart in APART_M))
    print("nats               " + " ".join(f"{said:5.1f}" for said in curve))
    for name, rows in own.items():
        heard = rows[~np.isnan(rows[:, echoes])]
        nats: Rows = np.interp(heard[:, echoes], APART_M, APART_NATS)
        true = heard[:, 0] == 1.0
        if 0 < np.count_nonzero(true) < len(true):
            print(f"{name:10s} {nats[true].mean():5.2f} {nats[~true].mean():5.2f} {np.exp(nats[~true]).mean():5.2f}")


def _curve(rows: Rows, ring: int, edges: Rows = EDGES) -> Rows:
    shares: list[Rows] = []
    for kind in (1.0, 0.0):
        likeness = rows[rows[:, 0] == kind][:, 1 + ring]
        counts = np.histogram(likeness[~np.isnan(likeness)], edges)[0] + 0.5
        shares.append(counts / counts.sum())
    return np.log(shares[0] / shares[1])


def _calibration(rows: Rows, curves: Rows) -> str:
    """What the observations say for the true places, and for the wrong ones, by these curves, one for each ring."""
    told = ~np.isnan(rows[:, 1 : 1 + len(curves)])
    said = np.zeros(told.shape)
    for ring in range(len(curves)):
        said[:, ring] = np.interp(rows[:, 1 + ring], LIKENESS, curves[ring])
    nats: Rows = np.clip(said, AGAINST, FOR)[told]
    true: NDArray[np.bool_] = np.repeat(rows[:, :1] == 1.0, len(curves), axis=1)[told]
    return f"{nats[true].mean():5.2f} {nats[~true].mean():5.2f} {np.exp(nats[~true]).mean():5.2f}"


# ---------------------------------------------------------------- how likely a suggested place is


def _suggested(job: Job) -> Rows:
    """Rows of the places that views suggest while no hypothesis is right: 1 for the right place, and what the view says."""
    session = _explored(job)
    map_, frame = session.brain.experience_map, session.evaluation.map_in_office(session.brain.experience_map)
    _carry(session)
    rows: list[tuple[float, float]] = []
    before = np.zeros(0)  # log odds; those of a place that was not weighed stay as they are
    for _ in range(SOON):
        session.tick()
        hypotheses = map_.evidence.hypotheses
        right = _right(hypotheses, frame.inverse().compose(Pose2(*astuple(session.simulator.truth)[:3])))
        new = (hypotheses[:, UNITS] == 1.0) & np.isfinite(hypotheses[:, CEILING])
        new, before = new & ~np.isin(hypotheses[:, ODDS], before), hypotheses[:, ODDS].copy()
        if not map_.carried or right[~new].any():
            break
        rows += zip(right[new].astype(float), hypotheses[new, ODDS] - PRIOR, strict=True)
    return np.array(rows).reshape(-1, 2)


def _right(rows: Rows, truth: Pose2) -> NDArray[np.bool_]:
    near = np.hypot(rows[:, 0] - truth.x, rows[:, 1] - truth.y) <= NEAR_RIGHT_M
    return near & (np.abs(wrap_angles(rows[:, 2] - truth.heading_rad)) <= NEAR_RIGHT_RAD)


def _print_prior(told: Sequence[tuple[Job, Rows]]) -> None:
    print("world        places suggested   right   prior that predicts so many   without this world")
    for world in dict.fromkeys(job[0] for job, _ in told):
        own, others = (_those([r for job, r in told if (job[0] == world) == its]) for its in (True, False))
        print(f"{world:12s} {len(own):16d} {int(own[:, 0].sum()):7d} {_prior(own):>29s} {_prior(others):>20s}")
    everything = _those([rows for _, rows in told])
    print(f"all          {len(everything):16d} {int(everything[:, 0].sum()):7d} {_prior(everything):>29s}")


def _those(rows: Sequence[Rows]) -> Rows:
    return np.concatenate([np.zeros((0, 2)), *rows])


def _prior(rows: Rows) -> str:
    """The log odds for which the expected number of right places is the one that was found, by halving; "-" if none was."""
    if not rows[:, 0].any():
        return "-"
    low, high = -20.0, 20.0
    for _ in range(60):
        middle = (low + high) / 2
        expected = float(np.sum(1 / (1 + np.exp(-(middle + rows[:, 1])))))
        low, high = (middle, high) if expected < rows[:, 0].sum() else (low, middle)
    return f"{low:.2f}"


# ---------------------------------------------------------------- kidnaps


@dataclass(frozen=True, slots=True)
class Found:
    """What became of one kidnap; seconds since it, inf for never."""

    right_s: float  # it believes the right place, and goes on to for half a second
    wrong_s: float  # how long it believed a wrong known place before, at the longest
    merged_s: float
    merged_off_m: float  # how far from the truth that was ...
    later_off_m: float  # ... and what it believes a minute later


def _kidnapped(job: Job, turn: bool) -> Found:
    session = _explored(job)
    map_ = session.brain.experience_map
    known, merged = len(map_), map_.submaps.merged + map_.corrected
    (_turn if turn else _carry)(session)
    right_s = merged_s = merged_off_m = later_off_m = math.inf
    right = wrong = longest = 0
    for tick in range(1, SOON + LATER + 1):
        session.tick()
        off_m, off_rad = session.evaluation.belief_off(session.simulator.truth, map_)
        if merged_s == math.inf and tick <= SOON and map_.submaps.merged + map_.corrected > merged:
            merged_s, merged_off_m = tick / 10, off_m
        believes = map_.active < known
        is_right = believes and off_m <= NEAR_RIGHT_M and off_rad <= NEAR_RIGHT_RAD
        right, wrong = (right + 1, 0) if is_right else (0, wrong + 1 if believes else 0)
        if math.isclose(tick, 10 * merged_s + LATER):
            later_off_m = off_m
        if right_s == math.inf and tick <= SOON:
            longest = max(longest, wrong)
            right_s = (tick - STAYS + 1) / 10 if right == STAYS else right_s
    return Found(right_s, longest / 10, merged_s, merged_off_m, later_off_m)


def _carry(session: Session) -> None:
    truth = session.simulator.truth
    while True:
        x, y, heading = session.simulator.random_free_pose()
        if math.hypot(x - truth.x, y - truth.y) >= 3.0:
            session.kidnap(x, y, heading)
            return


def _turn(session: Session) -> None:
    truth, way = session.simulator.truth, (math.pi / 2, -math.pi / 2)[session.seed % 2]
    session.kidnap(truth.x, truth.y, truth.heading_rad + way)


def _draw(session: Session, path: Path) -> None:
    """The log odds of each hypothesis from the kidnap on, until the maps are merged; that which is right is drawn bold."""
    from matplotlib.figure import Figure

    map_, frame = session.brain.experience_map, session.evaluation.map_in_office(session.brain.experience_map)
    _carry(session)
    times, odds, right = list[float](), list[float](), list[bool]()
    began, merge = session.time_s, map_.evidence.params.merge
    while session.time_s < began + 60 and (session.time_s == began or map_.carried):
        session.tick()
        truth = frame.inverse().compose(Pose2(*astuple(session.simulator.truth)[:3]))
        rows = map_.evidence.hypotheses
        times += [session.time_s - began] * len(rows)
        odds += rows[:, ODDS].tolist()
        right += _right(rows, truth).tolist()
    figure = Figure((7.2, 3.0), layout="constrained")
    axes = figure.add_subplot()
    for kind, colour, size, label in ((False, "#999999", 5, "wrong places"), (True, "#0E7FB8", 14, "the right place")):
        some = [(t, o) for t, o, is_right in zip(times, odds, right, strict=True) if is_right == kind]
        axes.scatter(*zip(*some, strict=True), s=size, color=colour, label=label, linewidths=0)
    axes.axhline(0.0, color="#555555", lw=0.8)
    axes.axhline(merge, color="#D98300", lw=0.8, ls="--", label="1000 : 1")
    axes.set(xlabel="seconds since the robot was carried", ylabel="log odds against a new place")
    axes.legend(frameon=False, loc="upper left", fontsize=8)
    figure.savefig(path, metadata={"Date": None})
    print(path)


def _print_kidnaps(found: Sequence[tuple[Job, Found]]) -> None:
    print(
        "world       n   right: median  90 %   never   wrong first > 0.5 s  > 3 s   merged: median  wrongly, and still"
    )
    for world in dict.fromkeys(job[0] for job, _ in found):
        some = [each for job, each in found if job[0] == world]
        for_half_a_second, for_three = (sum(each.wrong_s > s for each in some) for s in (0.5, 3.0))
        right, merged = (sorted(values) for values in zip(*((f.right_s, f.merged_s) for f in some), strict=True))
        print(
            f"{world:10s} {len(some):3d} {right[len(some) // 2]:10.1f} s {right[int(0.9 * (len(some) - 1))]:5.1f} s"
            f" {sum(math.isinf(s) for s in right):5d} {for_half_a_second:15d} {for_three:10d}"
            f" {merged[len(some) // 2]:14.1f} s {sum(1.0 < f.merged_off_m < math.inf for f in some):6d}"
            f" {sum(1.0 < min(f.merged_off_m, f.later_off_m) < math.inf for f in some):10d}",
            flush=True,
        )


def _explored(job: Job, **values: float | int | bool | str) -> Session:
    world, seed, minutes, front_end = job
    values = {**OFF, "local_view.front_end": front_end, **values}
    session = Session(load_world(world), seed, Config().with_values(values))
    for _ in range(round(minutes * 600)):
        session.tick()
    return session


if __name__ == "__main__":
    raise SystemExit(main())
