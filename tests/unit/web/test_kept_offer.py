"""The brain of an earlier program is offered until somebody answers. One that cannot be woken up is still offered."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from ratslam_core import Odometry, RatSlam, load_brain
from sim2d import World, load_world
from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import ORIGIN, PORT, StubEngine, StubViewers
from web.http.api import create_app
from web.http.asking import NoAnswer
from web.http.kept_offer import KeptOffer, Offered
from web.latest import Latest
from web.messages import Accepted, GoOn, ReadFiled, Refused, Snapshot, UseBrain

PATH = "/api/brain/kept"
FACTS = {"world": "loop", "seed": 7, "time_s": 90.0, "experiences": 12, "kept_at": 1e9}


@pytest.fixture(scope="module")
def brain() -> RatSlam:
    brain = RatSlam()
    brain.step(np.random.default_rng(0).integers(0, 256, (48, 64), np.uint8), Odometry(0.0, 0.0, 0.1))
    return brain


class Page:
    """A server that offers what `read` gives, and a page on it."""

    def __init__(self, client: TestClient, engine: StubEngine) -> None:
        self.client, self.engine = client, engine
        engine.answer = Accepted(0)

    def told(self) -> Any:
        answer = self.client.get(PATH)
        assert answer.status_code == 200
        return answer.json()

    def answer(self, use: bool) -> tuple[int, Any]:
        answer = self.client.post(PATH, json={"use": use})
        return answer.status_code, answer.json()

    def refused(self, use: bool) -> str:
        status, told = self.answer(use)
        assert status == 422
        return told["detail"][0]["reason"]


@pytest.fixture
def offering() -> Iterator[Callable[..., Page]]:
    opened: list[TestClient] = []

    def start(read: Callable[[], RatSlam] | None = None, **facts: Any) -> Page:
        engine, latest = StubEngine(), Latest[Snapshot]()
        latest.put(fake_snapshot(12))
        offered = None if read is None and not facts else Offered(**{**FACTS, **facts}, read=read)
        client = TestClient(create_app(latest, engine.submit, StubViewers(), PORT, offered), base_url=ORIGIN)
        opened.append(client.__enter__())
        return Page(client, engine)

    yield start
    for client in opened:
        client.__exit__(None, None, None)


def test_what_is_kept_is_told_and_wakes_up_in_its_world_with_its_seed(offering, brain) -> None:
    threads = []

    def read() -> RatSlam:
        threads.append(threading.current_thread().name)
        return brain

    page = offering(read)
    titles = dict(fake_snapshot(12).worlds)
    for _ in range(2):
        assert page.told() == {**FACTS, "title": titles.get("loop", "loop"), "run": None}
    assert page.engine.commands == []
    assert page.answer(True) == (200, {"used": True})
    asked, use = page.engine.commands
    assert asked == ReadFiled("loop")
    assert isinstance(use, UseBrain)
    assert (use.brain, use.world, use.seed) == (brain, load_world("loop"), 7)
    assert threads[0].startswith("asyncio_")  # not the event loop's
    assert page.told() is None
    assert page.refused(True) == "no brain is offered, or somebody has answered already"
    assert len(page.engine.commands) == 2


def test_a_world_that_the_engine_has_read_is_not_read_again(offering, brain) -> None:
    page, loop = offering(lambda: brain, world="of a plan"), load_world("loop")
    page.engine.answer = lambda request: Accepted(0, loop if isinstance(request, ReadFiled) else None)
    assert page.answer(True) == (200, {"used": True})
    assert isinstance(page.engine.commands[1].world, World)
    assert page.engine.commands[1].world is loop


def test_a_run_that_was_cut_off_goes_on(offering) -> None:
    request, broken = GoOn("run", "session"), [ValueError("the run r comes out differently from tick 7 on")]

    def go_on(tell: Callable[[float], object]) -> GoOn:
        tell(0.5)
        shares.append(page.client.get("/api/brain/kept/done").json())
        if broken:
            raise broken.pop()
        return request

    shares: list[object] = []
    page = offering(run="r", go_on=go_on)
    assert page.client.get("/api/brain/kept/done").json() is None
    assert page.told()["run"] == "r"
    assert page.refused(True) == "this run cannot go on: the run r comes out differently from tick 7 on"
    assert page.told()["run"] == "r"
    assert page.answer(True) == (200, {"used": True})
    assert page.engine.commands == [request]
    assert page.told() is None
    assert shares == [0.5, 0.5]
    assert page.client.get("/api/brain/kept/done").json() is None


def test_a_run_that_nobody_waits_for_is_given_up() -> None:
    """The request is one whose page has gone; what runs in the thread hears of it at its next tick."""
    stopped = threading.Event()

    def go_on(tell: Callable[[float], object]) -> GoOn:
        try:
            while True:
                tell(0.1)
                time.sleep(0.001)
        finally:
            stopped.set()

    class Gone:
        async def is_disconnected(self) -> bool:
            return True

    engine = StubEngine()
    offer = KeptOffer(Offered(**FACTS, run="r", go_on=go_on), Latest[Snapshot](), engine.submit)
    with pytest.raises(NoAnswer, match="nobody waits"):
        asyncio.run(offer._go_on(go_on, Gone()))  # type: ignore[arg-type]
    assert stopped.is_set()
    assert offer.done is None
    assert engine.commands == []


def test_not_now_is_for_good(offering, brain) -> None:
    page = offering(lambda: brain)
    assert page.answer(False) == (200, {"used": False})
    assert page.told() is None
    assert page.engine.commands == []
    assert "no brain is offered" in page.refused(False)


def test_without_one_there_is_nothing(offering) -> None:
    page = offering(None)
    assert page.told() is None
    assert "no brain is offered" in page.refused(True)


def test_what_cannot_be_woken_up_is_a_sentence_and_stays_offered(offering, brain, tmp_path: Path) -> None:
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"PK")
    page = offering(lambda: load_brain(broken))
    assert page.refused(True).startswith(f"this brain cannot be woken up: {broken} is no brain that can be taken back")
    page = offering(lambda: brain, world="gone")
    assert page.refused(True).startswith("this brain cannot be woken up: no world 'gone'; expected one of: office, ")
    assert all(isinstance(request, ReadFiled) for request in page.engine.commands)
    page = offering(lambda: brain)
    page.engine.answer = lambda request: (
        Accepted(0) if isinstance(request, ReadFiled) else Refused("brain", None, "this brain cannot be used here")
    )
    assert page.refused(True) == "this brain cannot be used here"
    assert page.told()["world"] == "loop"


@pytest.mark.parametrize("body", [{}, {"use": 1}, {"use": "yes"}, {"use": True, "more": 1}, []])
def test_a_wish_is_checked(offering, brain, body: Any) -> None:
    page = offering(lambda: brain)
    answer = page.client.post(PATH, json=body)
    assert answer.status_code == 422
    assert answer.json()["detail"][0]["reason"]
    assert page.told() is not None


def test_another_site_may_not_answer(offering, brain) -> None:
    page = offering(lambda: brain)
    for elsewhere in ({"Origin": "http://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
        assert page.client.post(PATH, json={"use": False}, headers=elsewhere).status_code == 403
        assert page.client.get(PATH, headers=elsewhere).status_code == 403
    assert page.told() is not None
