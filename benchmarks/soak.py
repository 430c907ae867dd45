"""Hours at high speed with a browser open: `python -m benchmarks.soak --minutes 120 --speed 16`.

Every half minute it prints a row: the server's memory, threads and open files, the time of a tick, the size of the map.
Every few minutes it does what a person might do: a goal, other colours, a kidnap, another view, reloading the page. A
report comes at the end, or earlier after Ctrl+C. The soak fails if the engine faults or stands still, if the page
reports an error, or if threads or open files keep growing in number.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import random
import re
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Generator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import psutil
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, sync_playwright
from playwright.sync_api import Error as BrowserError
from websockets.sync.client import connect

from benchmarks.soak_report import HEAD, Row, judge
from tests.e2e.browser import launch
from tests.e2e.program import Program
from tests.patience import PATIENCE_S

TAKES = re.compile(r"A tick takes ([\d.]+)")
WORST = re.compile(r"worst ([\d.]+) ms")
FIRST_S = 1.0
TROUBLE = (BrowserError, OSError, TimeoutError, psutil.Error)


class Onlooker:
    """The page in a browser, with the tab Tick open. It keeps what goes wrong there."""

    def __init__(self, context: BrowserContext, url: str, complain: Callable[[str], None]) -> None:
        context.set_default_timeout(1000 * PATIENCE_S)
        self.page, self._complain = context.new_page(), complain
        self.page.on("console", self._heard)
        self.page.on("pageerror", lambda error: complain(f"the page failed: {error}"))
        self.page.on("crash", lambda _: complain("the page crashed"))
        self.page.goto(url)
        self._settle()

    def _heard(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self._complain(f"the page's console: {message.text}")

    def _settle(self) -> None:
        self.page.wait_for_selector("#stage.awake")
        self.page.wait_for_selector("body[data-alive]")
        self.page.get_by_role("tab", name="Tick", exact=True).click()
        self.page.get_by_text(TAKES).wait_for()

    def tick_ms(self) -> tuple[float, float]:
        """Mean time (ms) of the last hundred ticks, and the worst time of any part in them."""
        text = self.page.locator("body").inner_text()
        takes, worst = TAKES.search(text), WORST.findall(text)
        if takes is None or not worst:
            raise TimeoutError("the Tick tab does not say what a tick takes")
        return float(takes[1]), max(map(float, worst))

    def reload(self) -> None:
        self.page.reload()
        self._settle()


class Soak:
    """One program, one browser, and the rows."""

    def __init__(self, program: Program, onlooker: Onlooker, chance: random.Random) -> None:
        self.rows: list[Row] = []
        self._program, self._onlooker, self._chance = program, onlooker, chance
        self._server = psutil.Process(program.process.pid)
        program.wait(lambda state: state["tick"] > 100)  # all is compiled and loaded
        self._began, self._before = time.monotonic(), self._clocks()
        page = onlooker.page
        self._doings: tuple[tuple[str, Callable[[], object]], ...] = (
            ("a goal", self._go_somewhere),
            ("other colours", lambda: page.click("#theme")),
            ("on exploring", lambda: program.command("set_mode", mode="explore")),
            ("a kidnap", lambda: page.click("#kidnap")),
            ("another view", lambda: page.click(f"[data-view={chance.choice(('all', 'office', 'pose', 'map'))}]")),
            ("the page anew", onlooker.reload),
        )

    @property
    def alive(self) -> bool:
        return self._program.process.poll() is None

    def wait(self, seconds: float, came: list[int]) -> None:
        """Wait, and keep what the page reports meanwhile."""
        end = time.monotonic() + seconds
        while not came and self.alive and (left := end - time.monotonic()) > 0:
            try:
                self._onlooker.page.wait_for_timeout(1000 * min(0.25, left))
            except BrowserError:  # it has gone
                time.sleep(min(0.25, left))

    def act(self, turn: int) -> None:
        name, do = self._doings[turn % len(self._doings)]
        print(f"       {name}", flush=True)
        do()

    def look(self) -> Row:
        """Take and print the next row."""
        message = stream_message(self._program)
        state, page = message["state"], message["page"]
        now = (time.monotonic(), self._cpu_s(), state["time_s"], state["tick"])
        wall_s, cpu_s, simulated_s, ticks = (a - b for a, b in zip(now, self._before, strict=True))
        self._before = now
        mean_ms, worst_ms = None, None
        with contextlib.suppress(*TROUBLE):
            mean_ms, worst_ms = self._onlooker.tick_ms()
        row = Row(
            minute=(now[0] - self._began) / 60, time_s=state["time_s"], tick=state["tick"],
            factor=simulated_s / wall_s, tick_ms=mean_ms, worst_ms=worst_ms, cpu_ms=1e3 * cpu_s / max(ticks, 1),
            memory_mb=self._server.memory_info().rss / 1e6, browser_mb=browser_mb(self._server.pid),
            threads=self._server.num_threads(), files=self._server.num_fds(),
            views=state["views"], experiences=state["experiences"], links=state["links"],
            map_error_m=state["error_m"]["map"], odometry_error_m=state["error_m"]["odometry"],
            doing=page["doing"], fault=page["fault"],
        )  # fmt: skip
        self.rows.append(row)
        print(row, flush=True)
        return row

    def _clocks(self) -> tuple[float, float, float, int]:
        state = self._program.state()
        return time.monotonic(), self._cpu_s(), state["time_s"], state["tick"]

    def _cpu_s(self) -> float:
        times = self._server.cpu_times()
        return times.user + times.system

    def _go_somewhere(self) -> None:
        x, y = self._chance.choice(self._program.state(full=True)["map"]["xy"])
        self._program.command("set_goal", x=x, y=y)


def stream_message(program: Program) -> dict[str, Any]:
    """The newest state as pages get it, with the pilot's behaviour and the fault, if there is one."""
    address = f"127.0.0.1:{program.port}"
    with connect(f"ws://{address}/api/stream?page={'s' * 22}", origin=f"http://{address}") as socket:  # type: ignore[arg-type]
        while True:
            message = json.loads(socket.recv(timeout=PATIENCE_S))
            if message["type"] == "state":
                return message


def browser_mb(server: int) -> float:
    """Memory (MB) of all processes below this one, except the server."""
    total = 0
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            total += process.memory_info().rss if process.pid != server else 0
    return total / 1e6


@contextlib.contextmanager
def ended_by_signal() -> Generator[list[int], None, None]:
    """The signals that have come. They are looked at between two pieces of work, so that each piece is completed."""
    came: list[int] = []
    before = {number: signal.signal(number, lambda n, _: came.append(n)) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def soak(options: argparse.Namespace, troubles: Counter[str], came: list[int]) -> list[Row]:
    """Collect rows until the time is over, a signal has come, or the program has ended."""

    def complain(words: str) -> None:
        if not came:  # Ctrl+C reaches the browser, too
            troubles[words.strip()] += 1
            print(f"       ! {words.strip()}", flush=True)

    rows: list[Row] = []
    arguments = ("--port", "0", "--world", options.world, "--seed", str(options.seed), "--speed", str(options.speed))
    with tempfile.TemporaryDirectory() as home, sync_playwright() as playwright:
        program = Program(*arguments, HOME=home)
        try:
            with watching(launch(playwright), program.url, complain) as onlooker:
                run = Soak(program, onlooker, random.Random(options.seed))
                rows = run.rows
                print(HEAD, flush=True)
                until_over(run, options, came, complain)
        except (*TROUBLE, AssertionError) as error:
            complain(f"{type(error).__name__}: {error}")
        finally:
            code = program.stop()
            if code != 0:
                complain(f"the program ended with code {code}:\n{''.join(program.said[-30:])}")
    return rows


@contextlib.contextmanager
def watching(browser: Browser, url: str, complain: Callable[[str], None]) -> Generator[Onlooker, None, None]:
    """A page that is closed before the program ends, so that a lost connection is not counted as an error."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    context.add_init_script("localStorage.level = 'lab'")
    try:
        yield Onlooker(context, url, complain)
    finally:
        with contextlib.suppress(BrowserError):  # it has gone, after Ctrl+C
            context.close()


def until_over(run: Soak, options: argparse.Namespace, came: list[int], complain: Callable[[str], None]) -> None:
    """Go on after a single failure, but stop if the program has ended."""

    def attempt(work: Callable[[], object]) -> None:
        try:
            work()
        except TROUBLE as error:
            complain(f"{type(error).__name__}: {error}")

    began, turn = time.monotonic(), 0
    run.wait(FIRST_S, came)
    attempt(run.look)  # however soon it ends, there is something to compare with
    while not came and run.alive:
        left_s = 60 * options.minutes - (time.monotonic() - began)
        if left_s <= 0:
            return
        run.wait(min(options.every, left_s), came)
        attempt(run.look)
        if time.monotonic() - began >= 60 * options.act_every * (turn + 1):
            attempt(lambda now=turn: run.act(now))
            turn += 1


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--minutes", type=float, default=120.0)
    parser.add_argument("--speed", type=float, default=16.0, help="simulated seconds a second, 0 = as fast as possible")
    parser.add_argument("--world", default="office", help="a name or a file, as `ratslam run --world` takes it")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--every", type=float, default=30.0, help="seconds between two rows")
    parser.add_argument("--act-every", type=float, default=3.0, help="minutes between two things that a person does")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write rows and findings there, too")
    options = parser.parse_args()
    troubles: Counter[str] = Counter()
    with ended_by_signal() as came:
        rows = soak(options, troubles, came)
    findings = judge(rows, [f"{count} x {words}" for words, count in troubles.items()])
    print(*findings.lines, *(f"WRONG: {words}" for words in findings.wrong), sep="\n")
    print("MISSED" if findings.wrong else "met")
    if options.json is not None:
        report = {"rows": [asdict(row) for row in rows], "findings": findings.lines, "wrong": findings.wrong}
        options.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    if came:
        return 128 + came[0]
    return bool(findings.wrong)


if __name__ == "__main__":
    raise SystemExit(main())
