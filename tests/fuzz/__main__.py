"""Spoils inputs by the thousand and counts the outcomes. The exit code is 1 when one was not processed properly.

With NUMBA_BOUNDSCHECK=1 and a NUMBA_CACHE_DIR of its own, a kernel that would write beyond an array is a traceback, too.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator

from app.startup.ending import command
from tests.fuzz.inputs import KINDS
from tests.fuzz.messages import BATCH, MESSAGES

MOST_MIB, MOST_S = 1024, 10.0
START_S = 300.0  # a new process compiles and lets its robots drive first
SOUND = ("taken", "refused")


class Worker:
    """A process that is started again when it dies, with a temporary folder of its own."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._fresh = True

    def ask(self, kind: str, seed: int) -> dict[str, object]:
        if self._process is None:
            self._temporary = tempfile.TemporaryDirectory(prefix="ratslam-fuzz-")
            self._process = subprocess.Popen(
                [sys.executable, "-m", "tests.fuzz.worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, text=True, env={**os.environ, "TMPDIR": self._temporary.name},
            )  # fmt: skip
            self._fresh = True
        process, limit = self._process, START_S if self._fresh else 6 * MOST_S
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(json.dumps([kind, seed]) + "\n")
        process.stdin.flush()
        if not select.select([process.stdout], [], [], limit)[0]:
            self.close()
            return {"outcome": "hangs", "words": "", "seconds": limit, "mib": 0}
        line = process.stdout.readline()
        if not line:
            code = process.wait()
            self.close()
            return {"outcome": f"died with {code}", "words": "", "seconds": 0.0, "mib": 0}
        answer, answer_fresh = json.loads(line), self._fresh
        self._fresh = False
        return {**answer, "seconds": 0.0} if answer_fresh else answer

    def close(self) -> None:
        """What a process that is killed leaves behind goes with it."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None
            self._temporary.cleanup()


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000, help="spoilt files (default 10000)")
    parser.add_argument(
        "--messages", type=int, default=0, help="websocket messages, and half as many requests, besides"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=[*KINDS, *MESSAGES], help="nothing else")
    args = parser.parse_args()
    with contextlib.closing(Worker()) as worker:
        return tried(worker, args)


def tried(worker: Worker, args: argparse.Namespace) -> int:
    """Ask the worker about each case, and tell what came of them. The exit code."""
    counts, faults = Counter[tuple[str, str]](), 0
    slowest, largest, began = 0.0, 0, time.monotonic()
    for kind, seed in cases(args):
        answer = worker.ask(kind, seed)
        outcome = str(answer["outcome"])
        if outcome in SOUND and float(str(answer["seconds"])) > MOST_S * (BATCH if kind in MESSAGES else 1):
            outcome = "slow"
        if outcome in SOUND and int(str(answer["mib"])) > MOST_MIB:
            outcome = "memory"
            worker.close()
        slowest, largest = max(slowest, float(str(answer["seconds"]))), max(largest, int(str(answer["mib"])))
        counts[kind, outcome] += 1
        if outcome not in SOUND:
            faults += 1
            print(f"{kind}, seed {seed}: {outcome}\n{answer['words']}", flush=True)
    for (kind, outcome), count in sorted(counts.items()):
        print(f"{kind:12} {outcome:12} {count:6}")
    print(
        f"slowest {slowest:.1f} s, most memory {largest} MiB, {faults} faults, {time.monotonic() - began:.0f} s in all"
    )
    return 1 if faults else 0


def cases(args: argparse.Namespace) -> Iterator[tuple[str, int]]:
    """Kinds and seeds of the cases, by the share of each kind; a batch of messages counts as its number of messages."""
    whole = sum(share for _, share in KINDS.values())
    for kind, (_, share) in KINDS.items():
        if args.only in (None, kind):
            count = args.count if args.only else -(-args.count * share // whole)
            yield from ((kind, args.seed * 1_000_000 + k) for k in range(count))
    for kind, count in (("messages", args.messages), ("requests", args.messages // 2)):
        if args.only in (None, kind):
            yield from ((kind, args.seed * 1_000_000 + k) for k in range(-(-count // BATCH)))


if __name__ == "__main__":
    sys.exit(command(main))
