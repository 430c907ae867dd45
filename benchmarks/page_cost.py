"""What the page costs at x1, `python -m benchmarks.page_cost`: the traffic to it, by node and part, its script, and a
frame.

Traffic is counted where it is handed over, without a browser, so that a busy machine does not reduce it: what viser
sends for the plates, the state, and what the open tab of the panel is sent. The page's own script is the code in
web/static, measured by samples of the browser's profiler; viser's drawing comes on top. Frames are drawn in software,
and the cost of a frame is the processor time of the browser's drawing; with a graphics card there is none.
"""

# What viser would send is counted where viser keeps it to itself.
# pyright: reportPrivateUsage=false

from __future__ import annotations

import argparse
import contextlib
import time
from collections import Counter
from collections.abc import Callable
from typing import Any
from urllib.error import HTTPError

import msgspec
import psutil
import zstandard
from playwright.sync_api import Page, sync_playwright

from app.config import Config
from app.engine_thread import EngineThread
from sim2d import load_world
from tests.e2e.browser import launch, open_page
from tests.e2e.program import Program
from web.http.state import StateText
from web.http.stream import PERIOD_S
from web.messages import Pause, Resume, SetMode, SetSpeed
from web.panel.panel import TABS, Panel, PanelReader
from web.switches import Switches
from web.viewer import Viewer

BARS_KB = {"exploring": 180.0, "standing still": 80.0, "paused": 1.0}  # per second, with the tab Senses open
LINES = 12
COUNT_FRAMES = """() => {
    const kind = WebGL2RenderingContext.prototype;
    const made = window.drawn = { calls: 0, frames: 0, now: 0 };
    for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
        const draw = kind[name];
        kind[name] = function (...rest) { made.calls += 1; return draw.apply(this, rest); };
    }
    const look = () => {
        if (made.calls > made.now) made.frames += 1;
        made.now = made.calls;
        requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
}"""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--after", type=float, default=300.0, help="simulated seconds to explore before")
    parser.add_argument("--only", choices=("traffic", "frames"), help="one of the two; traffic needs no browser")
    parser.add_argument("--picture", help="a PNG of the page at the end")
    options = parser.parse_args()
    met = options.only == "frames" or traffic(options.seconds, options.after)
    if options.only != "traffic":
        frames(options.seconds, options.after, options.picture)
    print("met" if met else "MISSED")
    return not met


def traffic(seconds: float, after_s: float) -> bool:
    """Bytes per second while the robot explores, while it stands still, and while the session is paused."""
    engine = EngineThread(load_world("office"), 5, Config(), speed=0.0)
    page = _Page(engine)
    engine.start()
    met = True
    try:
        page.look(lambda: _time_s(engine) < after_s)
        engine.submit(SetSpeed(type="set_speed", factor=1.0)).result()
        for phase, bar_kb in BARS_KB.items():
            if phase == "standing still":
                engine.submit(SetMode(type="set_mode", mode="manual")).result()
            engine.submit(Pause(type="pause") if phase == "paused" else Resume(type="resume")).result()
            page.look_for(2.0)
            page.heard.clear()
            page.look_for(seconds)
            met &= _tell(phase, page.heard, seconds) <= bar_kb
    finally:
        engine.stop()
        page.viewer.stop()
    return met


def _time_s(engine: EngineThread) -> float:
    snapshot = engine.latest.get()[1]
    return 0.0 if snapshot is None else snapshot.time_s


class _Page:
    """Runs viewer and stream as their own threads would, for somebody who has just opened the page."""

    def __init__(self, engine: EngineThread) -> None:
        switches = Switches()
        self.heard: list[Counter[str]] = []
        self.viewer = Viewer(engine.latest, engine.submit, switches)
        self.viewer.server._websock_server.queue_message = lambda message: self.heard.append(_parts_of(message))
        self._latest, self._panel, self._text = engine.latest, Panel(switches), StateText()
        self._reader = PanelReader(self._panel)
        self._reader.tabs = ("Senses",)

    def look_for(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        self.look(lambda: time.monotonic() < end)

    def look(self, going_on: Callable[[], bool]) -> None:
        seen = 0
        while going_on():
            before, (seen, snapshot) = seen, self._latest.wait(seen, PERIOD_S)
            self.viewer.tick(snapshot, time.monotonic())
            if snapshot is None:
                continue
            if seen != before:
                self._panel.remember(snapshot)
                state = len(self._text.light(snapshot)) + len(self._text.page(snapshot))
                self.heard.append(Counter({"the page's state": state}))
            for message in self._reader.news(snapshot, time.monotonic()):
                size = len(message) if isinstance(message, bytes) else len(message.encode())
                self.heard.append(Counter({"the panel's tab": size}))


def _tell(phase: str, heard: list[Counter[str]], seconds: float) -> float:
    parts: Counter[str] = Counter()
    for message in heard:
        parts += message
    total = parts.total() / seconds / 1000
    print(f"{phase}: {total:.1f} kB/s, {len(heard) / seconds:.0f} messages/s")
    for kind, size in parts.most_common(LINES):
        print(f"  {size / seconds / 1000:7.2f} kB/s  {kind}")
    return total


def _parts_of(message: Any) -> Counter[str]:
    """Bytes by node and property, as viser sends them: arrays as they are, the rest compressed."""
    updates = getattr(message, "updates", None) or {"": message}
    about = getattr(message, "name", None) or getattr(message, "uuid", "")
    arrays: list[memoryview] = []
    told = message.as_serializable_dict(arrays)
    packed = len(zstandard.ZstdCompressor(level=1).compress(msgspec.msgpack.encode(told)))
    return Counter({f"{type(message).__name__} {about} {' '.join(updates)}": packed + sum(a.nbytes for a in arrays)})


def frames(seconds: float, after_s: float, picture: str | None) -> None:
    """Frames per second, and the processor time and draw calls of one frame, while the robot explores."""
    program = Program("--port", "0", "--seed", "5", "--speed", "0")
    try:
        _await_first_tick(program)
        program.wait(lambda state: state["time_s"] >= after_s)
        program.command("set_speed", factor=1)
        with sync_playwright() as playwright, open_page(launch(playwright), program.url) as page:
            page.wait_for_timeout(8000)
            _measure(page, seconds)
            for tab in TABS:
                page.get_by_role("tab", name=tab, exact=True).click()
                page.wait_for_timeout(2000)
                _measure_script(page, tab, seconds / 2)
            program.command("pause")
            if picture:
                page.wait_for_timeout(4000)
                page.screenshot(path=picture)
    finally:
        program.stop()


def _await_first_tick(program: Program) -> None:
    """The engine may have to be compiled first."""
    while True:
        with contextlib.suppress(HTTPError):
            program.state()
            return
        time.sleep(0.2)


def _measure(page: Page, seconds: float) -> None:
    artist = next(
        child for child in psutil.Process().children(recursive=True) if "--type=gpu" in " ".join(child.cmdline())
    )
    stage = page.frames[1]
    stage.evaluate(COUNT_FRAMES)
    before = sum(artist.cpu_times()[:2])
    page.wait_for_timeout(seconds * 1000)
    drawn, spent = stage.evaluate("() => window.drawn"), sum(artist.cpu_times()[:2]) - before
    count = max(drawn["frames"], 1)
    each = f"{1000 * spent / count:.0f} ms of processor and {drawn['calls'] / count:.0f} draw calls each"
    print(f"{drawn['frames'] / seconds:.1f} frames a second, {each}")


def _measure_script(page: Page, tab: str, seconds: float) -> None:
    """Milliseconds per second spent in functions of web/static, by the profiler's samples."""
    session: Any = page.context.new_cdp_session(page)
    for order in ("Profiler.enable", "Profiler.start"):
        session.send(order)
    page.wait_for_timeout(seconds * 1000)
    profile = session.send("Profiler.stop")["profile"]
    session.detach()
    own = {node["id"] for node in profile["nodes"] if "/static/" in node["callFrame"]["url"]}
    spent_us = sum(t for sample, t in zip(profile["samples"], profile["timeDeltas"], strict=True) if sample in own)
    print(f"{tab}: {spent_us / 1000 / seconds:.1f} ms of the page's own script a second")


if __name__ == "__main__":
    raise SystemExit(main())
