"""A second brain on the same senses: it changes nothing in the first, and is itself as it would be alone."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from app import session_snapshot
from app.config import Config, Value
from app.config.presets import pairs_beside
from app.orders import Order, carry_out
from app.recordings.playing import Player
from app.session import Session, played_session
from app.session_snapshot import restore_session, take_session
from disk import encode

from .made_recordings import recorded
from .sessions import OFFICE, a_session

pytestmark = pytest.mark.slow

EIGHT: dict[str, Value] = {"pose_cells.n_x": 8, "pose_cells.n_y": 8}
BLIND: dict[str, Value] = {"local_view.enabled": False}
Step = Callable[[Session], object]
ORDERS: tuple[Step, ...] = (
    lambda session: session.kidnap(),
    lambda session: session.set_parameter("local_view.learning_rate", 0.4),
    lambda session: session.set_parameter("robot.camera_fov_rad", 1.1),
    lambda session: session.go_to(len(session.brain.experience_map) - 1),
    lambda session: session.drive(0.3, 0.2),
    lambda session: session.put_packet(4, 4),
    lambda session: session.set_mode("explore"),
)


def run_for(session: Session, ticks: int) -> Session:
    for _ in range(ticks):
        session.tick()
    return session


def beside(values: dict[str, Value], ticks: int = 0, anew: bool = True, seed: int = 3) -> Session:
    session = a_session(seed=seed)
    session.begin_companion("one", "other", values, anew)
    return run_for(session, ticks)


@settings(max_examples=6, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(
    st.sampled_from([pair.values for pair in pairs_beside(Config())]),
    st.integers(0, 1000),
    st.lists(st.tuples(st.integers(1, 40), st.sampled_from(ORDERS)), max_size=5),
)
def test_the_first_is_the_same_to_the_bit(values: dict[str, Value], seed: int, orders: list[tuple[int, Step]]) -> None:
    alone, watched = a_session(seed=seed), beside(values, seed=seed)
    for ticks, order in [*orders, (20, lambda _: None)]:
        for session in (alone, watched):
            run_for(session, ticks)
            order(session)
    assert alone.state_hash() == watched.state_hash()
    watched.end_companion()
    assert alone.state_hash() == watched.state_hash()
    assert take_session(alone).digest() == take_session(watched).digest()  # nothing of it remains


def test_with_the_same_parameters_it_is_the_first_again_whatever_is_told_to_both() -> None:
    session = beside({})
    for order in ORDERS:
        if order is not ORDERS[5]:  # a packet by hand is put into the first only
            run_for(session, 25)
            order(session)
    run_for(session, 60)
    companion = session.companion
    assert companion is not None
    assert encode(companion.brain).digest() == encode(session.brain).digest()
    assert encode(companion.evaluation).digest() == encode(session.evaluation).digest()
    assert (companion.divergence.packet, companion.divergence.view, companion.divergence.link) == (None, None, None)
    assert companion.counterpart == list(range(len(session.brain.experience_map)))


def test_it_is_the_brain_that_those_parameters_make_on_the_same_way() -> None:
    """Where the pilot does not read the brain, a session with these parameters drives the same way."""
    plain: dict[str, Value] = {"pilot.seek": False}
    session = a_session(config=Config().with_values(plain))
    session.begin_companion("64", "8", EIGHT, True)
    other = a_session(config=Config().with_values({**plain, **EIGHT}))
    for each in (session, other):
        run_for(each, 300)
    assert session.companion is not None
    assert encode(session.companion.brain).digest() == encode(other.brain).digest()
    errors = [each.evaluation.errors(each.brain.experience_map) for each in (session.companion, other)]
    assert errors[0] == errors[1]


def test_a_copy_differs_from_now_on() -> None:
    session = a_session(150)
    session.begin_companion("with", "without", BLIND, False)
    companion = session.companion
    assert companion is not None
    made = len(session.brain.experience_map)
    assert len(companion.brain.experience_map) == made
    assert companion.counterpart == list(range(made))
    assert not companion.brain.params.local_view.enabled
    assert session.brain.params.local_view.enabled
    run_for(session, 50)
    view = companion.divergence.view
    assert view is not None
    assert (view[0], view[3]) == (151, -1)


def test_what_is_set_for_the_first_is_set_for_both_but_for_the_difference() -> None:
    session = beside({"local_view.learning_rate": 1.0}, 5)
    session.set_parameters({"local_view.learning_rate": 0.3, "local_view.saturation": 0.02, "pose_cells.n_x": 32})
    assert session.companion is not None
    for params, rate in ((session.brain.params, 0.3), (session.companion.brain.params, 1.0)):
        assert (params.local_view.learning_rate, params.local_view.saturation) == (rate, 0.02)
        assert params.pose_cells.n_x == 64  # waits for the next reset
    assert session.companion.config.pose_cells.n_x == 32


def test_a_goal_of_the_first_is_where_the_other_was_then() -> None:
    session = beside(EIGHT, 400)
    assert session.companion is not None
    first, other, at = session.brain.experience_map, session.companion, session.companion.counterpart
    assert len(at) == len(first)
    apart = [
        math.dist(session.evaluation.made_at(k, first), other.evaluation.made_at(at[k], other.brain.experience_map))
        for k in range(len(at))
    ]
    assert max(apart) < 1.0  # the two were at one place, whatever they call it


def test_what_cannot_be_compared() -> None:
    session, told = a_session(3), list[Order]()
    session.on_order = told.append
    refused: list[tuple[str, dict[str, Value], bool, str]] = [
        ("other", {"pilot.seek": False}, True, "pilot.seek cannot differ"),
        ("other", {"robot.max_speed": 0.1}, False, "robot.max_speed cannot differ"),
        ("other", {"local_view.nothing": 1}, True, "unknown parameter"),
        ("other", EIGHT, False, "pose_cells.n_x, pose_cells.n_y cannot change while a brain runs"),
        ("other", BLIND, True, "begins together with the run"),
        (" ", {}, False, "needs a name"),
    ]
    for name, values, anew, words in refused:
        with pytest.raises(ValueError, match=words):
            session.begin_companion("one", name, values, anew)
    with pytest.raises(ValueError, match="no second brain"):
        session.end_companion()
    assert (session.companion, told) == (None, [])


def test_as_orders_and_from_a_file_both_go_on_as_they_did_and_a_spoilt_one_is_refused() -> None:
    session, told = a_session(), list[Order]()
    session.on_order = told.append
    session.begin_companion("64", "8", EIGHT, True)
    run_for(session, 60)
    session.kidnap()
    kept, again = restore_session(take_session(session)), a_session()
    for order in told:
        carry_out(run_for(again, order.tick - again.tick_count), order)
    for each in (session, kept, again):
        run_for(each, 60)
        session_snapshot.check(each, OFFICE)
    both = [(each.state_hash(), each.companion and each.companion.digest()) for each in (session, kept, again)]
    assert both == both[:1] * 3
    assert kept.companion is not None
    kept.companion.counterpart.append(99)
    with pytest.raises(ValueError, match="counterpart"):
        restore_session(take_session(kept))


@pytest.mark.parametrize("truth", [True, False])
def test_beside_a_recording(truth: bool) -> None:
    player = Player(recorded(120, truth))
    alone, session = played_session(player), played_session(player)
    session.begin_companion("one", "same", {}, True)
    for each in (alone, session):
        run_for(each, 100)
    assert session.companion is not None
    assert encode(session.companion.brain).digest() == encode(session.brain).digest()
    assert alone.state_hash() == session.state_hash()
    session.begin_companion("with", "without", BLIND, False)
    run_for(session, 19)
    assert session.companion.divergence.view is not None
    assert session.source.over
