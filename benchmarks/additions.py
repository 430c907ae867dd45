"""What each addition of ours is worth: the closed loop with and without it, on the same seeds and worlds, as a table.

    python -m benchmarks.additions --seeds 21 22 23 24 25 --worlds office living loop --minutes 10 --table docs/additions.md

In each run the robot explores, is kidnapped once at half time, and then visits places spread over the map. A row holds
the runs without one addition. The first row has all additions; the last rows are the papers' engines.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tqdm import tqdm

from app.config import Config
from app.headless import run_headless
from ratslam_core.params.additions import ADDITIONS, Value
from ratslam_core.params.presets import PRESETS
from sim2d import load_world

Run = tuple[str, str, int, float, int]  # row, world, seed, minutes, goals


def rows() -> dict[str, dict[str, Value]]:
    """The parameters that are set in each row."""
    papers = {name: values for name, values in PRESETS.items() if name != "ours"}
    return {"ours, all of them": {}} | {f"without {a.name}": a.off for a in ADDITIONS} | papers


def run(job: Run) -> dict[str, Any]:
    row, world, seed, minutes, goals = job
    config = Config()
    for name, value in rows()[row].items():
        config = config.with_value(name, value)
    report = run_headless(
        load_world(world), seed, minutes, config=config, goals=goals, kidnap_at_s=[minutes * 30]
    )  # seconds: the middle
    return {"row": row, "world": world, "seed": seed, **_figures(report)}


def _figures(report: dict[str, Any]) -> dict[str, Any]:
    return {
        "error_m": report["error_m"]["map"],
        "reached": sum(goal["reached"] for goal in report["goals"]),
        "goals": len(report["goals"]),
        "found_again_s": report["kidnaps"][0]["after_s"],
        "relocalisations": report["relocalisations"],
        "simulated_a_second": report["real_time_factor"],
    }


def table(runs: list[dict[str, Any]], worlds: list[str]) -> Iterator[str]:
    """The table: median map error in each world, and how many goals and kidnaps succeeded in all of them."""
    errors = " | ".join(f"{world}: map error, median (worst)" for world in worlds)
    yield f"| | {errors} | goals reached | found again after a kidnap |"
    yield "|---|" + "---|" * (len(worlds) + 2)
    for row in rows():
        own = [r for r in runs if r["row"] == row]
        if not own:
            continue
        metres = [[_metres(r) for r in own if r["world"] == world] for world in worlds]
        cells = [f"{statistics.median(e):.2f} m ({max(e):.2f})" for e in metres]
        reached, goals = sum(r["reached"] for r in own), sum(r["goals"] for r in own)
        found = [r["found_again_s"] for r in own if r["found_again_s"] is not None]
        again = f"{len(found)} of {len(own)}" + (f", median {statistics.median(found):.0f} s" if found else "")
        yield f"| {row} | {' | '.join(cells)} | {reached} of {goals} | {again} |"


def _metres(run: dict[str, Any]) -> float:
    return float("inf") if run["error_m"] is None else float(run["error_m"])


def page(runs: list[dict[str, Any]], args: argparse.Namespace) -> str:
    """The whole of docs/additions.md."""
    what = "\n".join(f"| {a.name} | {a.adds} | {a.why} | {_names(a.off)} |" for a in ADDITIONS)
    return f"""# What is ours

The papers' engine runs by itself: `--preset paper-2004`, `paper-2005`, `paper-2006`, or *preset* in the *Office* tab. What is
ours is on by default (`ours`); each addition has a switch and a plain twin. With all of them off whole runs are, tick by tick,
those of a literal twin written from the equations (`test_papers.py`).

| addition | what it adds | why | off with |
|---|---|---|---|
{what}

## With and without

Made by `python -m benchmarks.additions`: seeds {", ".join(map(str, args.seeds))} in each of {len(args.worlds)} worlds,
{args.minutes:g} simulated minutes of exploring with a kidnap at half time, then {args.goals} places to visit.
The map of a robot that does not find itself again is wrong by metres. What the rows tell, and what they do not, is in
[findings](findings.md#what-each-addition-is-worth).

{chr(10).join(table(runs, args.worlds))}
"""


def _names(off: dict[str, Value]) -> str:
    return ", ".join(f"`{name} = {json.dumps(value)}`" for name, value in off.items())


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[21, 22, 23, 24, 25])
    parser.add_argument("--worlds", nargs="+", default=["office", "living", "loop"])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--goals", type=int, default=4)
    parser.add_argument("--rows", nargs="+", choices=list(rows()), default=list(rows()), metavar="ROW")
    parser.add_argument("--jobs", type=int, default=multiprocessing.cpu_count())
    parser.add_argument("--json", type=Path, metavar="FILE", help="every run")
    parser.add_argument("--table", type=Path, metavar="FILE", help="the page for the documentation")
    args = parser.parse_args()
    jobs = [(r, w, s, args.minutes, args.goals) for r in args.rows for w in args.worlds for s in args.seeds]
    with multiprocessing.get_context("spawn").Pool(args.jobs) as pool:
        runs = list(tqdm(pool.imap(run, jobs), total=len(jobs), unit="run", disable=None))
    if args.json is not None:
        args.json.write_text(json.dumps(runs, indent=1) + "\n", encoding="utf-8")
    if args.table is not None:
        args.table.write_text(page(runs, args), encoding="utf-8")
    print("\n".join(table(runs, args.worlds)))


if __name__ == "__main__":
    main()
