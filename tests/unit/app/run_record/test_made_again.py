"""A moment that was linked comes out the same elsewhere: in another process, on other cores and threads, as Python, by the
engine; and from whatever moment of whatever branch it was taken. With two brains side by side both must come out the same."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from app.commands import carry_out
from app.orders import Order
from app.run_record.header import beginning_of, header_of
from app.run_record.link import file_of, link_of, python_lines, read_situation
from app.run_record.resume import resumed
from app.run_record.situation import Situation
from app.session import Session
from ratslam_core import load_brain
from ratslam_core.brain_file import save_brain
from sim2d import load_world
from tests.unit.app.engines import an_engine, not_begun, run_for, tell
from tests.unit.app.run_record.kept import keep_one
from tests.unit.app.sessions import OFFICE, a_session
from web import messages as m

from .made import a_situation, again, moment_of, opened, played, view_of

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[4]


def test_the_lines_of_python_make_it_again_in_a_fresh_interpreter_on_one_core(tmp_path: Path) -> None:
    (tmp_path / "app.py").touch()  # as a notebook may have beside it
    situation = a_situation(120)
    lines = python_lines(situation, "unused.json")
    assert "read_situation" not in lines
    assert f'assert session.state_hash() == "{situation.state_hash}"' in lines
    script, cores = tmp_path / "lines.py", os.sched_getaffinity(0)
    script.write_text(f"{lines}\nprint(session.state_hash())\n")
    done = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        preexec_fn=lambda: os.sched_setaffinity(0, {min(cores)}),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == situation.state_hash
    with pytest.raises(AssertionError, match="not the same"):
        exec(lines.replace(situation.state_hash, "0" * 64), {})


def test_with_boxes_the_lines_read_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    situation = a_situation(60, boxes=True)
    (tmp_path / "it.situation.json").write_text(file_of(situation))
    monkeypatch.chdir(tmp_path)
    made: dict[str, Session] = {}
    exec(python_lines(situation, "it.situation.json"), made)
    assert made["session"].state_hash() == situation.state_hash


def test_long_runs_stay_readable() -> None:
    orders = tuple(Order(200 + k, "drive", {"speed": 0.1 + k / 1000, "yaw_rate": 0.3}) for k in range(100))
    lines = python_lines(replace(a_situation(4), orders=orders, tick=600), "unused.json").splitlines()
    assert len(lines) < len(orders) + 25
    assert max(map(len, lines)) < 140


def test_a_brain_of_its_own_is_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "brain.npz"
    save_brain(a_session(80).brain, path)
    session = Session(OFFICE, 4, brain=load_brain(path))
    header = header_of(beginning_of(session, brain=path))
    for _ in range(30):
        session.tick()
    situation = Situation(header, (), 30, session.state_hash(), brain=path.read_bytes())
    assert again(read_situation(file_of(situation)))


# ------------------------------------------------------------ from the engine, and in it


@pytest.mark.parametrize("world", ["office", "living", "twins"])
def test_of_the_present_with_the_orders_given_just_now(world: str) -> None:
    engine = an_engine(load_world(world))
    run_for(engine, 40)
    tell(engine, type="kidnap")
    for ticks in (0, 30):
        run_for(engine, ticks)
        here = moment_of(engine)
        assert (here.tick, len(here.orders)) == (40 + ticks, 1)
        assert here.state_hash == engine.run.session.state_hash()
        assert again(here)


def test_of_the_past_before_the_orders_and_of_every_branch() -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 40)
    tell(engine, type="kidnap", x=2.0, y=6.0)
    run_for(engine, 40)
    tell(engine, type="seek", tick=40)
    past = moment_of(engine)
    assert (past.tick, past.orders) == (40, ())
    tell(engine, type="go_on_from_here")
    tell(engine, type="set_mode", mode="manual")
    run_for(engine, 20)
    branch = moment_of(engine)
    assert [order.name for order in branch.orders] == ["set_mode"]
    tell(engine, type="seek", tick=20)
    earlier = moment_of(engine)
    tell(engine, type="change_branch", number=1)
    first = moment_of(engine)
    assert [order.name for order in first.orders] == ["kidnap"]
    assert len({each.state_hash for each in (past, branch, earlier, first)}) == 4
    assert all(map(again, (past, branch, earlier, first)))


def test_of_a_run_that_was_resumed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept, state_hash = keep_one(tmp_path, monkeypatch, ticks=60)
    engine = not_begun(OFFICE)
    engine.go_on(kept, resumed(kept))
    here = moment_of(engine)
    assert (here.tick, here.state_hash) == (60, state_hash)
    assert again(here)
    tell(engine, type="kidnap")
    run_for(engine, 5)
    assert again(moment_of(engine))


def test_the_engine_plays_it_and_says_that_it_is_the_same() -> None:
    situation = a_situation(120)
    assert view_of(opened(situation)).state == "playing"
    engine, view = played(situation)
    session = engine.run.session
    assert (view.state, view.tick, session.tick_count, engine.running) == ("same", 120, 120, False)
    assert session.state_hash() == situation.state_hash
    assert "kidnap" in {event.kind for event in engine.run.event_log.events}
    tell(engine, type="seek", tick=50)  # its past is there
    tell(engine, type="back_to_now")
    run_for(engine, 3)
    assert again(moment_of(engine))  # a link to what became of a link


def test_another_hash_is_said_with_the_versions_and_an_order_that_cannot_be_carried_out_stops_it() -> None:
    situation = a_situation(20)
    engine, view = played(replace(situation, state_hash="0" * 64))
    assert view.state == "other"
    assert "the link says 000000000000" in view.words
    assert f"numpy {situation.header.numpy}" in view.words
    assert engine.run.event_log.events[-1].text == view.words
    _, view = played(replace(situation, orders=(Order(5, "go_to_tag", {"name": "nowhere"}),)))
    assert (view.state, view.tick) == ("stopped", 5)
    assert "the order go_to_tag of tick 5 cannot be carried out: there is no tag 'nowhere'" in view.words


def test_while_it_plays_nobody_changes_it_and_it_can_be_left() -> None:
    engine = opened(a_situation(40))
    engine.run_ahead(0.0)
    run_for(engine, 3)
    for command in ({"type": "kidnap"}, {"type": "resume"}, {"type": "seek", "tick": 0}):
        with pytest.raises(ValueError, match="a situation is being played up to its moment"):
            tell(engine, **command)
    tell(engine, type="go_back")
    assert (engine.run.number, engine.run.session.tick_count, engine.running) == (1, 7, False)
    assert engine.snapshot().situation is None
    tell(engine, type="seek", tick=3)  # with its past
    with pytest.raises(ValueError, match="no run waits"):
        tell(engine, type="go_back")


def test_what_cannot_begin_leaves_the_run_as_it_is() -> None:
    engine, situation = an_engine(OFFICE), a_situation(5)
    run_for(engine, 7)
    answer = carry_out(engine, m.OpenSituation(replace(situation, header=replace(situation.header, world="{}"))))
    assert isinstance(answer, m.Refused)
    assert "it cannot be played here" in answer.reason
    assert (engine.run.number, engine.run.session.tick_count) == (1, 7)


# ------------------------------------------------------------ with a second brain


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
