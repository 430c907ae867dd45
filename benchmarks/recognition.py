"""What a look can know: how many revisits each front end recognises, and how often it is right.

    python -m benchmarks.recognition [--minutes 20] [--seeds 401 402] [--rows ROW ...] [WORLD ...]

A world is a name or a file, as for `ratslam run --world`. In each, the robot drives once for every seed, in the closed
loop. From every third tick image and echoes are kept. Each frame is compared with all that are more than 30 s older, and
takes the nearest for the same place if it is near enough. That is right if it was taken within 0.8 m and 0.6 rad. A
revisit is a frame that had an older one within 0.3 m and 15 degrees. The table holds the share of revisits that are
recognised, in per cent, when the threshold is such that 99, 97 and 90 % of what is recognised is right; the last column
has the threshold for 97 %, in levels, world by world.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.config import Config
from app.session import Session
from ratslam_core import LocalViewParams
from ratslam_core.local_view.front_ends import FRONT_ENDS
from ratslam_core.local_view.recogniser import matcher_of
from sim2d import World
from sim2d.importers import open_world

EVERY, OLDER_S = 3, 30.0
REVISIT_M, REVISIT_RAD = 0.3, math.radians(15)
RIGHT_M, RIGHT_RAD = 0.8, 0.6
PRECISIONS = (0.99, 0.97, 0.90)
FEWEST = 20  # sights below which a precision says nothing

WORLDS = ("office", "campus", "living", "corridors")
PLANS = tuple(
    Path(__file__).resolve().parents[2] / "shared/data/worlds" / name
    for name in ("amrl/NSH1.vectormap.json", "amrl/AHG2.vectormap.json")
)  # beside the project, if they are there

TEMPLATE, HEARD = LocalViewParams(front_end="template"), LocalViewParams(front_end="image and sonars")


@dataclass(frozen=True, slots=True)
class Way:
    """One way to recognise: a front end, whether it hears the sonars, and whether it doubts what tells little."""

    params: LocalViewParams
    deaf: bool = False
    doubts: bool = True


ROWS = {
    "template, no shifts": Way(replace(TEMPLATE, shift=0)),
    "template": Way(TEMPLATE),
    "complex cells": Way(replace(TEMPLATE, front_end="complex cells")),
    "hue and saturation": Way(replace(TEMPLATE, front_end="hue and saturation")),
    "image and sonars, no shifts": Way(replace(HEARD, shift=0)),
    "image and sonars, sonars off": Way(HEARD, deaf=True),
    "image and sonars, no doubt": Way(HEARD, doubts=False),
    "image and sonars": Way(HEARD),
}


@dataclass(frozen=True, slots=True)
class Frames:
    """What was sensed on one drive, and where: images (n, h, w, 3), ranges (n, sonars) m, poses (n, 3) m and rad."""

    images: NDArray[np.uint8]
    ranges_m: NDArray[np.float32]
    poses: NDArray[np.float64]
    dt: float  # s between two frames


@dataclass(frozen=True, slots=True)
class Sights:
    """Each frame's nearest older frame (-1: none), and how far off it is in levels."""

    best: NDArray[np.int64]
    levels: NDArray[np.float64]


def driven(world: World, seed: int, minutes: float) -> Frames:
    """Drive in the closed loop with default parameters, and keep every third frame."""
    session = Session(world, seed, Config())
    images: list[NDArray[np.uint8]] = []
    ranges: list[NDArray[np.float32]] = []
    poses: list[tuple[float, float, float]] = []
    for tick in range(round(minutes * 60 / session.frame.dt)):
        if tick % EVERY == 0:
            truth = session.simulator.truth
            images.append(session.frame.image)
            ranges.append(session.frame.ranges_m)
            poses.append((truth.x, truth.y, truth.heading_rad))
        session.tick()
    return Frames(np.array(images), np.array(ranges), np.array(poses), EVERY * session.frame.dt)


def sights(frames: Frames, way: Way) -> Sights:
    """The nearest of the frames that are `OLDER_S` older, as the engine finds it."""
    end, params = FRONT_ENDS[way.params.front_end](), way.params
    matcher = matcher_of(end)
    heard = [None if way.deaf else ranges for ranges in frames.ranges_m]
    known = np.array([end.look(image, None, ranges) for image, ranges in zip(frames.images, heard, strict=True)])
    gap = math.ceil(OLDER_S / frames.dt)
    best, levels = np.full(len(known), -1), np.full(len(known), np.inf)
    for k in range(gap + 1, len(known)):
        view, apart, _ = matcher.nearest(known[: k - gap], known[k], params.shift if end.shifts else 0)
        doubt = end.doubt(known[k]) if way.doubts else 0.0
        best[k], levels[k] = view, max(apart * end.scale + doubt, end.vague)
    return Sights(best, levels)


def off(poses: NDArray[np.float64], others: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distances (m) and differences of heading (rad) between poses and others."""
    turn = np.abs((poses[..., 2] - others[..., 2] + np.pi) % (2 * np.pi) - np.pi)
    return np.hypot(poses[..., 0] - others[..., 0], poses[..., 1] - others[..., 1]), turn


def revisits(frames: Frames) -> NDArray[np.bool_]:
    """Which frames show a place that had been seen before from near by."""
    gap, poses = math.ceil(OLDER_S / frames.dt), frames.poses
    found = np.zeros(len(poses), np.bool_)
    for k in range(gap + 1, len(poses)):
        away, turn = off(poses[k], poses[: k - gap])
        found[k] = ((away < REVISIT_M) & (turn < REVISIT_RAD)).any()
    return found


def recalls(frames: Frames, seen: Sights, again: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """For each precision the share of the revisits that are recognised, and the threshold. Shares are 0 if none is right."""
    away, turn = off(frames.poses, frames.poses[seen.best])
    right = (away < RIGHT_M) & (turn < RIGHT_RAD)
    order = np.flatnonzero(seen.best >= 0)
    order = order[np.argsort(seen.levels[order], kind="stable")]
    count = np.arange(1, len(order) + 1)
    precision, found = np.cumsum(right[order]) / count, np.cumsum((right & again)[order])
    out: list[tuple[float, float]] = []
    for least in PRECISIONS:
        good = np.flatnonzero((precision >= least) & (count >= FEWEST))
        last = good[-1] if len(good) else None
        out.append((0.0, 0.0) if last is None else (found[last] / max(again.sum(), 1), float(seen.levels[order[last]])))
    return out


def table(worlds: list[str], seeds: list[int], minutes: float, names: list[str]) -> Iterator[str]:
    """Line by line; medians over the seeds."""
    results: dict[str, list[list[tuple[float, float]]]] = {name: [] for name in names}
    for world in worlds:
        drives = [driven(open_world(world), seed, minutes) for seed in seeds]
        again = [revisits(drive) for drive in drives]
        for name in names:
            runs = [recalls(d, sights(d, ROWS[name]), a) for d, a in zip(drives, again, strict=True)]
            results[name].append([(float(r), float(t)) for r, t in np.median(np.array(runs), axis=0)])
    short = [Path(world).name.removesuffix(".json").removesuffix(".vectormap") for world in worlds]
    yield f"| recall at 99 / 97 / 90 % | {' | '.join(short)} | thresholds for 97 % |"
    yield "|---|" + "---|" * (len(worlds) + 1)
    for name, row in results.items():
        cells = [" / ".join(f"{100 * recall:.0f}" for recall, _ in cell) for cell in row]
        yield f"| {name} | {' | '.join(cells)} | {', '.join(f'{cell[1][1]:.1f}' for cell in row)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("worlds", nargs="*", metavar="WORLD")
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--seeds", type=int, nargs="+", default=[401, 402])
    parser.add_argument("--rows", nargs="+", choices=list(ROWS), default=list(ROWS), metavar="ROW")
    args = parser.parse_args()
    worlds = args.worlds or [*WORLDS, *(str(plan) for plan in PLANS if plan.is_file())]
    for line in table(worlds, args.seeds, args.minutes, args.rows):
        print(line, flush=True)


if __name__ == "__main__":
    main()
