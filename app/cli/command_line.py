"""The command `ratslam`, one file for each of its verbs: run (the dashboard), headless, experiment, export, recording ..."""

from __future__ import annotations

import argparse
import sys

from app.cli.bench import add_bench
from app.cli.config import add_config
from app.cli.deliver import add_deliver
from app.cli.experiment import add_experiment
from app.cli.export import add_export
from app.cli.headless import add_headless
from app.cli.lessons import add_lessons
from app.cli.recording import add_recording
from app.cli.run import add_run
from app.cli.runs import add_replay, add_runs
from app.cli.trial import add_trial
from app.cli.worlds import add_worlds
from app.startup.ending import ended


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code; ending.py says what the codes mean."""
    parser = parser_of_all()
    arguments = list(sys.argv[1:] if argv is None else argv)
    if not arguments or (arguments[0].startswith("-") and arguments[0] not in ("-h", "--help")):
        arguments.insert(0, "run")
    args = parser.parse_args(arguments)
    return ended(lambda: args.do(args))


def parser_of_all() -> argparse.ArgumentParser:
    """Understands every command, and carries out none."""
    parser = argparse.ArgumentParser(prog="ratslam", description="RatSLAM, alive in a browser.")
    commands = parser.add_subparsers(title="commands", required=True)
    for add in (
        *(add_run, add_runs, add_replay, add_headless, add_deliver, add_trial, add_experiment, add_lessons),
        *(add_export, add_recording, add_worlds, add_config, add_bench),
    ):
        add(commands)
    return parser
