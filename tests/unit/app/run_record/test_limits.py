"""What is written can be read again: who writes a run and who reads it have the same limits, and an order that repeats is one."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from app.orders import Order, carry_out, overtakes
from app.run_record import order_rows, run_log
from app.run_record.folder import LINES
from app.run_record.header import beginning_of, header_of, written
from app.run_record.keyframes import TimeMachine
from app.run_record.link import file_of, read_situation
from app.run_record.reader import KeptRun, open_run
from app.run_record.record import CHECKSUM_BYTES
from app.run_record.run_log import line_of
from app.run_record.situation import Situation
from app.run_record.writer import LogWriter, RunFeed
from app.session import Session
from app.views.history import History
from sim2d import load_world
from tests.unit.app.sessions import a_session

pytestmark = pytest.mark.slow

LIVING = load_world("living")
HEADER = header_of(beginning_of(a_session(seed=1)))


def text_of(orders: str, ticks: int = 0) -> str:
    """The file of a situation with these orders in it."""
    return file_of(Situation(HEADER, (), ticks, "0" * 64)).replace('"orders": []', f'"orders": {orders}')


class Paper:
    """The log of a session, which is written whenever a test says so."""

    def __init__(self) -> None:
        self.complaints: list[str] = []
        session = a_session(seed=1)
        self.feed = RunFeed(session, beginning_of(session))
        self.log = LogWriter(self.feed, self.complaints.append)

    def tick(self, tick: int) -> None:
        self.feed.enter_tick(tick, bytes(CHECKSUM_BYTES))

    def kept(self) -> KeptRun:
        self.log.finish()
        assert self.feed.folder is not None
        return open_run(self.feed.folder)


@pytest.fixture
def paper(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Paper:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    return Paper()


def test_a_key_that_is_held_is_one_order() -> None:
    session, told = a_session(seed=1), list[Order]()
    session.on_order = told.append
    for _ in range(30):
        for _ in range(6):
            session.drive(0.2, 0.0)
        session.tick()
    session.drive(0.2, 0.5)
    session.tick()
    assert [(order.tick, order.values) for order in told] == [
        (0, {"speed": 0.2, "yaw_rate": 0.0}),
        (30, {"speed": 0.2, "yaw_rate": 0.5}),
    ]
    again = a_session(seed=1)
    while again.tick_count < session.tick_count:
        for order in [order for order in told if order.tick == again.tick_count]:
            carry_out(again, order)
        again.tick()
    assert again.state_hash() == session.state_hash()


ORDERS: dict[str, Callable[[Session], object]] = {
    "drive": lambda s: s.drive(0.2, 0.1),
    "cancel_goal": lambda s: s.cancel_goal(),
    "set_mode": lambda s: s.set_mode("manual"),
    "tag": lambda s: s.tag("here"),
    "set_door": lambda s: s.set_door(LIVING.doors[0].name, False),
    "set_lamp": lambda s: s.set_lamp(LIVING.lamps[0].name, False),
}


@pytest.mark.parametrize("name", ORDERS)
def test_an_order_that_is_overtaken_changes_nothing(name: str) -> None:
    """What `overtakes` promises: the later of two alone does what both do."""
    states: list[str] = []
    for times in (1, 3):
        session, told = a_session(10, 1, LIVING), list[Order]()
        session.on_order = told.append
        for _ in range(times):
            ORDERS[name](session)
        assert all(overtakes(later, before) for before, later in pairwise(told))
        for _ in range(5):
            session.tick()
        states.append(session.state_hash())
    assert states[0] == states[1]


def test_what_overtakes_is_kept_in_memory_and_in_the_file_alone(paper: Paper) -> None:
    session = a_session(seed=1)
    machine = TimeMachine(session, History(session))
    for tick in range(3):
        for k in range(60):
            order = Order(tick, "drive", {"speed": 0.01 * (k % 7), "yaw_rate": 0.0})
            paper.feed.order(order)
            machine.note_order(order)
        paper.tick(tick + 1)
    for _ in range(1000):
        paper.feed.order(Order(3, "cancel_goal", {}))
        paper.log.write()
    kept = [(order.tick, order.name) for order in paper.kept().orders]
    assert kept == [(0, "drive"), (1, "drive"), (2, "drive"), (3, "cancel_goal")]
    assert paper.complaints == []
    assert [order.values["speed"] for order in machine.live.orders] == [0.01 * (59 % 7)] * 3


@pytest.mark.parametrize(
    ("module", "limit", "value", "why"),
    [
        (order_rows, "ORDERS", 50, "at most 50 orders"),
        (run_log, "RUN_BYTES", 40_000, "more than 0 MiB"),
        (run_log, "LINE_PARTS", 400, "more than 400 values"),
    ],
)
def test_a_run_that_grows_too_large_is_kept_up_to_there_and_opens(
    paper: Paper, monkeypatch: pytest.MonkeyPatch, module: object, limit: str, value: int, why: str
) -> None:
    """It was written on and on, and then refused as "more than 64 MiB, which no run has"."""
    monkeypatch.setattr(module, limit, value)
    for tick in range(400):
        paper.feed.order(Order(tick, "set_parameters", {"values": {f"x{k}": 1.0 for k in range(2 * tick)}}))
        paper.tick(tick + 1)
        paper.log.write()
    kept, (complaint,) = paper.kept(), paper.complaints
    assert why in complaint
    assert kept.damage == ""
    assert 30 <= len(kept.orders) < 400
    assert kept.tick == kept.orders[-1].tick + 1, "no tick is kept after an order that is missing"


def test_a_file_of_an_earlier_program_that_repeats_orders_is_read(tmp_path: Path) -> None:
    data, check = line_of(written(HEADER), 0)
    for _ in range(5000):
        line, check = line_of({"tick": 0, "order": "cancel_goal", "values": {}}, check)
        data += line
    (tmp_path / LINES).write_bytes(data)
    assert open_run(tmp_path).orders == [Order(0, "cancel_goal", {})]


def test_reading_a_situation_takes_a_few_times_its_size() -> None:
    """28 MB took 3.2 GB."""
    text = text_of(json.dumps([[tick, "cancel_goal", {}] for tick in range(40_000)]), 40_000)
    tracemalloc.start()
    try:
        assert len(read_situation(text).orders) == 40_000
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 16 * len(text)


def test_orders_that_are_none_are_refused_by_number(subtests: pytest.Subtests) -> None:
    for name, orders, why in [
        ("numbers", "[" + "0," * 9_000_000 + "0]", "longer than any run"),
        ("deep", '[[0, "drive", {"speed": ' + "[" * 5000 + "]" * 5000 + "}]]", "damaged"),
        ("deeper", "[" + "[" * 100_000 + "]" * 100_001, "damaged"),
        ("short", '[[0, "drive", {"speed": 0.1}], [0, "drive"]]', "order 1, of tick 0: drive: "),
        ("object", "{}", "damaged"),
    ]:
        with subtests.test(name), pytest.raises(ValueError, match=why):
            read_situation(text_of(orders))


def test_edits_that_would_fill_the_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each edit of a few bytes makes another text of a whole world."""
    monkeypatch.setattr(order_rows, "EDITED_BYTES", 1_000_000)
    edit = {"edit": order_rows.edit_of(HEADER.world, HEADER.world)}
    rows = json.dumps([[tick, "edit_world", edit] for tick in range(100)])
    with pytest.raises(ValueError, match=r"order [0-9]+, of tick .* the worlds of a run"):
        read_situation(text_of(rows, 100))
