"""The command `ratslam`: run (the dashboard), headless, config, bench, worlds."""

from __future__ import annotations

import argparse
import json
import os
import sys
import webbrowser
from itertools import chain
from pathlib import Path
from typing import Any

from app.config import Config, from_toml, parse_value, to_markdown, to_toml
from app.presets import PRESETS, preset
from app.worlds_command import add_worlds
from ratslam_core import RatSlam, load_brain
from sim2d import DEFAULT_WORLD, World, WorldError
from sim2d.importers import open_world


def main(argv: list[str] | None = None) -> int:
    """Entry point; 0 when all went well, 2 when what was asked for cannot be."""
    parser = _parser()
    arguments = list(sys.argv[1:] if argv is None else argv)
    if not arguments or (arguments[0].startswith("-") and arguments[0] not in ("-h", "--help")):
        arguments.insert(0, "run")
    args = parser.parse_args(arguments)
    try:
        return args.do(args)
    except (WorldError, ValueError) as error:
        print(f"ratslam: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="ratslam", description="RatSLAM, alive in a browser.")
    commands = parser.add_subparsers(title="commands", required=True)

    run = commands.add_parser("run", help="open the dashboard (this is what `ratslam` alone does)")
    _add_session(run)
    run.add_argument("--port", type=_port, default=8000, help="port on 127.0.0.1, 0 for any free one (default 8000)")
    run.add_argument("--no-browser", action="store_true", help="only print the address")
    run.add_argument("--paused", action="store_true", help="wait for play")
    run.add_argument("--speed", type=float, default=1.0, help="simulated seconds per second, 0 = as fast as possible")
    run.set_defaults(do=_run)

    headless = commands.add_parser("headless", help="the same closed loop without a server, as fast as it goes")
    _add_session(headless)
    headless.add_argument("--minutes", type=float, default=20.0, help="simulated minutes of exploring (default 20)")
    headless.add_argument("--goals", type=int, default=0, metavar="K", help="then visit K places spread over the map")
    headless.add_argument("--kidnap-at", type=float, nargs="*", default=[], metavar="S", help="kidnap at these seconds")
    headless.add_argument("--save-brain", type=Path, metavar="FILE", help="write there what the robot knows in the end")
    headless.add_argument(
        "--report", type=Path, metavar="FILE", help="write the report there as JSON (default: print it)"
    )
    headless.set_defaults(do=_headless)

    config = commands.add_parser("config", help="print every parameter as TOML with symbol, unit and source")
    config.add_argument("--table", action="store_true", help="as a Markdown table")
    _add_config(config)
    config.set_defaults(do=_config)

    bench = commands.add_parser("bench", help="measure the engine, each work beside a reference")
    bench.add_argument("--json", type=Path, metavar="FILE", help="write the rows there as JSON, too")
    bench.set_defaults(do=_bench)

    add_worlds(commands)
    return parser


def _add_session(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--world",
        default=DEFAULT_WORLD,
        metavar="NAME|FILE",
        help=f"default: {DEFAULT_WORLD}; any plan that can be imported",
    )
    parser.add_argument("--scale", type=float, metavar="M", help="metres a pixel, when the world is a plain picture")
    parser.add_argument("--seed", type=int, default=1, help="same seed, same run (default 1)")
    parser.add_argument("--brain", type=Path, metavar="FILE", help="start with what another robot knows (--save-brain)")
    _add_config(parser)


def _add_config(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--preset", metavar="NAME", help=f"a robot as it was: {', '.join(PRESETS)}")
    parser.add_argument("--config", type=Path, metavar="FILE", help="parameters as written by `ratslam config`")
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE", help="change single parameters")


def _port(text: str) -> int:
    port = int(text) if text.isdigit() else -1
    if not 0 <= port <= 65535:
        raise argparse.ArgumentTypeError(f"a port is a whole number from 0 to 65535, got {text!r}")
    return port


def _config_of(args: argparse.Namespace, config: Config) -> Config:
    if args.preset is not None:
        config = preset(args.preset, config)
    if args.config is not None:
        try:
            config = from_toml(args.config.read_text(encoding="utf-8"), config)
        except OSError as error:
            raise ValueError(f"--config {args.config}: {error.strerror or error}") from None
        except ValueError as error:
            raise ValueError(f"--config {args.config}: {error}") from None
    for pair in args.set:
        name, equals, value = pair.partition("=")
        if not equals:
            raise ValueError(f"--set takes NAME=VALUE, got {pair!r}")
        config = config.with_value(name, parse_value(value))
    return config


def _session_of(args: argparse.Namespace) -> tuple[World, Config, RatSlam | None]:
    if not 0 <= args.seed < 2**32:
        raise ValueError(f"--seed must be from 0 to {2**32 - 1}, got {args.seed}")
    brain = None if args.brain is None else load_brain(args.brain)
    config = _config_of(args, Config() if brain is None else Config().with_engine(brain.params))
    for words in config.warnings:
        print(f"ratslam: note: {words}", file=sys.stderr)
    return open_world(args.world, args.scale, robot_radius_m=config.robot.robot_radius_m), config, brain


def _run(args: argparse.Namespace) -> int:
    if not 0 <= args.speed <= 1000:
        raise ValueError(f"--speed must be from 0 to 1000, got {args.speed:g}")
    world, config, brain = _session_of(args)
    from app.runner import Runner
    from web.server import CannotListen, Dashboard
    from web.stage.stage import Stage

    runner = Runner(world, args.seed, config, speed=args.speed, running=not args.paused, brain=brain)
    stage = Stage(runner.latest, runner.submit)
    dashboard = Dashboard(runner.latest, runner.submit, stage, port=args.port)
    try:
        dashboard.bind()
    except CannotListen as error:
        raise ValueError(str(error)) from None

    def ready(url: str) -> None:
        print(f"RatSLAM is alive at {url}  (Ctrl+C ends it)", flush=True)
        if not args.no_browser and _has_screen():
            webbrowser.open(url)

    dashboard.on_ready = ready
    print("RatSLAM wakes up (the very first time it compiles itself, for some ten seconds) ...", flush=True)
    runner.start()
    try:
        dashboard.run()
    finally:
        runner.stop()
    return 0


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _headless(args: argparse.Namespace) -> int:
    for name, value, low in (("--minutes", args.minutes, 0.0), ("--goals", args.goals, 0)):
        if not low <= value < 1e6:
            raise ValueError(f"{name} must be from {low:g} to 1e6, got {value!r}")
    for at in args.kidnap_at:
        if not 0 <= at < args.minutes * 60:
            raise ValueError(f"--kidnap-at must be from 0 to below {args.minutes * 60:g} s, got {at:g}")
    world, config, brain = _session_of(args)
    if args.report is not None and not args.report.absolute().parent.is_dir():
        raise ValueError(f"--report {args.report}: there is no folder {args.report.absolute().parent}")
    if args.save_brain is not None and not args.save_brain.absolute().parent.is_dir():
        raise ValueError(f"--save-brain {args.save_brain}: there is no folder {args.save_brain.absolute().parent}")
    from app.headless import run_headless

    report = _with_progress(
        args.minutes * 60,
        lambda progress: run_headless(
            world, args.seed, args.minutes,
            config=config, goals=args.goals, kidnap_at_s=args.kidnap_at, progress=progress,
            brain=brain, save_brain_to=args.save_brain,
        ),
    )  # fmt: skip
    text = json.dumps(report, indent=2) + "\n"
    if args.report is None:
        print(text, end="")
        return 0
    args.report.write_text(text, encoding="utf-8")
    reached = sum(goal["reached"] for goal in report["goals"])
    goals = f", {reached} of {len(report['goals'])} goals reached" if report["goals"] else ""
    error = report["error_m"]
    print(
        f"{report['world']}, seed {report['seed']}: map error {error['map']} m, odometry alone {error['odometry']} m{goals}; "
        f"{report['real_time_factor']:g} x real time; report in {args.report}"
    )
    return 0


def _with_progress(seconds: float, work: Any) -> Any:
    from tqdm import tqdm

    with tqdm(total=round(seconds), unit="s", unit_scale=True, disable=not sys.stderr.isatty()) as bar:

        def progress(simulated_s: float, what: str) -> None:
            bar.set_description(what, refresh=False)
            if bar.n + simulated_s > (bar.total or 0):
                bar.total = round(bar.n + simulated_s)
            bar.update(simulated_s)

        return work(progress)


def _config(args: argparse.Namespace) -> int:
    write = to_markdown if args.table else to_toml
    print(write(_config_of(args, Config())), end="")
    return 0


def _bench(args: argparse.Namespace) -> int:
    from benchmarks import engine, office

    measured = []
    for row in chain(engine.rows(), office.rows()):
        print(engine.line(row), flush=True)
        measured.append(row)
    if args.json is not None:
        args.json.write_text(json.dumps(measured, indent=2) + "\n", encoding="utf-8")
    return 0
