"""The program's processor time and memory with one browser at x1: `python -m benchmarks.server_load`. Bar: 40 % of a core.

Only the program's own process is counted, not the browser, which draws in software.
"""

from __future__ import annotations

import argparse
import time
from itertools import pairwise

import psutil
from playwright.sync_api import sync_playwright

from benchmarks.machine import verdict
from tests.e2e.browser import launch, open_page
from tests.e2e.program import Program

BAR = 0.40
GROWTH_MB_PER_MINUTE = 2.0
THIRDS = 3


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--seconds", type=float, default=120.0)
    options = parser.parse_args()
    program = Program("--port", "0", "--seed", "1")
    try:
        server = psutil.Process(program.process.pid)
        with sync_playwright() as playwright:
            alone = _load(server, program, min(10.0, options.seconds))
            with open_page(launch(playwright), program.url) as page:
                page.wait_for_timeout(8000)
                sizes, loads = [server.memory_info().rss], list[float]()
                for _ in range(THIRDS):
                    loads.append(_load(server, program, options.seconds / THIRDS))
                    sizes.append(server.memory_info().rss)
        watched = sum(loads) / THIRDS
        steps = [(after - before) / 1e6 for before, after in pairwise(sizes)]
        grown = min(steps) * 60 / options.seconds * THIRDS  # a leak shows in every third, a doubled array in one
        memory = server.memory_info().rss / 1e6
    finally:
        program.stop()
    print(f"nobody watches {alone:.1%} of a core; one browser {watched:.1%}, bar {BAR:.0%}")
    print(f"memory {memory:.0f} MB, growing {grown:.1f} MB a minute in the calmest third while the map grows")
    print(verdict(watched <= BAR and grown <= GROWTH_MB_PER_MINUTE))
    return 0


def _load(server: psutil.Process, program: Program, seconds: float) -> float:
    server.cpu_percent()
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        time.sleep(min(5.0, seconds))
        program.state()
    return server.cpu_percent() / 100


if __name__ == "__main__":
    raise SystemExit(main())
