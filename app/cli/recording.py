"""`ratslam recording`: what is in a recording of a robot, and the options with which one is opened."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.options import Verbs

if TYPE_CHECKING:
    from app.recordings.recording import Recording

TOPICS = ("camera", "odometry", "gyro", "scan", "truth")


def add_recording(commands: Verbs) -> None:
    recording = commands.add_parser("recording", help="look into a recording of a real robot")
    verbs = recording.add_subparsers(title="commands", required=True)
    check = verbs.add_parser(
        "check",
        help="say what is in it, what will be used for what, and what is wrong; 0: nothing, 1: something, 2: all",
    )
    check.add_argument("path", type=Path, metavar="PATH", help="a file or a folder")
    check.add_argument("--json", action="store_true", help="print it as JSON")
    check.add_argument("--seed", type=int, default=0, help="of the errors of --odometry-from-truth (default 0)")
    add_recording_options(check)
    check.set_defaults(do=_check)


def add_recording_options(parser: argparse.ArgumentParser) -> None:
    """What can be said about a recording."""
    group = parser.add_argument_group("recordings")
    for name in TOPICS:
        group.add_argument(f"--{name}-topic", metavar="TOPIC", help=f"take the {name} from this topic of ROS")
    group.add_argument("--rate", type=float, metavar="HZ", help="pictures a second where no file tells (default 10)")
    group.add_argument(
        "--odometry-from-truth", metavar="SPEED_NOISE,YAW_NOISE,BIAS",
        help="make odometry from the truth, with this noise (a share of the speed; rad/s) and bias (rad/s)",
    )  # fmt: skip


def recording_of(path: Path, args: argparse.Namespace) -> Recording:
    """The recording, opened with these options. ValueError."""
    if not 0 <= args.seed < 2**32:
        raise ValueError(f"--seed must be from 0 to {2**32 - 1}, got {args.seed}")
    from app.recordings.formats.ros_topics import Choice
    from app.recordings.motion import parse_errors
    from app.recordings.opening import Opening
    from app.recordings.reader_process import ReaderProcess

    choice = Choice(**{name: getattr(args, f"{name}_topic") for name in TOPICS})
    made = None if args.odometry_from_truth is None else parse_errors(args.odometry_from_truth)
    return ReaderProcess(path, Opening(choice, args.rate, made, args.seed))


def require_no_recording_options(args: argparse.Namespace) -> None:
    """ValueError: an option for recordings was given, but no recording."""
    given = [f"--{name}-topic" for name in TOPICS if getattr(args, f"{name}_topic") is not None]
    given += [
        f"--{name.replace('_', '-')}" for name in ("rate", "odometry_from_truth") if getattr(args, name) is not None
    ]
    if given:
        raise ValueError(f"{given[0]} goes with --recording only")


def _check(args: argparse.Namespace) -> int:
    from app.recordings.opening import check

    checked = check(recording_of(args.path, args))
    if args.json:
        print(json.dumps(checked.report, indent=2))
    else:
        print("\n".join(checked.lines))
        for problem in checked.about.problems:
            print(f"ratslam: {problem}", file=sys.stderr)
        if checked.about.whole:
            print("  nothing is wrong with it")
    return 1 if checked.about.problems else 0
