"""How soon the stage is there after the address was opened, `python -m benchmarks.first_stage`: the picture that the server
draws of it, then the viewer's first whole frame, drawn in software.

On a busy machine seconds tell little, so the processor time of the browser until then is told, too: no machine of two cores can
draw sooner than in half of it.
"""

from __future__ import annotations

import argparse
import statistics
import time

import psutil
from playwright.sync_api import Browser, sync_playwright

from benchmarks.machine import verdict
from tests.e2e.browser import launch
from tests.e2e.program import Program

BAR_S = 4.0
PATIENCE_MS = 90_000.0


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--world", default="office")
    parser.add_argument("--after", type=float, default=60.0, help="simulated seconds to explore before")
    parser.add_argument("--times", type=int, default=5)
    options = parser.parse_args()
    program = Program("--port", "0", "--seed", "5", "--speed", "0", "--world", options.world)
    try:
        program.wait(lambda state: state["time_s"] >= options.after)
        program.command("set_speed", factor=1)
        with sync_playwright() as playwright:
            browser = launch(playwright)
            found = [_open(browser, program.url) for _ in range(options.times)]
            browser.close()
    finally:
        program.stop()
    for picture_s, drawn_s, spent_s in found:
        print(
            f"picture after {picture_s:.1f} s, drawn after {drawn_s:.1f} s, {spent_s:.1f} s of the browser's processor time"
        )
    middle_s = statistics.median(drawn_s for _, drawn_s, _ in found)
    print(f"drawn after {middle_s:.1f} s in the median: {verdict(middle_s <= BAR_S)}")
    return 0


def _open(browser: Browser, url: str) -> tuple[float, float, float]:
    """Seconds until the server's picture stood there, until viser had drawn a whole frame, and of processor time until then."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    began_s, before_s = time.monotonic(), _spent_s()
    page.goto(url, wait_until="commit")
    page.wait_for_selector("#waiting .picture", timeout=PATIENCE_MS, state="attached")
    picture_s = time.monotonic() - began_s
    page.wait_for_selector("#stage.awake", timeout=PATIENCE_MS)
    drawn_s, spent_s = time.monotonic() - began_s, _spent_s() - before_s
    context.close()
    return picture_s, drawn_s, spent_s


def _spent_s() -> float:
    """Processor time of the browser with all its processes, which are ours."""
    total = 0.0
    for child in psutil.Process().children(recursive=True):
        if "chrom" in child.name():
            total += sum(child.cpu_times()[:2])
    return total


if __name__ == "__main__":
    raise SystemExit(main())
