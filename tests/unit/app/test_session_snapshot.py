"""A session that is saved and loaded goes on bit for bit, at any moment; any other file is refused in a sentence."""

from __future__ import annotations

import io
import struct
from collections.abc import Callable
from dataclasses import replace
from functools import reduce
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.protocol.steps import spread_goals
from app.session import Session
from app.session_snapshot import load_its_brain, load_session, read_session, restore_session, save_session, take_session
from disk import State, encode, write_state
from disk.state_codec import LONG
from disk.state_file import save_state
from ratslam_core import save_brain
from sim2d import Box, Lamp, load_world

pytestmark = pytest.mark.slow

DRIVEN = 60


def driven(world: str, ticks: int = DRIVEN, seed: int = 5) -> Session:
    session = Session(load_world(world), seed)
    for _ in range(ticks):
        session.tick()
    return session


def saved_and_loaded(session: Session) -> Session:
    file = io.BytesIO()
    write_state(take_session(session), file)
    return read_session(file)


def goes_on(session: Session, ticks: int, act: Callable[[Session, int], object] = lambda _session, _tick: None) -> None:
    """Run both sessions side by side with the same commands; nothing may differ in any tick."""
    other = saved_and_loaded(session)
    assert other.state_hash() == session.state_hash()
    for tick in range(ticks):
        for each in (session, other):
            act(each, tick)
            each.tick()
        assert np.array_equal(other.frame.image, session.frame.image)
        assert other.simulator.truth == session.simulator.truth
        assert other.state_hash() == session.state_hash(), f"parted after {tick + 1} ticks"


def test_it_goes_on_bit_for_bit_also_while_the_robot_touches_a_wall() -> None:
    session = driven("living")
    goes_on(session, 40)
    x0, y0, _, _ = session.world.bounds
    session.kidnap(x0 + 0.4, y0 + 0.5, -2.5)
    session.set_mode("manual")
    bumped = 0
    for tick in range(60):
        session.pilot.drive(0.5, 0.4 if tick % 8 == 0 else 0.0)
        session.tick()
        bumped += session.frame.bumped
        if session.frame.bumped and tick % 12 == 0:
            goes_on(session, 6, lambda each, tick: each.pilot.drive(0.4, 0.5 - 0.2 * tick))
    assert bumped > 20


def test_on_a_route_and_on_the_way_to_a_place_of_many_experiences() -> None:
    begun = driven("office", 900)
    for place_m in (0.2, 5.0):
        session = saved_and_loaded(begun)
        session.set_parameter("pilot.goal_place_m", place_m)
        session.tag("here")
        session.set_goal(0.0, 0.0)
        assert (len(session.pilot.goals) > LONG) is (place_m > 1)
        goes_on(session, 20)
    begun.pilot.set_goal(spread_goals(begun, 1)[0])
    ticks = 0
    while begun.pilot.doing != "following the route" or ticks < 30:
        begun.tick()
        ticks += 1
        assert ticks < 400
    goes_on(begun, 30)
    assert begun.pilot.goal is not None


def test_while_it_frees_itself() -> None:
    session = driven("office", 20)
    session.set_parameter("pilot.stuck_s", 1.0)
    ticks = 0
    while session.pilot.doing != "freeing itself":
        session.tick()
        ticks += 1
        assert ticks < 600
    session.tick()
    goes_on(session, 30)


def test_after_a_kidnap_an_edit_and_other_parameters() -> None:
    session = driven("living", 100)
    session.simulator.set_door("laboratory door", False)
    session.set_parameters({"robot.sensor_rate_hz": 20, "office.lamps": False, "pose_cells.n_x": 32})
    session.tick()
    session.kidnap(5.0, 1.5, 0.3)
    session.edit_world(replace(session.world, lamps=(*session.world.lamps, Lamp("new", 3.0, 3.0, 2.0, 0.4))))
    session.simulator.put_box(Box("crate", 4.0, 2.0, 0.4, 0.4, angle_rad=0.1234567))
    other = saved_and_loaded(session)
    assert other.simulator.world == session.simulator.world != other.world
    assert (other.world, other.config, other.seed) == (session.world, session.config, session.seed)
    goes_on(session, 40)
    assert len(session.evaluation.kidnaps) == 1


def test_after_a_box_was_taken_away_and_one_put_where_the_robot_began() -> None:
    session = driven("living", 2)
    (moved, *_) = [event.name for event in session.world.script if event.do == "box_appear"]
    session.remove_box(moved)
    assert moved not in [event.name for event in session.simulator.world.script]
    goes_on(session, 3)
    start = session.world.starts[0]
    session.kidnap()
    session.put_box(Box("crate", start.x, start.y, 0.3, 0.3, 0.4, 0.0))
    goes_on(session, 1)


def do(session: Session, order: int) -> None:
    match order:
        case 0:
            session.kidnap()
        case 1:
            session.pilot.drive(0.5, 0.7)
        case 2:
            session.set_mode("explore")
        case 3:
            session.pilot.set_goal(spread_goals(session, 2)[-1])
        case 4:
            session.simulator.set_door(session.world.doors[0].name, session.tick_count % 2 == 0)
        case 5:
            session.set_parameter("robot.light", 0.5 + session.tick_count % 2)


@settings(max_examples=10, deadline=None)
@given(st.lists(st.integers(0, 8), min_size=8, max_size=20), st.integers(0, 8), st.integers(0, 2**16))
def test_whatever_was_ordered_it_goes_on(orders: list[int], at: int, seed: int) -> None:
    session, other = driven("living", 5, seed), None
    for k, order in enumerate(orders):
        if k == min(at, len(orders) - 1):
            other = saved_and_loaded(session)
        for each in filter(None, (session, other)):
            do(each, order)
            for _ in range(4):
                each.tick()
    assert other is not None
    assert other.state_hash() == session.state_hash()


def test_a_session_that_goes_on_does_not_change_what_was_taken() -> None:
    session = driven("living", 30)
    taken, then = take_session(session), session.state_hash()
    for _ in range(20):
        session.tick()
    assert restore_session(taken).state_hash() == then != session.state_hash()


def middle_of_the_largest(path: Path) -> int:
    """The place in the file of the middle of the largest array."""
    with ZipFile(path) as file:
        largest = max(file.infolist(), key=lambda item: item.compress_size)
    names = path.read_bytes()[largest.header_offset + 26 :][:4]  # lengths of the name and of what follows it
    data = largest.header_offset + 30 + sum(struct.unpack("<HH", names))
    return data + largest.compress_size // 2


def test_a_file_that_is_no_session_is_refused_in_a_sentence(tmp_path: Path) -> None:
    session, path = driven("office", 3), tmp_path / "run.npz"
    save_session(session, path)
    assert load_session(path).state_hash() == session.state_hash()
    with pytest.raises(ValueError, match=r"none\.npz: No such file"):
        load_session(tmp_path / "none.npz")
    save_brain(session.brain, tmp_path / "brain.npz")
    whole = path.read_bytes()
    bits = bytearray(whole)
    bits[middle_of_the_largest(path)] ^= 1  # not in a header, parts of which nobody reads
    for name, data, words in (
        ("brain.npz", (tmp_path / "brain.npz").read_bytes(), "it must hold two worlds and a session"),
        ("cut.npz", whole[: len(whole) // 2], "the file is not a zip file"),
        ("empty.npz", b"", "the file is empty"),
        ("bits.npz", bytes(bits), "."),
    ):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(ValueError, match=f"{name} is no session that can be taken back: .*{words}"):
            load_session(tmp_path / name)


def change(session: Session, path: str, value: object) -> None:
    *way, last = path.split(".")
    object.__setattr__(reduce(getattr, way, session), last, value)


BREAKS: list[tuple[str, object, str]] = [
    ("simulator._robot.pose", (1.0, float("nan"), 0.0), "simulator._robot.pose.1. must be a number, got nan"),
    ("simulator._robot.pose", (1.0, 99.0, 0.0), "the robot's y must be a number from 0 to 9, got 99"),
    ("simulator.actors.opening", np.zeros(2), r"doors: opening must have shape \(3\)"),
    ("simulator.actors.walkers._towards", np.array([9, 0, 0]), "people must walk to a point of their path"),
    ("simulator.actors._next", 99, "the next line of the script must be a whole number"),
    ("simulator._frame.ranges_m", np.zeros(7, np.float32), r"the sonars must have shape \(8\), got \(7,\)"),
    ("simulator._sensors._image_rng", 3, "must be a Generator, got a int"),
    ("pilot._local._echoes", np.zeros((3, 2)), "echoes must have shape"),
    ("pilot._freeing._stay._heading", float("inf"), "the pilot's stay must be a number from"),
    ("pilot.mode", "asleep", "the mode must be one of explore, manual, goal, got 'asleep'"),
    ("pilot._seeker._closer._times", np.array([np.nan]), "times by the links must be numbers"),
    ("pilot._seeker._closer._ask_s", 9.0, "how long they are still taken for true must be a number from"),
    ("pilot._explorer._rng", np.random.default_rng(3), "must draw from one generator"),
    ("evaluation._count", 10**6, "the path's length must be a whole number"),
    ("evaluation._experience", np.full(4096, 77, np.int32), "active experiences must be from 0 to"),
    ("brain.local_view.params", None, "local_view"),
    ("seed", -1, "seed must be a whole number"),
    ("config", None, "config must be a Config"),
    ("more", 1, "a session differs in more"),
]


def test_a_session_that_breaks_a_law_is_refused_by_it(subtests: pytest.Subtests) -> None:
    begun = take_session(driven("living", 3))
    for path, value, words in BREAKS:
        session = restore_session(begun)
        change(session, path, value)
        with subtests.test(words), pytest.raises(ValueError, match=words):
            restore_session(take_session(session))


def test_a_loop_is_closed_where_times_are_known() -> None:
    """Else the robot would look up how far it is to an experience beyond the end of the list."""
    session = driven("living", 20)
    seeker = session.pilot._seeker
    seeker._last_leg, seeker._closer._goal, seeker._closer._times = seeker._closer, 1, np.ones(2)
    restore_session(take_session(session))
    seeker._closer._times = np.ones(1)
    with pytest.raises(ValueError, match="where a loop is to be closed must be a whole number from 0 to 0, got 1"):
        restore_session(take_session(session))


def test_a_world_that_is_none_is_refused() -> None:
    taken = take_session(driven("office", 2))
    at = next(k for k, array in enumerate(taken.arrays) if b'"to"' in array.tobytes())
    text = taken.arrays[at].tobytes().replace(b'"to"', b'"to": [1, 1], "tO"', 1)
    with pytest.raises(ValueError, match=r"its world: walls\[0\]\.tO: got .*; unknown key"):
        restore_session(State(taken.tree, [*taken.arrays[:at], np.frombuffer(text, np.uint8), *taken.arrays[at + 1 :]]))


def test_a_state_of_an_earlier_program_has_no_brain_in_front_and_is_read(tmp_path: Path) -> None:
    session = driven("office", 2)
    texts = [np.frombuffer(text.encode(), np.uint8) for text in session.source.world_texts]
    save_state(encode((*texts, session)), tmp_path / "state.npz")
    assert load_session(tmp_path / "state.npz").state_hash() == session.state_hash()
    with pytest.raises(
        ValueError, match=r"state.npz is no brain that can be taken back: a snapshot must hold a RatSlam"
    ):
        load_its_brain(tmp_path / "state.npz")
