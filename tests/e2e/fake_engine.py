"""A made-up session behind the real page, to develop the page with: `python -m tests.e2e.fake_engine [--port N]`.

It answers commands the way the engine would, with made-up snapshots. Test material only, not a part of the program.
"""

from __future__ import annotations

import argparse
import contextlib
import math
import queue
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S
from web.http.server import Dashboard
from web.latest import Latest
from web.messages import Accepted, Command, Event, Pose, Refused, Request, Snapshot
from web.switches import Switches
from web.themes import Theme
from web.viewer.camera_views import Camera
from web.viewer.viser_server import guarded_server

BOXES = 50  # `WHOLE` of viser_client.js, and some more


class FakeEngine(threading.Thread):
    """Publishes ten made-up snapshots a second (times the speed), and takes commands between two of them."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.latest: Latest[Snapshot] = Latest()
        self.requests: queue.Queue[Request] = queue.Queue()
        self.tick, self.run_number, self.seed = 1, 1, 7
        self.running, self.speed, self.goal, self.mode = True, 1.0, True, "explore"
        self.offset = (0.0, 0.0)  # where driving and kidnapping have brought the robot
        self.drive_until_s = 0.0
        self.drive = (0.0, 0.0)
        self.events: list[Event] = []
        self.shown: dict[str, Any] = {}  # fields of the snapshot that a test has chosen
        self.viewer = FakeViewer()
        self.over = threading.Event()

    def submit(self, command: Command) -> Future[Accepted | Refused]:
        request = Request(command, Future())
        self.requests.put(request)
        return request.answer

    def run(self) -> None:
        while not self.over.is_set():
            while not self.requests.empty():
                request = self.requests.get()
                request.answer.set_result(self._take(request.command))
            if time.monotonic() > self.drive_until_s:
                self.drive = (0.0, 0.0)
            self.offset = (self.offset[0] + 0.1 * self.drive[0], self.offset[1] + 0.1 * self.drive[1])
            self.tick += 1 if self.running else 0
            self.latest.put(self._snapshot())
            time.sleep(0.1 / max(0.25, min(self.speed or 16.0, 16.0)))

    def _take(self, command: Command) -> Accepted | Refused:
        match command.type:
            case "pause" | "resume":
                self.running = command.type == "resume"
            case "step":
                self.running, self.tick = False, self.tick + command.ticks
            case "set_speed":
                self.speed = command.factor
            case "set_mode":
                self.mode = command.mode
            case "drive":
                self.mode, self.drive = "manual", (command.speed, command.yaw_rate)
                self.drive_until_s = time.monotonic() + 0.3
            case "cancel_goal" | "set_goal":
                self.goal = command.type == "set_goal"
            case "kidnap":
                if command.x is not None and abs(command.x) > 50:
                    return Refused("x", command.x, "there is no free floor there")
                self.offset = (self.offset[0] + 0.5, self.offset[1])
                self.note("kidnap", "moved by hand")
            case "reset":
                self.seed = self.seed if command.seed is None else command.seed
                self.tick, self.run_number, self.events = 1, self.run_number + 1, []
            case "set_parameter":
                return Refused("name", command.name, "there is no such setting")
        return Accepted(self.tick)

    def note(self, kind: str, text: str) -> None:
        self.events.append(Event(10_000 + len(self.events), self.tick * 0.1, kind, text))

    def _snapshot(self) -> Snapshot:
        plain = fake_snapshot(self.tick, self.goal, run=self.run_number)
        where = Pose(plain.truth.x + self.offset[0], plain.truth.y + self.offset[1], plain.truth.heading_rad)
        events = tuple(sorted((*plain.events, *self.events), key=lambda event: event.number))
        speed = math.inf if self.speed == 0 else self.speed
        fields = {"truth": where, "events": events, "seed": self.seed, "mode": self.mode}
        return replace(plain, **{**fields, "running": self.running, "speed": speed, **self.shown})


class FakeViewer:
    """Boxes in place of the plates, dark for everybody: as many as the page needs to see for a whole frame."""

    def __init__(self) -> None:
        self.on_connect: Callable[[int], None] | None = None
        self.on_complaint: Callable[[int, str], None] | None = None
        self.flights: list[tuple[int, str]] = []
        self.followed: list[tuple[int, bool]] = []
        self.replayed: list[int] = []
        self.port, self.secret, self.switches = 0, "", Switches()

    def start(self) -> None:
        self.server, self.secret = guarded_server()
        self.port = self.server.get_port()
        for k in range(BOXES):
            self.server.scene.add_box(f"/box/{k}", dimensions=(0.02, 0.02, 0.02), position=(0.05 * k, 0.0, 0.0))
        self.server.on_client_connect(lambda client: self.on_connect and self.on_connect(client.client_id))
        self.server.gui.configure_theme(dark_mode=True)

    def stop(self) -> None:
        self.server.stop()

    def fly(self, client_id: int, view: str, at_once: bool = False, turned: Camera | None = None) -> None:  # noqa: ARG002
        self.flights.append((client_id, view))

    def follow(self, client_id: int, on: bool) -> None:
        self.followed.append((client_id, on))

    def replay(self, event: int) -> None:
        self.replayed.append(event)

    def press(self, _client_id: int, _at: object, _inspecting: bool, tell: Callable[[str | None], None]) -> None:
        tell(None)

    def hover(self, _client_id: int, _at: object, tell: Callable[[str], None]) -> None:
        tell("")

    def turned(self, _client_id: int) -> Camera | None:
        return None

    def of(self, _theme: Theme, _large: bool = False, _still: bool = False) -> FakeViewer:
        return self


@contextlib.contextmanager
def fake_program() -> Iterator[tuple[FakeEngine, str]]:
    """The engine and the address of its page, for as long as a test wants it."""
    engine, ready, urls = FakeEngine(), threading.Event(), []
    dashboard = Dashboard(
        engine.latest, engine.submit, engine.viewer, port=0, on_ready=lambda url: (urls.append(url), ready.set())
    )
    server = threading.Thread(target=dashboard.run)
    engine.start()
    server.start()
    try:
        assert ready.wait(PATIENCE_S)
        yield engine, urls[0]
    finally:
        dashboard.stop()
        engine.over.set()
        for thread in (server, engine):
            thread.join()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--real-stage", action="store_true", help="viser draws the plates, not boxes")
    parser.add_argument("--tick", type=int, default=1)
    options = parser.parse_args()
    engine = FakeEngine()
    engine.tick = options.tick
    stage = FakeViewer()
    if options.real_stage:
        from web.viewer.viewer import Viewers

        stage = Viewers(engine.latest, engine.submit)
    engine.start()
    ready = "RatSLAM is alive at {}"
    Dashboard(
        engine.latest,
        engine.submit,
        stage,
        port=options.port,
        on_ready=lambda url: print(ready.format(url), flush=True),
    ).run()


if __name__ == "__main__":
    main()
