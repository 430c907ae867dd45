"""`ratslam bench`: the engine's speed."""

from __future__ import annotations

import argparse
import json
from itertools import chain
from pathlib import Path
from typing import Any

from app.cli.options import Verbs
from disk import require_writable, write_whole


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
