"""A packet injected by hand: it is where and as heavy as asked for, and it competes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.session import Session

from .sessions import a_session


def explored() -> Session:
    return a_session(100, seed=5)


def test_a_packet_is_put_where_it_is_wanted_and_competes() -> None:
    session = explored()
    cells = session.brain.pose_cells
    words = session.put_packet(x=63, y=2, heading_rad=-math.pi / 2, share=0.4)
    assert words == "a packet of 40% put at cell (63, 2) by hand"
    around = np.roll(cells.activity, (9 - 27, 5 - 2, 5 - 63), (0, 1, 2))[6:13, 2:9, 2:9]
    assert around.sum() == pytest.approx(0.4, abs=1e-5)
    first, second = cells.packets  # at once
    assert (first.mass, second.mass) == pytest.approx((0.6, 0.4), abs=1e-4)
    assert (second.x, second.y) == pytest.approx((63, 2), abs=1e-3)
    session.tick()
    _, second = cells.packets
    assert second.mass == pytest.approx(0.4, abs=0.1)
    assert cells.cells_apart(second.x, second.y, 63, 2) < 1
    assert abs(math.remainder(second.heading_rad + math.pi / 2, math.tau)) < 0.3


def test_with_most_of_the_activity_it_wins() -> None:
    session = explored()
    session.set_mode("manual")
    before = session.brain.pose_cells.winner.id
    session.put_packet(x=5, y=5, share=0.9)
    for _ in range(30):
        session.tick()
    winner = session.brain.pose_cells.winner
    assert winner.id != before
    assert session.brain.pose_cells.cells_apart(winner.x, winner.y, 5, 5) < 2


def test_outside_the_pose_cells_nothing_is_put_and_many_turns_are_none() -> None:
    session, layers = explored(), []
    before = session.state_hash()
    for x, y in [(64, 0), (0, 64), (10**9, 3)]:
        with pytest.raises(ValueError, match="x from 0 to 63 and y from 0 to 63, got"):
            session.put_packet(x=x, y=y)
    assert session.state_hash() == before
    for heading in (1.0, 1.0 + 1000 * math.tau, 1e308, -1e308):
        session.put_packet(x=3, y=2, heading_rad=heading, share=0.9)
        layers.append(int(np.argmax(session.brain.pose_cells.activity[:, 2, 3])))
    assert layers[0] == layers[1]
    assert np.isfinite(session.brain.pose_cells.activity).all()
