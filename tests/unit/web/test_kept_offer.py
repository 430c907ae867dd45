"""The brain of an earlier program is offered until somebody answers. One that cannot be woken up is still offered."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.requests import Request
from starlette.testclient import TestClient

from ratslam_core import RatSlam, load_brain
from sim2d import load_world
from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import House, StubEngine, house
from web.http import brains
from web.http.asking import NoAnswer
from web.http.brains import KeptOffer, Offered
from web.latest import Latest
from web.messages import Accepted, GoOn, ReadFiled, Refused, Snapshot, UseBrain

PATH = "/api/brain/kept"
FACTS = {"world": "loop", "seed": 7, "time_s": 90.0, "experiences": 12, "kept_at": 1e9}
BRAIN: Any = "what is handed over to the engine as it is"
NONE = "no brain is offered, or somebody has answered already"


class Page:
    """On a server that offers something."""

    def __init__(self, server: House) -> None:
        self.client: TestClient = server.client
        self.engine: Any = server.engine
        self.engine.answer = Accepted(0)

    def told(self, of: str = PATH) -> Any:
        answer = self.client.get(of)
        assert answer.status_code == 200
        return answer.json()

    def answer(self, use: bool) -> dict[str, bool] | str:
        """What came of it, or why nothing did."""
        answer = self.client.post(PATH, json={"use": use})
        told = answer.json()
        return told if answer.status_code == 200 else told["detail"][0]["reason"]


@contextlib.contextmanager
def offering(read: Callable[[], RatSlam] | None = None, **facts: Any) -> Iterator[Page]:
    offered = None if read is None and not facts else Offered(**{**FACTS, **facts}, read=read)
    with house(offered=offered) as server:
        yield Page(server)


def test_what_is_kept_is_told_and_wakes_up_in_its_world_with_its_seed() -> None:
    threads = []

    def read() -> RatSlam:
        threads.append(threading.current_thread().name)
        return BRAIN

    with offering(read) as page:
        title = dict(fake_snapshot(12).worlds).get("loop", "loop")
        assert [page.told() for _ in range(2)] == [{**FACTS, "title": title, "run": None}] * 2
        assert page.engine.commands == []
        assert page.answer(True) == {"used": True}
        asked, use = page.engine.commands
        assert asked == ReadFiled("loop")
        assert isinstance(use, UseBrain)
        assert (use.brain, use.world, use.seed) == (BRAIN, load_world("loop"), 7)
        assert threads[0].startswith("asyncio_")  # not the event loop's
        assert (page.told(), page.answer(True)) == (None, NONE)
        assert len(page.engine.commands) == 2


def test_a_world_that_the_engine_has_read_is_not_read_again() -> None:
    loop = load_world("loop")
    with offering(lambda: BRAIN, world="of a plan") as page:
        page.engine.answer = lambda request: Accepted(0, loop if isinstance(request, ReadFiled) else None)
        assert page.answer(True) == {"used": True}
        assert page.engine.commands[1].world is loop


def test_a_run_that_was_cut_off_goes_on() -> None:
    request, broken = GoOn("run", "session"), [ValueError("the run r comes out differently from tick 7 on")]
    shares: list[object] = []

    def go_on(tell: Callable[[float], object]) -> GoOn:
        tell(0.5)
        shares.append(page.told(f"{PATH}/done"))
        if broken:
            raise broken.pop()
        return request

    with offering(run="r", go_on=go_on) as page:
        assert (page.told(f"{PATH}/done"), page.told()["run"]) == (None, "r")
        assert page.answer(True) == "this run cannot go on: the run r comes out differently from tick 7 on"
        assert page.told()["run"] == "r"
        assert page.answer(True) == {"used": True}
        assert page.engine.commands == [request]
        assert (page.told(), page.told(f"{PATH}/done"), shares) == (None, None, [0.5, 0.5])


def test_a_run_that_nobody_waits_for_is_given_up(monkeypatch) -> None:
    """The request is one whose page has gone; what runs in the thread hears of it at its next tick."""
    monkeypatch.setattr(brains, "LOOK_S", 0.01)
    stopped = threading.Event()

    def go_on(tell: Callable[[float], object]) -> GoOn:
        try:
            while True:
                tell(0.1)
        finally:
            stopped.set()

    said = iter([{"type": "http.request", "body": b'{"use": true}'}])

    async def receive() -> dict[str, Any]:
        return next(said, {"type": "http.disconnect"})

    gone = Request({"type": "http", "method": "POST", "path": PATH, "headers": []}, receive)
    engine = StubEngine()
    offer = KeptOffer(Offered(**FACTS, run="r", go_on=go_on), Latest[Snapshot](), engine.submit)  # type: ignore[arg-type]
    with pytest.raises(NoAnswer, match="nobody waits"):
        asyncio.run(offer.take(gone))
    assert stopped.is_set()
    assert (offer.done, engine.commands) == (None, [])
    assert offer.to_json() != b"null"


def test_not_now_is_for_good_and_without_an_offer_there_is_nothing() -> None:
    with offering(lambda: BRAIN) as page:
        assert page.answer(False) == {"used": False}
        assert (page.told(), page.engine.commands, page.answer(False)) == (None, [], NONE)
    with offering() as page:
        assert (page.told(), page.answer(True)) == (None, NONE)


def test_what_cannot_be_woken_up_is_a_sentence_and_stays_offered(tmp_path: Path) -> None:
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"PK")
    for read, world, words in (
        (lambda: load_brain(broken), "loop", f"{broken} is no brain that can be taken back"),
        (lambda: BRAIN, "gone", "no world 'gone'; expected one of: office, "),
    ):
        with offering(read, world=world) as page:
            assert page.answer(True).startswith(f"this brain cannot be woken up: {words}")  # type: ignore[union-attr]
            assert all(isinstance(request, ReadFiled) for request in page.engine.commands)
    with offering(lambda: BRAIN) as page:
        page.engine.answer = lambda request: (
            Accepted(0) if isinstance(request, ReadFiled) else Refused("brain", None, "this brain cannot be used here")
        )
        assert page.answer(True) == "this brain cannot be used here"
        assert page.told()["world"] == "loop"


def test_a_wish_is_checked() -> None:
    with offering(lambda: BRAIN) as page:
        for body in ({}, {"use": 1}, {"use": "yes"}, {"use": True, "more": 1}, []):
            answer = page.client.post(PATH, json=body)
            assert (answer.status_code, bool(answer.json()["detail"][0]["reason"])) == (422, True), body
        assert page.told() is not None
