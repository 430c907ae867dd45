"""`ratslam runs` and `ratslam replay`: the runs that were kept, and running one of them again."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

from app.cli.options import Verbs
from app.cli.progress import compile_first, with_progress


def add_runs(commands: Verbs) -> None:
    runs = commands.add_parser("runs", help="list the runs that were kept, or delete one")
    runs.add_argument("--json", action="store_true", help="as JSON, one run a line")
    runs.set_defaults(do=_list)
    verbs = runs.add_subparsers(title="commands")
    delete = verbs.add_parser("delete", help="delete a run")
    delete.add_argument("run", metavar="ID", help="as `ratslam runs` lists it, or `last`")
    delete.set_defaults(do=_delete)


def add_replay(commands: Verbs) -> None:
    replay = commands.add_parser("replay", help="run a kept run again, and say whether it comes out the same")
    replay.add_argument("run", metavar="ID|FILE", help="as `ratslam runs` lists it, `last`, or its file")
    replay.set_defaults(do=_replay)


def _list(args: argparse.Namespace) -> int:
    from app.run_record.folder import all_runs, runs_folder

    try:
        where = f" in {runs_folder()}"
    except ValueError as error:
        where = f": {error}"
    rows = [_row(folder) for folder in all_runs()]
    if args.json:
        for row in rows:
            print(json.dumps(row))
    elif not rows:
        print(f"No run is kept{where}")
    else:
        print(f"{'id':28} {'made':16} {'world':14} {'seed':>5} {'min':>6} {'places':>6}  state")
    for row in [] if args.json else rows:
        print(_line(row))
    return 0


def _row(folder: Path) -> dict[str, Any]:
    from app.run_record.folder import is_open
    from app.run_record.reader import open_run

    try:
        run = open_run(folder)
    except ValueError as error:
        return {"id": folder.name, "state": str(error)}
    state = "complete" if run.end else "goes on in another program" if is_open(folder) else "cut off"
    header = run.header
    return {
        "id": run.name, "made_at": header.made_at, "world": header.world_name, "seed": header.seed, "ticks": run.tick,
        "simulated_s": run.length_s, "orders": len(run.orders), "experiences": run.experiences, "state": state,
        "end": run.end, "trial": header.trial, "version": header.version, "same_version": header.same_program,
    }  # fmt: skip


def _line(row: dict[str, Any]) -> str:
    if "made_at" not in row:
        return f"{row['id']:28} {row['state']}"
    made = time.strftime("%Y-%m-%d %H:%M", time.localtime(row["made_at"]))
    places = "?" if row["experiences"] is None else row["experiences"]
    state = (
        row["state"] + ("" if row["same_version"] else ", by another version") + (row["trial"] and f", {row['trial']}")
    )
    minutes = row["simulated_s"] / 60
    return f"{row['id']:28} {made:16} {row['world']:14} {row['seed']:>5} {minutes:>6.1f} {places:>6}  {state}"


def _delete(args: argparse.Namespace) -> int:
    from app.run_record.folder import LINES, all_runs, delete

    runs = {folder.name: folder for folder in all_runs()}
    name = next(iter(runs), args.run) if args.run == "last" else args.run
    if name not in runs:
        raise ValueError(f"there is no run {args.run!r} with a {LINES}: give an id as `ratslam runs` lists them")
    delete(runs[name])
    print(f"Deleted {name}")
    return 0


def _replay(args: argparse.Namespace) -> int:
    """0: it comes out the same; 1: it differs."""
    from app.run_record.reader import open_run
    from app.run_record.resume import ReplayError, replayed

    run = open_run(args.run)
    compile_first()
    try:
        with_progress(run.length_s, lambda tell: replayed(run, lambda s: tell(s, "running it again")))
    except ReplayError as error:
        print(error)
        return 1
    damage = f"; {run.damage}" if run.damage else ""
    print(f"same: {run.tick} ticks, {len(run.orders)} orders, {len(run.hashes)} hashes of the state{damage}")
    return 0
