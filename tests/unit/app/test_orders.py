"""Session are data: given again to a session with the same beginning, they make the same run, bit for bit."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict, replace

import numpy as np
import pytest

from app.orders import METHODS, Order, carry_out
from app.protocol.steps import spread_goals
from app.session import Session
from sim2d import Box, load_world

LIVING = load_world("living")
DOOR, LAMP = LIVING.doors[0].name, LIVING.lamps[0].name


def edit(session: Session) -> None:
    session.edit_world(replace(session.simulator.world, walls=session.world.walls[:-1]))


GIVEN: list[Callable[[Session], object]] = [
    lambda s: s.set_goal(0.5, 0.1),
    lambda s: s.cancel_goal(),
    lambda s: s.tag("  the desk "),
    lambda s: s.kidnap(),
    lambda s: s.go_to_tag("the desk"),
    lambda s: s.untag("the desk"),
    lambda s: s.go_to(spread_goals(s, 1)[0]),
    lambda s: s.set_mode("manual"),
    lambda s: s.drive(0.3, -0.4),
    lambda s: s.put_packet(3, 4, 1.0, 0.8),
    lambda s: s.begin_companion("with", "without", {"local_view.enabled": False}, False),
    lambda s: s.forget_view(2),
    lambda s: s.set_parameter("pose_cells.inhibit", 0.0021),
    lambda s: s.set_door(DOOR, False),
    lambda s: s.set_lamp(LAMP, False),
    lambda s: s.put_box(Box("crate", s.world.starts[0].x, s.world.starts[0].y, 0.3, 0.3, 0.4, math.radians(20))),
    lambda s: s.remove_box("crate"),
    lambda s: s.random_free_pose(),
    lambda s: s.end_companion(),
    edit,
    lambda s: s.set_mode("explore"),
    lambda s: s.go_to_place_of(s.brain.experience_map.active),
]


def test_orders_given_again_make_the_same_run() -> None:
    session, book = Session(LIVING, 4), []
    session.on_order = book.append
    rng, hashes = np.random.default_rng(6), []
    for give in GIVEN:
        for _ in range(int(rng.integers(1, 30))):
            session.tick()
        give(session)
        hashes.append(session.state_hash())
    assert {order.name for order in book} == METHODS.keys(), "every order is given here, each once told"
    assert len(book) == len(GIVEN)
    again = Session(LIVING, 4)
    for kept, expected in zip(book, hashes, strict=True):
        order = Order(**json.loads(json.dumps(asdict(kept))))
        while again.tick_count < order.tick:
            again.tick()
        carry_out(again, order)
        assert again.state_hash() == expected, order.name


def test_what_was_refused_is_not_in_the_book() -> None:
    session, book = Session(LIVING, 4), []
    session.on_order = book.append
    for give in (lambda: session.untag("nowhere"), lambda: session.kidnap(1e6, 1e6), lambda: session.kidnap(x=1.0)):
        with pytest.raises(ValueError):
            give()
    assert book == []
    session.set_mode("manual")
    assert [order.name for order in book] == ["set_mode"]


def test_an_order_that_cannot_be_given_is_refused() -> None:
    session = Session(LIVING, 4)
    refused: list[tuple[str, dict[str, object], str]] = [
        ("tick", {}, "is no order"),
        ("__init__", {}, "is no order"),
        ("kidnap", {"z": 1.0}, "kidnap"),
        ("put_box", {"box": {"name": "b"}}, "put_box"),
        ("edit_world", {"world": "{"}, "the edited world"),
    ]
    for name, values, words in refused:
        with pytest.raises(ValueError, match=words):
            carry_out(session, Order(0, name, values))  # type: ignore[arg-type]
