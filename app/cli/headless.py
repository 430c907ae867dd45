"""`ratslam headless`: the closed loop without a server, and its report. `ratslam deliver`: hours of deliveries between
places spread over the map, and theirs.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from app.cli.options import (
    Verbs,
    add_session_options,
    compile_first,
    config_of,
    session_of,
    with_progress,
    write_report,
)
from app.cli.recording import add_recording_options, recording_of, require_no_recording_options
from disk import require_writable
from sim2d import DEFAULT_WORLD

MINUTES = 20.0


def add_headless(commands: Verbs) -> None:
    headless = commands.add_parser("headless", help="run the same closed loop without a server, as fast as possible")
    add_session_options(headless)
    headless.add_argument("--minutes", type=float, help=f"simulated minutes of exploring (default {MINUTES:g})")
    headless.add_argument("--goals", type=int, default=0, metavar="K", help="then visit K places spread over the map")
    headless.add_argument("--kidnap-at", type=float, nargs="*", default=[], metavar="S", help="kidnap at these seconds")
    headless.add_argument(
        "--kidnaps", type=int, default=0, metavar="N", help="kidnap N times by chance, a third of them in five minutes"
    )
    headless.add_argument("--save-brain", type=Path, metavar="FILE", help="save the brain to FILE at the end")
    headless.add_argument(
        "--report", type=Path, metavar="FILE", help="write the report to FILE as JSON (default: print it)"
    )
    headless.add_argument(
        "--recording", type=Path, metavar="PATH", help="play this recording of a real robot instead of a world"
    )
    headless.add_argument(
        "--trace", type=Path, metavar="FILE", help="of a recording: write a row a frame to FILE as CSV"
    )
    add_recording_options(headless)
    headless.set_defaults(do=_headless)


def _headless(args: argparse.Namespace) -> int:
    if args.recording is not None:
        return _recording(args)
    require_no_recording_options(args)
    if args.trace is not None:
        raise ValueError("--trace goes with --recording only")
    args.minutes = MINUTES if args.minutes is None else args.minutes
    kidnap_at_s = _checked(args)
    world, config, brain = session_of(args)
    for option, file in (("--report", args.report), ("--save-brain", args.save_brain)):
        require_writable(option, file)
    from app.headless import BrainFile, run_headless

    brain_file = None if args.save_brain is None else BrainFile(args.save_brain)
    compile_first()
    report = with_progress(
        args.minutes * 60,
        lambda progress: run_headless(
            world, args.seed, args.minutes,
            config=config, goals=args.goals, kidnap_at_s=kidnap_at_s, progress=progress,
            brain=brain, brain_file=brain_file,
        ),
    )  # fmt: skip
    try:
        write_report(report, args.report, _words(report))
    finally:
        if brain_file is not None:
            brain_file.save()
    return 0


def _recording(args: argparse.Namespace) -> int:
    """Play a recording. Parameters that are given change those which the rules choose for it."""
    for option, given in (
        ("--brain", args.brain), ("--scale", args.scale), ("--kidnap-at", args.kidnap_at), ("--kidnaps", args.kidnaps),
        ("--goals", args.goals), ("--minutes", args.minutes), ("--world", args.world != DEFAULT_WORLD),
    ):  # fmt: skip
        if given:
            raise ValueError(f"{option} does not go with --recording: it has happened where and as it did")
    for option, file in (("--report", args.report), ("--trace", args.trace), ("--save-brain", args.save_brain)):
        require_writable(option, file)
    recording = recording_of(args.recording, args)
    from app.headless.recorded import run_recording
    from app.recordings.playing import Player
    from ratslam_core import save_brain

    compile_first()
    player = Player(recording, args.seed)
    if args.set or args.config is not None or args.preset is not None:
        player = Player(recording, args.seed, config_of(args, player.config))
    report, trace, brain = with_progress(recording.about.seconds, lambda progress: run_recording(player, progress))
    try:
        write_report(report, args.report, _recorded_words(report))
    finally:
        if args.trace is not None:
            trace.write(args.trace, brain.experience_map)
        if args.save_brain is not None:
            save_brain(brain, args.save_brain)
    return 0


def _recorded_words(report: dict[str, Any]) -> str:
    error = report.get("error_m")
    judged = "" if error is None else f"map error {error['map']} m, odometry alone {error['odometry']} m; "
    wrong = f"; {len(report['problems'])} problems, see `ratslam recording check`" if report["problems"] else ""
    return (
        f"{report['recording']}, {report['frames']} frames: {judged}{report['experiences']} experiences, "
        f"{report['views']} views; {report['real_time_factor']:g} x real time{wrong}"
    )


def _checked(args: argparse.Namespace) -> list[float]:
    """The times of the kidnaps. ValueError names the option that is wrong."""
    for name, value, low in (
        ("--minutes", args.minutes, 0.0), ("--goals", args.goals, 0), ("--kidnaps", args.kidnaps, 0)
    ):  # fmt: skip
        if not low <= value < 1e6:
            raise ValueError(f"{name} must be from {low:g} to 1e6, got {value!r}")
    for at in args.kidnap_at:
        if not 0 <= at < args.minutes * 60:
            raise ValueError(f"--kidnap-at must be from 0 to below {args.minutes * 60:g} s, got {at:g}")
    if args.kidnaps and args.kidnap_at:
        raise ValueError("--kidnaps draws its own times; do not give --kidnap-at with it")
    from app.headless.run import kidnap_times

    return kidnap_times(args.kidnaps, args.minutes, args.seed) or args.kidnap_at


def _words(report: dict[str, Any]) -> str:
    reached = sum(goal["reached"] for goal in report["goals"])
    goals = f", {reached} of {len(report['goals'])} goals reached" if report["goals"] else ""
    found = sum(kidnap["recovered"] for kidnap in report["kidnaps"])
    kidnaps = f", {found} of {len(report['kidnaps'])} kidnaps recovered from" if report["kidnaps"] else ""
    error = report["error_m"]
    return (
        f"{report['world']}, seed {report['seed']}: map error {error['map']} m, "
        f"odometry alone {error['odometry']} m{goals}{kidnaps}; {report['real_time_factor']:g} x real time"
    )


DELIVERY_S = 40.0  # about what a delivery takes, for the progress bar


def add_deliver(commands: Verbs) -> None:
    deliver = commands.add_parser("deliver", help="explore, then deliver between places spread over the map, for hours")
    add_session_options(deliver)
    deliver.add_argument("--minutes", type=float, default=20.0, help="simulated minutes of exploring (default 20)")
    deliver.add_argument("--goals", type=int, default=11, metavar="K", help="places, spread over the map (default 11)")
    deliver.add_argument("--deliveries", type=int, default=110, metavar="N", help="how many in all (default 110)")
    deliver.add_argument(
        "--timeout", type=float, default=300.0, metavar="S", help="a longer delivery fails (default 300)"
    )
    deliver.add_argument(
        "--report", type=Path, metavar="FILE", help="write the report to FILE as JSON (default: print it)"
    )
    deliver.set_defaults(do=_deliver)


def _deliver(args: argparse.Namespace) -> int:
    _check(args)
    world, config, brain = session_of(args)
    require_writable("--report", args.report)
    from app.headless import Deliveries

    compile_first()
    runs: list[Deliveries] = []

    def work(progress: Any) -> None:
        runs.append(
            Deliveries(
                world, args.seed, minutes=args.minutes, goals=args.goals, deliveries=args.deliveries,
                timeout_s=args.timeout, config=config, brain=brain, progress=progress,
            )
        )  # fmt: skip
        runs[0].carry_out()

    try:
        with_progress(args.minutes * 60 + args.deliveries * DELIVERY_S, work)
    except KeyboardInterrupt:
        if runs:
            _write(runs[0].report(), args)
        raise
    _write(runs[0].report(), args)
    return 0


def _check(args: argparse.Namespace) -> None:
    for name, value, low, high, advice in (
        ("--minutes", args.minutes, 0.1, 1e6, "the robot must have seen the places to which it delivers"),
        ("--goals", args.goals, 2, 1000, "a delivery leads from one place to another"),
        ("--deliveries", args.deliveries, 1, 1e6, "the bar of two weeks in an office is 1143"),
        ("--timeout", args.timeout, 1, 1e6, "seconds that a delivery may take, 300 by default"),
    ):
        if not low <= value <= high:
            raise ValueError(f"{name} must be from {low:g} to {high:g}, got {value:g}; {advice}")


def _write(report: dict[str, Any], args: argparse.Namespace) -> None:
    done, failed = report["deliveries"], len(report["failures"])
    stopped = f"stopped early, after {done} of {args.deliveries} deliveries: " if report["partial"] else ""
    words = (
        f"{report['world']}, seed {report['seed']}: {stopped}{report['succeeded']} of {done} deliveries succeeded, "
        f"{failed} failed; {report['metres'] / 1000:.2f} km in {report['simulated_s'] / 3600:.2f} h, "
        f"{report['real_time_factor']:g} x real time"
    )
    write_report(report, args.report, words)
