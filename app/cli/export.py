"""`ratslam export`: a run that kept itself, in the format of another program."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from app.cli.options import Verbs
from app.cli.progress import compile_first, share_said, with_progress

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
