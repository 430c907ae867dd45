"""One run of a minute, with everything in it that a robot can be told. Its hash is the same whatever runs it."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import httpx2
import pytest
from websockets.sync.client import connect

from app.config import Config
from app.engine_thread import EngineThread
from app.orders import Order
from app.run_record.header import beginning_of, header_of
from app.run_record.link import file_of, link_of, read_situation
from app.run_record.reader import open_run
from app.run_record.resume import replayed
from app.run_record.situation import Situation
from app.run_record.writer import RunKeeper
from app.session import Session
from app.session_snapshot import load_session, save_session
from app.views.history import History
from app.views.inspection import inspect
from app.views.office import movements_of
from app.views.snapshots import Snapshots
from app.views.tick_stages import TickRecorder
from app.world_editor import edited
from sim2d import load_world
from tests.patience import PATIENCE_S, until
from tests.unit.app.engines import READER, an_engine, tell
from web.http.server import Dashboard
from web.messages import EditStep, Inspect
from web.viewer import Viewers

SEED, TICKS = 11, 600
BOX = {"name": "crate", "x": 5.0, "y": 1.0, "width": 0.4, "depth": 0.4, "height": 0.5}
ORDERS: dict[int, dict[str, Any]] = {
    60: {"type": "kidnap", "x": 8.4, "y": 6.4, "heading_rad": 1.0},
    120: {"type": "set_parameter", "name": "pilot.cruise_speed", "value": 0.33},
    180: {"type": "set_door", "name": "laboratory door", "open": False},
    240: {"type": "tag", "name": "here"},
    300: {"type": "set_goal", "x": 0.0, "y": 0.0},
    400: {"type": "edit_world", "steps": [{"do": "add", "list": "boxes", "item": BOX}]},
}


def play(
    step: Callable[[int], object], order: Callable[[dict[str, Any]], object], since: int = 0, to: int = TICKS
) -> None:
    """Run its ticks from this one on, with the orders between them."""
    for tick, told in ORDERS.items():
        if since <= tick < to:
            step(tick - since)
            order(told)
            since = tick
    step(to - since)


def order_session(session: Session, told: dict[str, Any]) -> None:
    """Without a page, an engine or a thread."""
    match told:
        case {"type": "set_door", "name": name, "open": is_open}:
            session.set_door(name, is_open)
        case {"type": "edit_world", "steps": steps}:
            session.edit_world(edited(session.simulator.world, map(EditStep.model_validate, steps)))
        case {"type": name, **values}:
            getattr(session, name)(**values)


def play_session(session: Session, watch: Callable[[Session], object] = lambda _: None, to: int = TICKS) -> None:
    def step(ticks: int) -> None:
        for _ in range(ticks):
            session.tick()
            watch(session)

    play(step, lambda told: order_session(session, told), session.tick_count, to)


def directly(ticks: int = TICKS) -> str:
    session = Session(load_world("living"), SEED)
    play_session(session, to=ticks)
    return session.state_hash()


@pytest.fixture(scope="module")
def expected() -> str:
    return directly()


def test_looked_at_by_all_that_explains_it(expected: str) -> None:
    """Stage by stage, with its snapshots and what they draw later, every inspection, every movement, every reason."""
    session = Session(load_world("living"), SEED)
    history = History(session)
    snapshots = Snapshots(session, history, 1, ())

    def look() -> None:
        shown = snapshots.build(running=True, speed=1.0, real_time_factor=1.0, fault=None)
        if shown.occupancy is not None:
            shown.occupancy.draw_map()
        if (movements := movements_of(session)) is not None:
            movements()
        for wish in ({"experience": 0}, {"view": 0}, {"x": 5, "y": 5}):
            inspect(session, history.visits, history.events.reasons, Inspect(type="inspect", **wish))

    def step(ticks: int) -> None:
        for _ in range(ticks):
            recorder = TickRecorder(session, snapshots.parts())
            session.tick(recorder)
            snapshots.refresh()
            recorder.walk(snapshots.parts())
            history.watch()
            look()

    play(step, lambda told: order_session(session, told))
    for event in history.log.why:
        history.events.reasons.of(event)
    assert session.state_hash() == expected


def test_in_the_engines_thread(expected: str) -> None:
    engine = EngineThread(load_world("living"), SEED, Config(), speed=0.0, running=False)
    engine.start()

    def order(told: dict[str, Any]) -> None:
        engine.submit(READER.validate_python(told)).result(PATIENCE_S)

    play(lambda ticks: order({"type": "step", "ticks": ticks}), order)
    engine.stop()
    assert engine.session.state_hash() == expected


@contextmanager
def served() -> Iterator[tuple[EngineThread, str]]:
    engine = EngineThread(load_world("living"), SEED, Config(), running=False)
    ready = threading.Event()
    viewers = Viewers(engine.latest, engine.submit)
    dashboard = Dashboard(engine.latest, engine.submit, viewers, port=0, on_ready=lambda _url: ready.set())
    dashboard.bind()
    engine.start()
    serving = threading.Thread(target=dashboard.run)
    serving.start()
    try:
        assert ready.wait(PATIENCE_S)
        yield engine, dashboard.url
    finally:
        dashboard.stop()
        serving.join(PATIENCE_S)
        engine.stop()
    assert not serving.is_alive()


@contextmanager
def watched(url: str) -> Iterator[None]:
    """Somebody looks at all that the page can show."""
    stream = url.replace("http", "ws") + f"api/stream?page={'w' * 22}"
    with connect(stream, origin=url.rstrip("/")) as socket:  # type: ignore[arg-type]
        socket.send('{"type": "tabs", "names": ["Senses", "Memory", "Inspect", "Tick", "Truth", "Office", "Tune"]}')
        looking = threading.Thread(target=lambda: [None for _ in socket])
        looking.start()
        yield
        socket.close()
        looking.join(PATIENCE_S)


@pytest.mark.parametrize("is_watched", [False, True])
def test_through_the_server_at_several_speeds(expected: str, is_watched: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("web.http.asking.ANSWER_TIMEOUT_S", PATIENCE_S)  # the engine may have to compile itself first
    with served() as (engine, url), httpx2.Client(base_url=url.rstrip("/"), timeout=PATIENCE_S) as client:

        def order(told: dict[str, Any]) -> int:
            while (answer := client.post("/api/commands", json=told)).status_code == 429:
                time.sleep(0.1)  # a quick machine comes to the limit of commands a second
            assert answer.status_code == 200, answer.text
            return answer.json()["tick"]

        def go_on(factor: float, ticks: int) -> int:
            """At this pace, for at least so many ticks. The tick that it has come to."""
            order({"type": "set_speed", "factor": factor})
            to = order({"type": "resume"}) + ticks
            until(lambda: client.get("/api/state?map=1").json()["tick"] >= to, f"tick {to}")
            return order({"type": "pause"})

        with watched(url) if is_watched else nullcontext():
            play(lambda ticks: order({"type": "step", "ticks": ticks}), order)
            assert engine.session.state_hash() == expected
            go_on(16.0, 40)
            reached = go_on(2.0, 5)
    assert engine.session.state_hash() == directly(reached)


def test_saved_and_restored(expected: str, tmp_path: Path) -> None:
    session = Session(load_world("living"), SEED)
    play_session(session, to=350)
    save_session(session, tmp_path / "half.npz")
    restored = load_session(tmp_path / "half.npz")
    play_session(restored)
    assert restored.state_hash() == expected


def test_replayed_from_its_file(expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    session, complaints = Session(load_world("living"), SEED), list[str]()
    keeper = RunKeeper(complaints.append)
    keeper.start()
    feed = keeper.feed(session, beginning_of(session))
    session.on_order = feed.order
    keeper.begin(feed)
    play_session(session, feed.tick)
    keeper.stop()
    assert complaints == []
    assert replayed(open_run("last")).state_hash() == expected


@pytest.mark.parametrize("written", [lambda situation: link_of(situation)[0], file_of], ids=["link", "file"])
def test_from_a_link_and_a_file(expected: str, written: Callable[[Situation], str]) -> None:
    session, orders = Session(load_world("living"), SEED), list[Order]()
    header, session.on_order = header_of(beginning_of(session)), orders.append
    play_session(session)
    situation = Situation(header, tuple(orders), session.tick_count, session.state_hash())
    assert read_situation(written(situation)).play().state_hash() == expected


def test_sought_and_gone_on_from_on_a_branch(expected: str) -> None:
    engine, at = an_engine(load_world("living"), SEED), dict[int, str]()

    def step(ticks: int) -> None:
        for _ in range(ticks):
            engine.tick()
            if engine.shown.session.tick_count % 70 == 0:
                at.setdefault(engine.shown.session.tick_count, engine.shown.session.state_hash())

    def order(told: dict[str, Any]) -> None:
        tell(engine, **told)

    def seek(tick: int) -> None:
        order({"type": "seek", "tick": tick})
        while engine.slices.work is not None:
            engine.work_on()

    play(step, order)
    for tick in (210, 70, 560):  # a moment of the past is as it was, in whatever order it is looked at
        seek(tick)
        assert engine.shown.session.state_hash() == at[tick], tick
    order({"type": "back_to_now"})
    assert engine.run.session.state_hash() == expected
    seek(350)
    order({"type": "go_on_from_here"})
    play(step, order, since=350)
    assert engine.run.session.state_hash() == expected


def test_on_another_number_of_cores(expected: str) -> None:
    names = "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"
    other = dict.fromkeys(names, "2" if os.environ.get(names[0]) == "1" else "1")
    code = "from tests.integration.test_one_run import directly; print(directly())"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env={**os.environ, **other}, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == expected
