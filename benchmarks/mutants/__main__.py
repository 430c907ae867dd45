"""How many small faults the tests notice, room by room, and how many faults of the whole.

    python -m benchmarks.mutants --count 100 --seed 1 --kept DIR        # every room; DIR keeps what it is stopped at
    python -m benchmarks.mutants web/http sim2d --json survivors.json   # only these rooms
    python -m benchmarks.mutants faults                                 # what a person would notice

A mutant is one changed operator, comparison, condition, call or returned value in one file of a room. Each is tried in
a copy of the tree, in which the unit and property tests that run its line are run, the quickest first: all that fit
into ten seconds, then, if none of them fails, others for half a minute. A fault of the whole is tried with the
tests that are named beside it. It is noticed if a test fails or takes far too long. Those that nothing notices are
listed; the exit code is 1 where a fault of the whole is among them. tried.json in DIR names for each fault the tests
that noticed it: a test that never stands alone there may be one too many.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.progress import track

from benchmarks.mutants.faults import faults
from benchmarks.mutants.operators import Mutant, mutants_of
from benchmarks.mutants.trees import ROOT, Trees

ROOMS = (
    "ratslam_core", "sim2d", "disk", "app/pilot", "app/engine", "app/protocol", "app/run_record", "app/views",
    "web/http", "web/messages", "web/panel", "web/viewer", "web/static",
)  # fmt: skip
NOT_MUTATED = ("laws", "params", "vendor")  # guards of files, declarations, what others wrote


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"of: {', '.join(ROOMS)}, faults (default: all)")
    parser.add_argument("--count", type=int, default=100, help="mutants of each room (default 100)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--kept", type=Path, metavar="DIR", help="keep there what was found, and go on from it")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the mutants that nothing noticed")
    args = parser.parse_args()
    rooms = args.rooms or [*ROOMS, "faults"]
    if unknown := set(rooms) - {*ROOMS, "faults"}:
        parser.error(f"no room is called {', '.join(sorted(unknown))}. There are: {', '.join(ROOMS)}, faults")
    chosen = {room: _chosen(room, args.count, args.seed) for room in rooms if room != "faults"}
    if not args.count:
        print("none tried")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        kept = args.kept or Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        with closing(Bench(Trees(kept), kept / "tried.json", args.jobs)) as bench:
            survivors = [mutant for room, some in chosen.items() for mutant in bench.room(room, some)]
            unnoticed = bench.faults() if "faults" in rooms else 0
    if args.json is not None:
        args.json.write_text(json.dumps([asdict(m) for m in survivors], indent=1) + "\n", encoding="utf-8")
    return 1 if unnoticed else 0


class Bench:
    """Tries faults, several at a time, and says what became of them. What was tried before is not tried again."""

    def __init__(self, trees: Trees, file: Path, jobs: int) -> None:
        self._trees, self._file = trees, file
        self._pool = ThreadPoolExecutor(jobs)  # one for all rooms: each of its threads has a tree
        self._found: dict[str, list[str]] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)

    def room(self, name: str, mutants: list[Mutant]) -> list[Mutant]:
        """The mutants that nothing noticed."""
        self._trees.learn()
        survivors = [m for m, found in self._tried(dict.fromkeys(mutants, ())) if not found]
        for m in survivors:
            print(f"{m.file}:{m.line}: {m.before!r} -> {m.after!r}")
        killed = len(mutants) - len(survivors)
        print(f"{name}: {killed} of {len(mutants)} killed ({killed / len(mutants):.0%})", flush=True)
        return survivors

    def faults(self) -> int:
        """Each fault of the whole, against its own tests. How many nothing noticed."""
        named = {fault.mutant(ROOT): fault for fault in faults()}
        self._trees.require_known(*{test for fault in named.values() for test in fault.tests})
        tried = self._tried({mutant: fault.tests for mutant, fault in named.items()})
        unnoticed = [named[mutant].name for mutant, found in tried if not found]
        for name in unnoticed:
            print(f"not noticed: {name}")
        print(f"faults of the whole: {len(named) - len(unnoticed)} of {len(named)} noticed")
        return len(unnoticed)

    def _tried(self, tests: dict[Mutant, tuple[str, ...]]) -> Iterator[tuple[Mutant, list[str]]]:
        tried = {self._pool.submit(self._found_by, mutant, own): mutant for mutant, own in tests.items()}
        for one in track(as_completed(tried), "faults", len(tried), console=Console(stderr=True)):
            yield tried[one], one.result()
            self._file.write_text(json.dumps(self._found, indent=1), encoding="utf-8")

    def _found_by(self, mutant: Mutant, tests: tuple[str, ...]) -> list[str]:
        key = repr(mutant)
        if key not in self._found:
            self._found[key] = self._trees.found_by(mutant, tests)
        return self._found[key]


def _chosen(room: str, count: int, seed: int) -> list[Mutant]:
    files = [path for suffix in ("py", "js") for path in sorted((ROOT / room).rglob(f"*.{suffix}"))]
    every = [m for path in files if not set(path.parts) & set(NOT_MUTATED) for m in mutants_of(ROOT, path)]
    return random.Random(seed).sample(every, min(count, len(every)))


if __name__ == "__main__":
    sys.exit(main())
