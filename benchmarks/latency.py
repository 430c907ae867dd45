"""From a click or key in a real browser to the changed snapshot on the wire: `python -m benchmarks.latency`. Bar: p95 150 ms.

The clock starts with the input event in the page and stops when the page gets the first state that shows the change, so
it includes both ways through the websocket and the wait for the engine's tick at x1. The viewer's frame is removed
first: without a graphics card it draws two to five times a second in the page's own thread and would dominate the
result.
"""

from __future__ import annotations

import argparse
import statistics

from playwright.sync_api import Page, sync_playwright

from benchmarks.machine import verdict
from tests.e2e.browser import launch, open_page
from tests.e2e.program import Program

BAR_MS = 150.0
TURNED = "(arrow until it turns)"  # reported, not judged: the motion itself takes up to a whole tick of 100 ms
WATCH = """() => {
    window.seen = [];
    const socket = new WebSocket(`ws://${location.host}/api/stream?page=${"l".repeat(22)}`);
    socket.onmessage = (event) => {
        const message = JSON.parse(event.data);
        if (message.type === "state") { window.newest = message.state; window.check?.(); }
    };
    window.measure = (act, changed) => new Promise((resolve) => {
        const before = window.newest;
        window.check = () => {
            if (!changed(before, window.newest)) return;
            window.check = null;
            resolve(performance.now() - began);
        };
        const began = performance.now();
        act();
    });
}"""
CLICK = """() => measure(() => document.getElementById("play").click(), (a, b) => a.running !== b.running)"""
KEY = """() => measure(
    () => window.dispatchEvent(new KeyboardEvent("keydown", {code: "Space", key: " "})),
    (a, b) => a.running !== b.running)"""
HOLD = """(turned) => measure(
    () => window.dispatchEvent(new KeyboardEvent("keydown", {code: "ArrowLeft", key: "ArrowLeft"})),
    (a, b) => turned ? Math.abs(b.robot.heading_rad - a.robot.heading_rad) > 1e-3 : b.mode === "manual")"""
LET_GO = """() => window.dispatchEvent(new KeyboardEvent("keyup", {code: "ArrowLeft", key: "ArrowLeft"}))"""


def samples(page: Page, program: Program, count: int) -> dict[str, list[float]]:
    page.evaluate("() => document.getElementById('stage').remove()")
    page.evaluate(WATCH)
    page.wait_for_timeout(1000)
    found: dict[str, list[float]] = {"click on pause/play": [], "space": [], "arrow until by hand": [], TURNED: []}
    for _ in range(count):
        found["click on pause/play"].append(page.evaluate(CLICK))
        page.wait_for_timeout(230)
        found["space"].append(page.evaluate(KEY))
        page.wait_for_timeout(230)
    program.command("resume")
    for _ in range(count):
        program.command("set_mode", mode="explore")
        page.wait_for_timeout(180)
        found["arrow until by hand"].append(page.evaluate(HOLD, False))
        page.evaluate(LET_GO)
        page.wait_for_timeout(500)
        found[TURNED].append(page.evaluate(HOLD, True))
        page.evaluate(LET_GO)
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--count", type=int, default=60, help="of each kind")
    options = parser.parse_args()
    program = Program("--port", "0", "--seed", "1")
    worst = 0.0
    try:
        with sync_playwright() as playwright, open_page(launch(playwright), program.url) as page:
            for name, times in samples(page, program, options.count).items():
                p95 = statistics.quantiles(times, n=20)[-1]
                worst = worst if name == TURNED else max(worst, p95)
                print(f"{name:22} median {statistics.median(times):6.1f} ms   p95 {p95:6.1f} ms   ({len(times)})")
    finally:
        program.stop()
    print(f"p95 {worst:.0f} ms, bar {BAR_MS:.0f} ms: {verdict(worst <= BAR_MS)}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
