"""What is written can be read again: who writes a run and who reads it have the same limits, and an order that repeats is one."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from app.order_book import Order, carry_out, overtakes
from app.runs import lines, world_edits
from app.runs.book import Book
from app.runs.folder import LINES
from app.runs.header import beginning_of, header_of, written
from app.runs.lines import line_of
from app.runs.page import Page
from app.runs.pulse import SIZE
from app.runs.run_file import open_run
from app.session import Session
from app.situations import Situation, file_of, read_situation
from app.time_machine import TimeMachine
from app.views.history import History
from sim2d import load_world

pytestmark = pytest.mark.slow

OFFICE, LIVING = load_world("office"), load_world("living")


def session_with_orders() -> tuple[Session, list[Order]]:
    session, told = Session(OFFICE, 1), list[Order]()
    session.on_order = told.append
    return session, told


def test_a_key_that_is_held_is_one_order() -> None:
    session, told = session_with_orders()
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
    again = Session(OFFICE, 1)
    while again.tick_count < session.tick_count:
        for order in [order for order in told if order.tick == again.tick_count]:
            carry_out(again, order)
        again.tick()
    assert again.state_hash() == session.state_hash()


@pytest.mark.parametrize(
    "give",
    [
        lambda s: s.drive(0.2, 0.1),
        lambda s: s.cancel_goal(),
        lambda s: s.set_mode("manual"),
        lambda s: s.tag("here"),
        lambda s: s.set_door(LIVING.doors[0].name, False),
        lambda s: s.set_lamp(LIVING.lamps[0].name, False),
    ],
    ids=["drive", "cancel_goal", "set_mode", "tag", "set_door", "set_lamp"],
)
def test_an_order_that_is_overtaken_changes_nothing(give: Callable[[Session], object]) -> None:
    """What `overtakes` promises: the later of two alone does what both do."""
    states: list[str] = []
    for times in (1, 3):
        session = Session(LIVING, 1)
        told = list[Order]()
        session.on_order = told.append
        for _ in range(20):
            session.tick()
        for _ in range(times):
            give(session)
        assert all(overtakes(later, before) for before, later in pairwise(told))
        for _ in range(5):
            session.tick()
        states.append(session.state_hash())
    assert states[0] == states[1]


def test_what_overtakes_is_kept_in_memory_and_in_the_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, book, complaints = page_in(tmp_path, monkeypatch)
    session = Session(OFFICE, 1)
    machine = TimeMachine(session, History(session))
    for tick in range(3):
        for k in range(60):
            order = Order(tick, "drive", {"speed": 0.01 * (k % 7), "yaw_rate": 0.0})
            book.order(order)
            machine.told(order)
        book.told.append((tick + 1, bytes(SIZE)))
    for _ in range(1000):
        book.order(Order(3, "cancel_goal", {}))
        page.write()
    page.finish()
    assert complaints == []
    kept = open_run(kept_in(book))
    assert [(order.tick, order.name) for order in kept.orders] == [
        *((tick, "drive") for tick in range(3)),
        (3, "cancel_goal"),
    ]
    assert [order.values["speed"] for order in machine.live.orders] == [0.01 * (59 % 7)] * 3


def kept_in(book: Book) -> Path:
    assert book.folder is not None
    return book.folder


def page_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Page, Book, list[str]]:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    session, complaints = Session(OFFICE, 1), list[str]()
    book = Book(session, beginning_of(session))
    return Page(book, complaints.append), book, complaints


@pytest.mark.parametrize(
    ("module", "limit", "value", "why"),
    [
        (world_edits, "ORDERS", 50, "at most 50 orders"),
        (lines, "RUN_BYTES", 40_000, "more than 0 MiB"),
        (lines, "LINE_PARTS", 400, "more than 400 values"),
    ],
)
def test_a_run_that_grows_too_large_is_kept_up_to_there_and_opens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: object, limit: str, value: int, why: str
) -> None:
    """It was written on and on, and then refused as "more than 64 MiB, which no run has"."""
    monkeypatch.setattr(module, limit, value)
    page, book, complaints = page_in(tmp_path, monkeypatch)
    for tick in range(400):
        book.order(Order(tick, "set_parameters", {"values": {f"x{k}": 1.0 for k in range(2 * tick)}}))
        book.told.append((tick + 1, bytes(SIZE)))
        page.write()
    page.finish()
    assert len(complaints) == 1
    assert why in complaints[0]
    kept = open_run(kept_in(book))
    assert kept.damage == ""
    assert 30 <= len(kept.orders) < 400
    assert kept.last_tick == kept.orders[-1].tick + 1, "no tick is kept after an order that is missing"


def test_a_file_of_an_earlier_program_that_repeats_orders_is_read(tmp_path: Path) -> None:
    session = Session(OFFICE, 1)
    data, check = line_of(written(header_of(beginning_of(session))), 0)
    for _ in range(5000):
        line, check = line_of({"tick": 0, "order": "cancel_goal", "values": {}}, check)
        data += line
    (tmp_path / LINES).write_bytes(data)
    assert open_run(tmp_path).orders == [Order(0, "cancel_goal", {})]


def test_reading_a_situation_takes_a_few_times_its_size() -> None:
    """28 MB took 3.2 GB."""
    session = Session(OFFICE, 1)
    orders = [Order(tick, "cancel_goal", {}) for tick in range(40_000)]
    text = file_of(Situation(header_of(beginning_of(session)), tuple(orders), 40_000, "0" * 64))
    del orders
    tracemalloc.start()
    try:
        assert len(read_situation(text).orders) == 40_000
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 16 * len(text)


@pytest.mark.parametrize(
    ("orders", "why"),
    [
        ("[" + "0," * 9_000_000 + "0]", "longer than any run"),
        ('[[0, "drive", {"speed": ' + "[" * 5000 + "]" * 5000 + "}]]", "damaged"),
        ("[" + "[" * 100_000 + "]" * 100_001, "damaged"),
        ('[[0, "drive", {"speed": 0.1}], [0, "drive"]]', "order 1, of tick 0: drive: "),
        ("{}", "damaged"),
    ],
    ids=["numbers", "deep", "deeper", "short", "object"],
)
def test_orders_that_are_none_are_refused_by_number(orders: str, why: str) -> None:
    text = file_of(Situation(header_of(beginning_of(Session(OFFICE, 1))), (), 0, "0" * 64))
    with pytest.raises(ValueError, match=why):
        read_situation(text.replace('"orders": []', f'"orders": {orders}'))


def test_edits_that_would_fill_the_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each edit of a few bytes makes another text of a whole world."""
    monkeypatch.setattr(world_edits, "EDITED_BYTES", 1_000_000)
    session = Session(OFFICE, 1)
    header = header_of(beginning_of(session))
    edit = {"edit": world_edits.edit_of(header.world, header.world)}
    rows = json.dumps([[tick, "edit_world", edit] for tick in range(100)])
    text = file_of(Situation(header, (), 100, "0" * 64)).replace('"orders": []', f'"orders": {rows}')
    with pytest.raises(ValueError, match=r"order [0-9]+, of tick .* the worlds of a run"):
        read_situation(text)
