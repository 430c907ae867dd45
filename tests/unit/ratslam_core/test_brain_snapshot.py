"""Snapshots of a brain: a restored one goes on as if it had never stopped, and what is written is arrays and plain JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from disk import State, decode, encode
from disk.state_codec import LONG
from ratslam_core import RatSlam, load_brain, restore_snapshot, save_brain, take_snapshot
from tests.unit.ratslam_core.drives import Circle, drive, driven


@pytest.mark.slow
def test_a_restored_brain_goes_on_as_if_it_had_never_stopped(tmp_path: Path) -> None:
    for ticks in (1, 420):
        circle, brain = driven(ticks)
        if ticks == 420:
            circle.angle += 2.6  # lost, with competing packets
            drive(circle, brain, 1)
            assert brain.lost
        save_brain(brain, tmp_path / "brain.npz")
        copies = [restore_snapshot(take_snapshot(brain)), load_brain(tmp_path / "brain.npz")]
        here = circle.angle
        drive(circle, brain, 200)
        for copy in copies:
            circle.angle = here
            drive(circle, copy, 200)
            assert copy.digest() == brain.digest()
            assert copy.rng.random() == np.random.default_rng(5).random()
            assert copy.pose_cells.activity.tobytes() == brain.pose_cells.activity.tobytes()
            assert copy.experience_map.poses.tobytes() == brain.experience_map.poses.tobytes()
            assert copy.params == brain.params


def test_who_asked_for_times_is_not_part_of_the_brain() -> None:
    _, brain = driven(50)
    before = take_snapshot(brain).digest()
    times = brain.experience_map.temporal_map.times_to(3)
    assert take_snapshot(brain).digest() == before
    copy = restore_snapshot(take_snapshot(brain))
    assert np.array_equal(copy.experience_map.temporal_map.times_to(3), times)


def test_a_snapshot_is_a_copy_of_arrays_and_plain_json() -> None:
    circle, brain = driven(50)
    snapshot = take_snapshot(brain)
    before = snapshot.digest()
    drive(circle, brain, 50)
    assert snapshot.digest() == before != take_snapshot(brain).digest()
    assert json.loads(json.dumps(snapshot.tree, allow_nan=False)) == snapshot.tree
    assert all(isinstance(array, np.ndarray) and array.dtype != object for array in snapshot.arrays)
    one, other = restore_snapshot(snapshot), restore_snapshot(snapshot)
    drive(circle, one, 20)
    assert take_snapshot(other).digest() == before


@pytest.mark.slow
def test_nothing_in_the_json_grows_with_the_map() -> None:
    circle, brain = driven(400)
    drive(Circle(4), brain, 400)  # other views, so that there are many
    sizes = []
    for _ in range(3):
        sizes.append(len(json.dumps(take_snapshot(brain).tree)))
        drive(circle, brain, 400)
    assert max(sizes) - min(sizes) < 1000
    assert brain.experience_map.link_count > LONG


@given(
    st.lists(st.integers(), max_size=60) | st.lists(st.floats(), max_size=60)
    | st.lists(st.tuples(st.integers(-5, 2**63), st.integers(0, 9)), max_size=60)
    | st.lists(st.integers(0, 3) | st.booleans() | st.floats() | st.text(max_size=3), max_size=60)
)  # fmt: skip
@pytest.mark.slow
def test_lists_and_tables_come_back_as_they_were(items: list[Any]) -> None:
    for value in (items, dict(enumerate(items)), {item: k for k, item in enumerate(items)}):
        state = encode(value)
        text = json.dumps(state.tree, allow_nan=False)
        assert repr(decode(State(json.loads(text), state.arrays))) == repr(value)
        assert len(text) < 10_000


def test_what_is_wrong_is_told_in_a_sentence_however_long_it_is() -> None:
    for where, words in (("kind", "^no class is of the kind 'aaaa"), ("same", "^it lacks 'aaaa")):
        snapshot = take_snapshot(RatSlam())
        snapshot.tree["state"][where] = "a" * 10_000
        with pytest.raises(ValueError, match=words) as refused:
            restore_snapshot(snapshot)
        assert len(str(refused.value)) < 500
