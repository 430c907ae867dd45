"""Same seed, same run: without a server, and through the server at x1 with someone watching."""

from __future__ import annotations

import threading

import httpx2
import pytest

from app.config import Config
from app.engine_thread import EngineThread
from app.session import Session
from sim2d import load_world
from tests.patience import PATIENCE_S, until
from web.http.server import Dashboard
from web.viewer import Viewers

SEED = 77
KIDNAPPED_AT = 60


def test_the_server_at_real_time_gives_the_headless_state(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("web.http.asking.ANSWER_TIMEOUT_S", PATIENCE_S)  # the engine may have to compile itself first
    engine = EngineThread(load_world(), SEED, Config(), speed=1.0, running=False)
    viewers = Viewers(engine.latest, engine.submit)
    ready = threading.Event()
    dashboard = Dashboard(engine.latest, engine.submit, viewers, port=0, on_ready=lambda _url: ready.set())
    dashboard.bind()
    engine.start()
    serving = threading.Thread(target=dashboard.run)
    serving.start()
    try:
        assert ready.wait(PATIENCE_S)
        with httpx2.Client(base_url=dashboard.url.rstrip("/"), timeout=PATIENCE_S) as client:

            def order(**command: object) -> int:
                answer = client.post("/api/commands", json=command)
                assert answer.status_code == 200, answer.text
                return answer.json()["tick"]

            def watch_until(tick: int) -> None:
                until(lambda: client.get("/api/state?map=1").json()["tick"] >= tick, f"tick {tick}")

            assert order(type="step", ticks=KIDNAPPED_AT) == KIDNAPPED_AT
            order(type="kidnap", x=5.0, y=4.5, heading_rad=1.0)
            order(type="resume")
            watch_until(KIDNAPPED_AT + 80)
            ticks = order(type="pause")
            reached = engine.session.state_hash()
    finally:
        dashboard.stop()
        serving.join(PATIENCE_S)
        engine.stop()
    assert not serving.is_alive()

    headless = Session(load_world(), SEED)
    for tick in range(ticks):
        if tick == KIDNAPPED_AT:
            headless.kidnap(5.0, 4.5, 1.0)
        headless.tick()
    assert headless.state_hash() == reached
