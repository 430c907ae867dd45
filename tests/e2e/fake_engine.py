"""A made-up session behind the real page, to develop the page with: `python -m tests.e2e.fake_engine [--port N]`.

Answers commands the way the engine would, on made-up snapshots; test material only, no part of the program.
"""

from __future__ import annotations

import argparse
import math
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace

import viser

from tests.fake_snapshots import fake_snapshot
from web.latest import Latest
from web.messages import Accepted, Command, Event, Pose, Refused, Request, Snapshot
from web.server import Dashboard


class FakeEngine(threading.Thread):
    """Publishes made-up snapshots at ten a second (times the speed) and takes commands between two of them."""

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

    def submit(self, command: Command) -> Future[Accepted | Refused]:
        request = Request(command, Future())
        self.requests.put(request)
        return request.answer

    def run(self) -> None:
        while True:
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
                self._note("kidnap", "moved by hand")
            case "reset":
                self.seed = self.seed if command.seed is None else command.seed
                self.tick, self.run_number, self.events = 1, self.run_number + 1, []
            case "set_parameter":
                return Refused("name", command.name, "there is no such setting")
        return Accepted(self.tick)

    def _note(self, kind: str, text: str) -> None:
        self.events.append(Event(10_000 + len(self.events), self.tick * 0.1, kind, text))

    def _snapshot(self) -> Snapshot:
        plain = fake_snapshot(self.tick, self.goal, run=self.run_number)
        where = Pose(plain.truth.x + self.offset[0], plain.truth.y + self.offset[1], plain.truth.heading_rad)
        events = tuple(sorted((*plain.events, *self.events), key=lambda event: event.number))
        speed = math.inf if self.speed == 0 else self.speed
        fields = {"running": self.running, "speed": speed, "seed": self.seed, "mode": self.mode}
        return replace(plain, truth=where, events=events, **fields)


class FakeStage:
    """A box where the stage will be."""

    def __init__(self) -> None:
        self.on_connect: Callable[[int], None] | None = None
        self.flights: list[tuple[int, str]] = []
        self.port = 0

    def start(self) -> None:
        self.server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        self.port = self.server.get_port()
        self.server.scene.add_box("/box")
        self.server.gui.add_slider("Something", 0.0, 1.0, 0.1, 0.5)
        self.server.on_client_connect(lambda client: self.on_connect and self.on_connect(client.client_id))
        self.set_theme("dark")

    def stop(self) -> None:
        self.server.stop()

    def fly(self, client_id: int, view: str) -> None:
        self.flights.append((client_id, view))

    def set_theme(self, theme: str) -> None:
        self.server.gui.configure_theme(dark_mode=theme == "dark")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--real-stage", action="store_true")
    parser.add_argument("--tick", type=int, default=1)
    options = parser.parse_args()
    engine = FakeEngine()
    engine.tick = options.tick
    stage = FakeStage()
    if options.real_stage:
        from web.stage.stage import Stage

        stage = Stage(engine.latest, engine.submit)
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
