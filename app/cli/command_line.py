"""The command `ratslam`, one file for each of its verbs: run (the dashboard), headless, experiment, export, recording ...

The two smallest verbs stand here: `ratslam bench`, the engine's speed, and `ratslam config`, every parameter with its meaning.
"""

from __future__ import annotations

import argparse
import json
import sys
from importlib import import_module
from itertools import chain
from pathlib import Path
from typing import Any

from app.cli.options import Verbs, add_config_options, config_of
from app.startup.ending import ended
from disk import require_writable, write_whole


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code; ending.py says what the codes mean."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if not arguments or (arguments[0].startswith("-") and arguments[0] not in ("-h", "--help")):
        arguments.insert(0, "run")
    args = parser_of(arguments[0]).parse_args(arguments)
    return ended(lambda: args.do(args))


VERBS = {
    "run": "run", "runs": "runs", "replay": "runs", "headless": "headless", "deliver": "headless", "trial": "trial",
    "experiment": "experiment", "lessons": "lessons", "export": "runs", "recording": "recording", "worlds": "worlds",
    "config": "command_line", "bench": "command_line",
}  # fmt: skip
"""Each verb, and the file of app/cli that adds it, which is read only when it is asked for."""


def parser_of(verb: str = "") -> argparse.ArgumentParser:
    """Understands this verb, or every one if it is none of them, and carries out nothing."""
    parser = argparse.ArgumentParser(prog="ratslam", description="RatSLAM, alive in a browser.")
    commands = parser.add_subparsers(title="commands", required=True)
    for each in [verb] if verb in VERBS else VERBS:
        getattr(import_module(f"app.cli.{VERBS[each]}"), f"add_{each}")(commands)
    return parser


def add_config(commands: Verbs) -> None:
    config = commands.add_parser("config", help="print every parameter as TOML with symbol, unit and source")
    pages = config.add_mutually_exclusive_group()
    pages.add_argument("--table", action="store_true", help="print them as Markdown tables instead")
    pages.add_argument(
        "--additions", action="store_true", help="print what is ours beyond the papers, as a Markdown table"
    )
    pages.add_argument("--measures", action="store_true", help="print what experiments and lessons can measure instead")
    add_config_options(config)
    config.set_defaults(do=_config)


def _config(args: argparse.Namespace) -> int:
    from app.config import Config, additions_markdown, to_markdown, to_toml

    config = config_of(args, Config())
    if args.measures:
        from app.protocol import measures

        text = measures.to_markdown()
    else:
        text = additions_markdown() if args.additions else to_markdown(config) if args.table else to_toml(config)
    print(text, end="")
    return 0


def add_bench(commands: Verbs) -> None:
    bench = commands.add_parser("bench", help="measure the speed of the engine, each part beside a reference")
    bench.add_argument("--json", type=Path, metavar="FILE", help="also write the rows to FILE as JSON")
    bench.add_argument("--quick", action="store_true", help="small sizes, to see that all of it works")
    bench.set_defaults(do=_bench)


def _bench(args: argparse.Namespace) -> int:
    require_writable("--json", args.json)
    from benchmarks import engine, machine, office

    measured: list[dict[str, Any]] = []
    for row in chain(engine.rows(args.quick), office.rows(args.quick)):
        print(engine.line(row), flush=True)
        measured.append(row)
    if not all(row["holds"] for row in measured):
        print(machine.busy_words())
    if args.json is not None:
        write_whole(args.json, json.dumps(measured, indent=2) + "\n")
    return 0
