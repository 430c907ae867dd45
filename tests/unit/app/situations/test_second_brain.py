"""With two brains side by side, a situation is the same only if both come out the same; earlier links still open."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from app.session import Session
from app.situations import Situation, file_of, link_of, read_situation
from app.situations.python_lines import python_lines
from tests.unit.app.engines import an_engine, run_for, tell
from tests.unit.app.sessions import OFFICE

from .made import a_situation, moment_of, played

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def compared() -> Situation:
    """The robot is carried away while the second brain is blind."""
    engine = an_engine(OFFICE)
    run_for(engine, 20)
    tell(engine, type="kidnap", x=2.0, y=6.0)
    engine.run.session.begin_companion("with", "without", {"local_view.enabled": False}, False)
    run_for(engine, 30)
    return moment_of(engine)


def seeing(situation: Situation) -> Situation:
    """The same, but the second brain sees as the first does."""
    orders = [
        replace(order, values={**order.values, "values": {}}) if order.name == "begin_companion" else order
        for order in situation.orders
    ]
    return replace(situation, orders=tuple(orders))


def test_both_hashes_go_through_link_and_file_and_come_out_again(compared: Situation) -> None:
    assert compared.second_hash not in (None, compared.state_hash)
    for text in (file_of(compared), link_of(compared)[0] or ""):
        again = read_situation(text)
        assert again.second_hash == compared.second_hash
    session = again.play()
    assert session.companion is not None
    same, words = again.verdict(session)
    assert same
    assert f"and {session.companion.digest()[:12]} of the second brain" in words
    plain = a_situation(10)
    assert "second_hash" not in file_of(plain), "without a second brain nothing is said of one"
    assert read_situation(link_of(plain)[0] or "").second_hash is None


def test_a_second_brain_that_comes_out_differently_or_is_missing_is_told(compared: Situation) -> None:
    engine, view = played(seeing(compared))
    assert engine.run.session.state_hash() == compared.state_hash  # the first brain cannot tell
    assert view.state == "other"
    assert f"the link says {(compared.second_hash or '')[:12]}" in view.words
    assert "the second brain's hash is" in view.words
    alone = replace(compared, orders=tuple(each for each in compared.orders if each.name != "begin_companion"))
    same, words = alone.verdict(alone.play())
    assert (same, "there is no second brain" in words) == (False, True)


def test_a_link_from_before_there_was_a_second_hash_still_opens(compared: Situation) -> None:
    document = json.loads(file_of(compared))
    del document["second_hash"]
    earlier = read_situation(json.dumps(document))
    same, words = earlier.verdict(earlier.play())
    assert same
    assert words.endswith("Its link says nothing of the second brain.")


def test_the_lines_of_python_compare_both(compared: Situation) -> None:
    made: dict[str, Session] = {}
    exec(python_lines(compared, "unused.json"), made)
    assert made["session"].state_hash() == compared.state_hash
    with pytest.raises(AssertionError, match="the second brain is not the same"):
        exec(python_lines(seeing(compared), "unused.json"), {})
