"""Fixed learning rates beside the adaptive one, in a world full of look-alikes: `python -m benchmarks.learning_rates`.

ACRA 2004 section 6.6: with a low rate the robot goes on learning ambiguous scenes but relocalises slowly; with a high
rate it snaps quickly, and often wrongly. For each rate and seed the robot explores and is then carried away four times.
Prints one row for each rate, means over the seeds.
"""

from __future__ import annotations

import argparse
import math
import statistics

from tqdm import tqdm

from app.config import Config
from app.session import Session
from sim2d import load_world

RATES: tuple[tuple[str, float, bool], ...] = (
    ("0.05", 0.05, False),
    ("0.15 (C)", 0.15, False),
    ("0.20 (A)", 0.20, False),
    ("0.25 (A)", 0.25, False),
    ("0.50", 0.50, False),
    ("adaptive, 0.15", 0.15, True),
)
FALSE_M = 1.0  # a relocalisation that ends farther than this from the truth is false


def run(world: str, seed: int, rate: float, adaptive: bool, minutes: float) -> dict[str, float]:
    """One robot, which explores for so many minutes and is then carried away four times, every two minutes."""
    config = Config().with_value("local_view.learning_rate", rate).with_value("local_view.adaptive", adaptive)
    session = Session(load_world(world), seed, config)
    evaluation, map_ = session.evaluation, session.brain.experience_map
    snaps = false = 0
    for tick in range(round((minutes + 8) * 600)):
        if tick >= minutes * 600 and tick % 1200 == round(minutes * 600) % 1200:
            session.kidnap()
        session.tick()
        if session.estimate.relocalised and not session.estimate.created:
            snaps += 1
            truth, made = session.simulator.truth, evaluation.made_at(map_.active, map_)
            false += math.dist((truth.x, truth.y), made) > FALSE_M
    after = [kidnap.after_s for kidnap in evaluation.kidnaps if kidnap.after_s is not None]
    return {
        "map_m": evaluation.errors(map_)[0],
        "within": evaluation.revisit_consistency or 0.0,
        "snaps": snaps,
        "false": false,
        "recovered": len(after),
        "after_s": statistics.median(after) if after else math.nan,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", default="twins")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2, 3, 4])
    parser.add_argument("--minutes", type=float, default=12.0)
    args = parser.parse_args()
    print(f"{args.world}, {args.minutes:g} min and four kidnaps, seeds {args.seeds}")
    print("| rate | map error m | revisits within 0.5 m | snaps | false | kidnaps recovered | after s |")
    print("|---|---|---|---|---|---|---|")
    for name, rate, adaptive in tqdm(RATES, unit="rate", disable=None):
        runs = [run(args.world, seed, rate, adaptive, args.minutes) for seed in args.seeds]
        mean = {key: statistics.fmean(r[key] for r in runs if not math.isnan(r[key])) for key in runs[0]}
        kidnaps = f"{sum(r['recovered'] for r in runs):.0f} of {4 * len(runs)}"
        print(
            f"| {name} | {mean['map_m']:.2f} | {mean['within']:.0%} | {mean['snaps']:.1f} | {mean['false']:.1f} "
            f"| {kidnaps} | {mean['after_s']:.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
