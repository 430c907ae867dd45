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
import numpy as np
import psutil
import zstandard
from playwright.sync_api import Page, sync_playwright

from app.config import Config
from app.engine_thread import EngineThread
from benchmarks.machine import verdict
from sim2d import load_world
from tests.e2e.browser import launch, open_page
from tests.e2e.program import Program
from web.http.state import StateText
from web.http.stream import PERIOD_S
from web.messages import CompareBrains, Pause, Resume, SetGoal, SetMode, SetSpeed
from web.panel.panel import TABS, Panel, PanelReader
from web.switches import Switches
from web.viewer import Viewer

BARS_KB = {"exploring": 180.0, "to a goal": 300.0, "standing still": 80.0, "paused": 1.0}  # per second, all together
LARGE_KB = 300.0  # what viser may send a second in any of these, with 5,000 experiences or two brains
FRAME_MS, HZ = 8.0, 60  # what the page's own script may take of 99 in 100 frames, and how many there are a second
MOST_US = 5000  # a longer gap between two samples is the machine's other work, not ours
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
    parser.add_argument("--world", default="office")
    parser.add_argument(
        "--experiences", type=int, default=0, help="explore until the map has as many; held to another bar"
    )
    parser.add_argument("--two", action="store_true", help="two brains from then on; held to viser's bar")
    parser.add_argument("--only", choices=("traffic", "frames"), help="one of the two; traffic needs no browser")
    parser.add_argument("--picture", help="a PNG of the page at the end")
    options = parser.parse_args()
    met = options.only == "frames" or traffic(
        options.world, options.seconds, options.after, options.experiences, two=options.two
    )
    if options.only != "traffic":
        quick = frames(options.world, options.seconds, options.after, options.picture, options.experiences)
        print(f"the page's own script: {verdict(quick)}")
    print(f"traffic: {verdict(met)}")
    return 0


def traffic(world: str, seconds: float, after_s: float, experiences: int, *, two: bool = False) -> bool:
    """Bytes per second while the robot explores, goes to a goal, stands still, and while the session is paused."""
    engine = EngineThread(load_world(world), 5, _growing() if experiences else Config(), speed=0.0)
    page = _Page(engine)
    engine.start()
    met = True
    try:
        page.look(
            lambda: (
                (shown := engine.latest.get()[1]) is None or shown.time_s < after_s or shown.experiences < experiences
            )
        )
        engine.submit(SetSpeed(type="set_speed", factor=1.0)).result()
        if two:
            engine.submit(CompareBrains(type="compare_brains", pair="vision", since="now")).result()
        for phase, bar_kb in BARS_KB.items():
            if phase == "to a goal":
                engine.submit(_farthest(engine)).result()
            if phase == "standing still":
                engine.submit(SetMode(type="set_mode", mode="manual")).result()
            engine.submit(Pause(type="pause") if phase == "paused" else Resume(type="resume")).result()
            page.look_for(2.0)
            page.heard.clear()
            page.look_for(seconds)
            total, stage = _tell(phase, page.heard, seconds)
            met &= stage <= LARGE_KB if experiences or two else total <= bar_kb
    finally:
        engine.stop()
        page.viewer.stop()
    return met


def _growing() -> Config:
    """Known ground goes on to get experiences, so that there are many soon."""
    return Config().with_value("experience_map.familiar_ground", False)


def _farthest(engine: EngineThread) -> SetGoal:
    shown = engine.latest.get()[1]
    assert shown is not None
    x, y = shown.map.xy[np.hypot(*(shown.map.xy - (shown.estimate.x, shown.estimate.y)).T).argmax()].tolist()
    return SetGoal(type="set_goal", x=x, y=y)


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


def _tell(phase: str, heard: list[Counter[str]], seconds: float) -> tuple[float, float]:
    """Kilobytes a second: of all, and of what viser sends."""
    parts: Counter[str] = Counter()
    for message in heard:
        parts += message
    total = parts.total() / seconds / 1000
    stage = total - sum(size for kind, size in parts.items() if kind.startswith("the ")) / seconds / 1000
    print(f"{phase}: {total:.1f} kB/s, {stage:.1f} of them viser's, {len(heard) / seconds:.0f} messages/s")
    for kind, size in parts.most_common(LINES):
        print(f"  {size / seconds / 1000:7.2f} kB/s  {kind}")
    return total, stage


def _parts_of(message: Any) -> Counter[str]:
    """Bytes by node and property, as viser sends them: arrays as they are, the rest compressed."""
    updates = getattr(message, "updates", None) or {"": message}
    about = getattr(message, "name", None) or getattr(message, "uuid", "")
    arrays: list[memoryview] = []
    told = message.as_serializable_dict(arrays)
    packed = len(zstandard.ZstdCompressor(level=1).compress(msgspec.msgpack.encode(told)))
    return Counter({f"{type(message).__name__} {about} {' '.join(updates)}": packed + sum(a.nbytes for a in arrays)})


def frames(world: str, seconds: float, after_s: float, picture: str | None, experiences: int) -> bool:
    """Frames per second, the processor time and draw calls of one frame, and the page's own script, while the robot explores.
    Whether the script keeps to its bar in every tab."""
    more = ("--set", "experience_map.familiar_ground=false") if experiences else ()
    program = Program("--port", "0", "--seed", "5", "--speed", "0", "--world", world, *more)
    met = True
    try:
        _await_first_tick(program)
        while (state := program.state())["time_s"] < after_s or state["experiences"] < experiences:
            time.sleep(0.5)
        program.command("set_speed", factor=1)
        with sync_playwright() as playwright, open_page(launch(playwright), program.url) as page:
            page.wait_for_timeout(8000)
            _measure(page, seconds)
            for tab in TABS:
                page.get_by_role("tab", name=tab, exact=True).click()
                page.wait_for_timeout(2000)
                met &= _measure_script(page, tab, seconds / 2) <= FRAME_MS
            program.command("pause")
            if picture:
                page.wait_for_timeout(4000)
                page.screenshot(path=picture)
    finally:
        program.stop()
    return met


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


def _measure_script(page: Page, tab: str, seconds: float) -> float:
    """Milliseconds spent in functions of web/static, by the profiler's samples: a second, and in 99 of 100 frames at most."""
    session: Any = page.context.new_cdp_session(page)
    for order in ("Profiler.enable", "Profiler.start"):
        session.send(order)
    page.wait_for_timeout(seconds * 1000)
    profile = session.send("Profiler.stop")["profile"]
    session.detach()
    own = {node["id"] for node in profile["nodes"] if "/static/" in node["callFrame"]["url"]}
    took_us = np.array(profile["timeDeltas"], np.float64)
    ours = np.array([sample in own for sample in profile["samples"]]) * np.minimum(took_us, MOST_US)
    frame = ((np.cumsum(took_us) - took_us[0]) / 1e6 * HZ).astype(np.int64)
    each_ms = np.bincount(np.maximum(frame, 0), weights=ours) / 1000
    worst = float(np.percentile(each_ms, 99))
    print(
        f"{tab}: {ours.sum() / 1000 / seconds:.1f} ms of the page's own script a second, {worst:.1f} ms in a frame at most"
    )
    return worst


if __name__ == "__main__":
    raise SystemExit(main())
