"""From a drag of the timeline in a real browser to the moment on the page: `python -m benchmarks.seeking [--hours 10]`.
Bar: p95 0.3 s in an hour of run, 1.0 s in ten.

The clock starts with the last movement of the pointer. For panel and plots it stops two frames after the last message that
the page gets because of it. For the plates it stops with the last message to their viewer, which is heard without drawing
it: on a machine without a graphics card the processors would draw, for longer than all the rest takes (`--draw` has it so).
"""

from __future__ import annotations

import argparse
import contextlib
import random
import statistics
import threading
import time

from playwright.sync_api import Page, sync_playwright
from websockets import ConnectionClosed, Origin, Subprotocol
from websockets.sync.client import connect

from benchmarks.machine import verdict
from tests.e2e.browser import box_of, launch, open_page
from tests.e2e.program import Program
from tests.unit.web.test_proxy import PROTOCOL
from tests.unit.web.test_viser_server import camera

LONG_HOURS, BAR_S, LONG_BAR_S = 1.0, 0.3, 1.0  # longer runs than this have another bar
QUIET_S = 1.3  # without messages; the slowest part of the page is sent once a second
MOVES = 5  # of the pointer, over a third of the timeline at most
PLATES, PANEL = "the three plates", "panel and plots"
WATCH = """() => {
    window.times = {};
    const now = () => performance.timeOrigin + performance.now();
    addEventListener("pointermove", () => (times.moved = now()), true);
    const heard = () => {
        times.heard = now();
        requestAnimationFrame(() => requestAnimationFrame(() => (times.drawn = now())));
    };
    window.WebSocket = class extends WebSocket {
        constructor(...where) { super(...where); this.addEventListener("message", heard); }
    };
}"""


class Plates:
    """Listens to what the viewer of the plates is sent."""

    def __init__(self, program: Program) -> None:
        where = program.url.replace("http", "ws")
        self.heard_s = 0.0
        self._socket = connect(
            f"{where}viser/ws/{'s' * 22}",
            origin=Origin(program.url.rstrip("/")),
            subprotocols=[Subprotocol(PROTOCOL)],
            max_size=None,
        )
        self._socket.send(camera())  # a viewer draws for whoever has told it where it looks from
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        with contextlib.suppress(ConnectionClosed):
            for _ in self._socket:
                self.heard_s = time.time()


def make_run(program: Program, hours: float) -> None:
    """Run for so long, as fast as possible, with nobody looking."""
    until_tick, began_s = round(36_000 * hours), time.monotonic()
    program.command("set_speed", factor=0)
    program.command("resume")
    while (tick := program.state()["tick"]) < until_tick:
        time.sleep(min(5.0, max(0.05, (until_tick - tick) / 4000)))
    program.command("pause")
    print(f"{tick} ticks in {time.monotonic() - began_s:.0f} s", flush=True)


def wait_for_quiet(page: Page, plates: Plates) -> dict[str, float]:
    """Wait until nothing is sent any more. Returns the page's times, in seconds."""
    while True:
        times = {name: at / 1e3 for name, at in page.evaluate("() => times").items()}
        if time.time() - max(plates.heard_s, *times.values()) > QUIET_S:
            return times
        page.wait_for_timeout(50)


def drag(page: Page, plates: Plates, rng: random.Random) -> dict[str, float]:
    """Drag to a random moment, and say how long each part of the page took, in seconds."""
    box, share = box_of(page.locator("#timeline")), rng.uniform(0.01, 0.95)
    begin = min(0.95, max(0.01, share + rng.uniform(-0.3, 0.3)))
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + begin * box["width"], y)
    page.mouse.down()
    for move in range(1, MOVES + 1):
        page.mouse.move(box["x"] + (begin + (share - begin) * move / MOVES) * box["width"], y)
    times = wait_for_quiet(page, plates)
    page.mouse.up()
    return {PANEL: times["drawn"] - times["moved"], PLATES: plates.heard_s - times["moved"]}


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--hours", type=float, default=1.0, help="of simulated time (default 1)")
    parser.add_argument("--count", type=int, default=100, help="of moments (default 100)")
    parser.add_argument("--world", default="office")
    parser.add_argument("--draw", action="store_true", help="draw the plates, too")
    options = parser.parse_args()
    program, found = Program("--port", "0", "--paused", "--world", options.world), list[dict[str, float]]()
    try:
        make_run(program, options.hours)
        with (
            sync_playwright() as playwright,
            open_page(launch(playwright), program.url, stage=options.draw) as page,
        ):
            page.add_init_script(f"if (window === top) ({WATCH})()")
            page.reload()
            page.wait_for_selector("body[data-alive]")
            page.click("#tab-truth")
            plates, rng = Plates(program), random.Random(1)
            for _ in range(options.count):
                wait_for_quiet(page, plates)
                found.append(drag(page, plates, rng))
    finally:
        program.stop()
    bar_s, worst_s = BAR_S if options.hours <= LONG_HOURS else LONG_BAR_S, 0.0
    for name in (PANEL, PLATES):
        times = [one[name] for one in found]
        p95 = statistics.quantiles(times, n=20)[-1]
        worst_s = max(worst_s, p95)
        print(f"{name:20} median {statistics.median(times):.3f} s   p95 {p95:.3f} s   worst {max(times):.3f} s")
    print(f"p95 {worst_s:.2f} s, bar {bar_s:g} s: {verdict(worst_s <= bar_s)}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
