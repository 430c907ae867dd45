"""The options that several commands share, how they become a world, a config and a brain, where a run's report
goes, and what is shown while a long run takes its time.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from app.config.presets import PRESETS, preset
from app.config.toml_file import read_text
from app.config.tree import Config, Value
from disk import write_whole
from sim2d import DEFAULT_WORLD

if TYPE_CHECKING:
    from ratslam_core import RatSlam
    from sim2d import World


Verbs: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"  # pyright: ignore[reportPrivateUsage]
ENGINES = ("ours", "paper", "paper-2005", "paper-2006")  # as `EngineName`, which loads more


def add_session_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--world",
        default=DEFAULT_WORLD,
        metavar="NAME|FILE",
        help=f"a world by name, or a file: a world or any plan that can be imported (default {DEFAULT_WORLD})",
    )
    parser.add_argument("--scale", type=float, metavar="M", help="metres per pixel, if the world is a plain picture")
    parser.add_argument("--seed", type=int, default=1, help="same seed, same run (default 1)")
    parser.add_argument("--brain", type=Path, metavar="FILE", help="start with a saved brain (see --save-brain)")
    add_config_options(parser)


def add_config_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--preset", metavar="NAME", help=f"the engine of a paper, or a robot: {', '.join(PRESETS)}")
    parser.add_argument("--config", type=Path, metavar="FILE", help="parameters as written by `ratslam config`")
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE", help="change single parameters")


def port_number(text: str) -> int:
    """For argparse: a port, 0 for any free one."""
    port = int(text) if text.isdigit() else -1
    if not 0 <= port <= 65535:
        raise argparse.ArgumentTypeError(f"a port is a whole number from 0 to 65535, got {text!r}")
    return port


def session_of(args: argparse.Namespace) -> tuple[World, Config, RatSlam | None]:
    from app.session_snapshot import load_its_brain
    from sim2d.importers import open_world

    checked_seed(args.seed)
    brain = None if args.brain is None else load_its_brain(args.brain)
    config = config_of(args, Config() if brain is None else Config().with_engine(brain.params))
    for words in config.warnings:
        print(f"ratslam: note: {words}", file=sys.stderr)
    world = open_world(args.world, args.scale, robot_radius_m=config.robot.robot_radius_m, tell=print_note)
    return world, config, brain


def config_of(args: argparse.Namespace, config: Config) -> Config:
    from app.config import from_toml, parse_value

    if args.preset is not None:
        config = preset(args.preset, config)
    if args.config is not None:
        try:
            config = from_toml(read_text(args.config), config)
        except ValueError as error:
            raise ValueError(f"--config {args.config}: {error}") from None
    values: dict[str, Value] = {}
    for pair in args.set:
        name, equals, value = pair.partition("=")
        if not equals:
            raise ValueError(f"--set takes NAME=VALUE, got {pair!r}")
        values[name] = parse_value(value)
    return config.with_values(values)


def checked_seed(seed: int) -> int:
    """The seed. ValueError says which are possible."""
    if not 0 <= seed < 2**32:
        raise ValueError(f"--seed must be from 0 to {2**32 - 1}, got {seed}")
    return seed


def print_note(sentence: str) -> None:
    """A word about a plan, beside what is printed."""
    print(f"ratslam: {sentence}", file=sys.stderr)


def write_report(report: dict[str, Any], file: Path | None, words: str) -> None:
    """Write the report to a file and say so in words, or without a file print it. OSError: it was printed instead."""
    text = json.dumps(report, indent=2) + "\n"
    if file is None:
        print(text, end="")
        if report.get("partial"):
            print(words, file=sys.stderr)
        return
    try:
        write_whole(file, text)
    except OSError:
        print(text, end="")  # the run is over: its report is not lost for want of a file
        raise
    print(f"{words}; report in {file}")


Result = TypeVar("Result")


def with_progress(seconds: float, work: Callable[[Callable[[float, str], None]], Result]) -> Result:
    """Do `work` beside a progress bar of `seconds` simulated seconds.

    work: is given a function to report progress by: simulated seconds since the last call, and what is being done.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn()
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=seconds)
        done_s = 0.0

        def progress(simulated_s: float, what: str) -> None:
            nonlocal done_s
            done_s += simulated_s
            bar.update(task, description=what, completed=done_s, total=max(seconds, done_s))

        return work(progress)


def share_said(seconds: float, work: Callable[[Callable[[float, str], None]], Result]) -> Result:
    """The same for another program: a line on stdout, as `done 0.42`, for each hundredth."""
    done_s, said = 0.0, -1

    def progress(simulated_s: float, _what: str) -> None:
        nonlocal done_s, said
        done_s += simulated_s
        hundredth = min(100, int(100 * done_s / max(seconds, 1e-9)))
        if hundredth > said:
            said = hundredth
            print(f"done {hundredth / 100:.2f}", flush=True)

    return work(progress)


def compile_first() -> None:
    """Compile what is not compiled yet, and say how far that is, before the run's own progress begins."""
    from app.startup.compiling import Compiling, say_how_far

    compiling = Compiling()
    try:
        compiling.wait(say_how_far)
    finally:
        compiling.stop()
