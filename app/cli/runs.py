"""`ratslam runs`, `replay` and `export`: the runs that were kept, running one of them again, and one in the format of
another program.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

from app.cli.options import Verbs, compile_first, share_said, with_progress


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
        with_progress(run.length_s, lambda progress: replayed(run, lambda s: progress(s, "running it again")))
    except ReplayError as error:
        print(error)
        return 1
    damage = f"; {run.damage}" if run.damage else ""
    print(f"same: {run.tick} ticks, {len(run.orders)} orders, {len(run.hashes)} hashes of the state{damage}")
    return 0


_FORMATS = ("mcap", "tum", "g2o", "graphml", "csv", "png", "mp4")  # app.export.FORMATS, which takes long to import


def add_export(commands: Verbs) -> None:
    parser = commands.add_parser(
        "export",
        help="write a run in the format of another program",
        description="The run is played again, so that everything that was in it can be written.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="mcap     ROS 2 messages of every tick, for ROS 2, Foxglove, Rerun, evo\n"
        "tum      the true path, the estimate and what was believed at the time, three files, for evo\n"
        "g2o      the experience map as a pose graph\n"
        "graphml  the experience map as a graph, for networkx, Gephi\n"
        "csv      a row for each tick\n"
        "png      pictures of map, temporal map and paths, three files\n"
        "mp4      a film of camera, map and pose cells",
    )
    parser.add_argument("run", metavar="RUN", help="its id (see `ratslam runs`) or its file")
    parser.add_argument("--to", choices=_FORMATS, required=True, help="the format")
    parser.add_argument("--out", type=Path, metavar="PATH", help="where it goes (default ./RUN.FORMAT)")
    parser.add_argument("--from", dest="from_s", type=float, default=0.0, metavar="S", help="from this second on")
    parser.add_argument("--until", dest="until_s", type=float, default=math.inf, metavar="S", help="until this second")
    parser.add_argument(
        "--pictures", choices=("png", "jpeg", "none"), default="png",
        help="of the camera in an mcap: png is exact (default), jpeg a third as large, none a tenth",
    )  # fmt: skip
    parser.add_argument(
        "--speed", type=float, default=10.0, metavar="X", help="of an mp4, times the run's (default 10)"
    )
    parser.add_argument(
        "--say-share", action="store_true", help="say on lines of their own which share is done, for programs"
    )
    parser.set_defaults(do=_export)


def _export(args: argparse.Namespace) -> int:
    from app.export import Choices, Window, check_export, export_run
    from app.run_record.reader import open_run

    window = Window(args.from_s, args.until_s)
    run = open_run(args.run)
    out = args.out or Path(f"{run.name}.{args.to}")
    check_export(args.to, out)
    compile_first()
    length_s = min(window.until_s, run.length_s)
    choices = Choices(args.pictures, args.speed)
    show = share_said if args.say_share else with_progress
    files = show(length_s, lambda progress: export_run(run, args.to, out, window, progress, choices))
    for file in files:
        print(f"{file}  {file.stat().st_size / 1e6:.1f} MB")
    return 0
