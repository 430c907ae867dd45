"""Same seed, same run: without a server, and through the server at x1 with someone watching."""

from __future__ import annotations

import threading
import time

import httpx2

from app.config import Config
from app.runner import Runner
from app.session import Session
from sim2d import load_world
from web.server import Dashboard
from web.stage import Stage

SEED = 77
KIDNAPPED_AT = 60


def test_the_server_at_real_time_gives_the_headless_state() -> None:
    runner = Runner(load_world(), SEED, Config(), speed=1.0, running=False)
    stage = Stage(runner.latest, runner.submit)
    ready = threading.Event()
    dashboard = Dashboard(runner.latest, runner.submit, stage, port=0, on_ready=lambda _url: ready.set())
    dashboard.bind()
    runner.start()
    serving = threading.Thread(target=dashboard.run)
    serving.start()
    try:
        assert ready.wait(30)
        with httpx2.Client(base_url=dashboard.url.rstrip("/")) as client:

            def order(**command: object) -> int:
                answer = client.post("/api/commands", json=command)
                assert answer.status_code == 200, answer.text
                return answer.json()["tick"]

            def watch_until(tick: int) -> None:
                deadline = time.monotonic() + 60
                while client.get("/api/state?map=1").json()["tick"] < tick:
                    assert time.monotonic() < deadline
                    time.sleep(0.1)

            assert order(type="step", ticks=KIDNAPPED_AT) == KIDNAPPED_AT
            order(type="kidnap", x=5.0, y=4.5, heading_rad=1.0)
            order(type="resume")
            watch_until(KIDNAPPED_AT + 80)
            ticks = order(type="pause")
            reached = runner.session.state_hash()
    finally:
        dashboard.stop()
        serving.join(10)
        runner.stop()
    assert not serving.is_alive()

    headless = Session(load_world(), SEED)
    for tick in range(ticks):
        if tick == KIDNAPPED_AT:
            headless.kidnap(5.0, 4.5, 1.0)
        headless.tick()
    assert headless.state_hash() == reached
