"""How many kidnaps the robot misses at the moment they happen, and how often it believes in one that was none.

    python -m benchmarks.alarms                              # all worlds, 10 minutes each, about two minutes
    python -m benchmarks.alarms --worlds office --seeds 1 2

The robot drives, and each alarm is a false one. Then any two moments of the drive that lie farther apart than half a
metre or half a radian are taken for before and after a kidnap.
"""

# pyright: reportPrivateUsage=false

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.config import Config
from app.session import Session
from ratslam_core.extensions.kidnap_detector import KidnapDetector
from sim2d import load_world

WORLDS = ("office", "living", "campus", "floor", "open-plan", "loop", "corridors", "twins", "two-goals", "suburb")
APART_M, APART_RAD = 0.5, 0.5
PAIRS = 4000


class Moment(NamedTuple):
    """What was sensed, where, and the usual change of the image by then."""

    features: NDArray[np.uint8]
    ranges_m: NDArray[np.float64]
    usual: float
    place: tuple[float, float, float]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.alarms", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("--worlds", nargs="+", choices=WORLDS, default=list(WORLDS))
    parser.add_argument("--seeds", nargs="+", type=int, default=[7901])
    parser.add_argument("--minutes", type=float, default=10.0)
    args = parser.parse_args()
    for world in args.worlds:
        for seed in args.seeds:
            session = Session(load_world(world), seed, Config())
            moments = list(drive(session, args.minutes))
            false = session.brain.experience_map.submaps.begun
            missed = np.mean([not noticed(session, *pair) for pair in kidnaps(moments, seed)])
            print(
                f"{world:10} seed {seed}: {100 * missed:5.2f} % missed, {false} false alarms in {len(moments):,} ticks",
                flush=True,
            )


def drive(session: Session, minutes: float) -> Iterator[Moment]:
    for _ in range(round(minutes * 60 / session.frame.dt)):
        session.tick()
        truth = session.simulator.truth
        detector = session.brain.kidnap_detector
        assert isinstance(detector, KidnapDetector)
        features = session.brain.local_view.features.copy()
        yield Moment(
            features, session.frame.ranges_m.astype(np.float64), detector._usual, (truth.x, truth.y, truth.heading_rad)
        )


def kidnaps(moments: list[Moment], seed: int) -> Iterator[tuple[Moment, Moment]]:
    rng = np.random.default_rng([seed, 1])
    for row in rng.integers(0, len(moments), (PAIRS, 2)):
        before, after = moments[int(row[0])], moments[int(row[1])]
        (x, y, heading), (u, v, other) = before.place, after.place
        if math.hypot(u - x, v - y) > APART_M or abs(math.remainder(other - heading, math.tau)) > APART_RAD:
            yield before, after


def noticed(session: Session, before: Moment, after: Moment) -> bool:
    view = session.brain.local_view
    view._last = before.features
    detector = KidnapDetector(session.config.kidnap)
    detector.observe(0.0, before.ranges_m)
    detector._usual = before.usual
    return detector.observe(view._jump(after.features, 0.0), after.ranges_m)


if __name__ == "__main__":
    main()
