"""A copy is the same brain, shares nothing that can change, and goes on independently."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from disk import copy_state, encode
from disk.kinds import attributes
from ratslam_core import restore_snapshot, take_snapshot
from tests.unit.ratslam_core.drives import drive, driven


def held(value: object, found: dict[int, object] | None = None) -> dict[int, object]:
    """Every array, table, list and object that can be reached from a value."""
    found = {} if found is None else found
    if id(value) in found or isinstance(value, int | float | str | np.generic | type(None)):
        return found
    if not isinstance(value, tuple):
        found[id(value)] = value
    if isinstance(value, dict):
        items = [*value.keys(), *value.values()]
    elif isinstance(value, list | tuple):
        items = list(value)
    elif isinstance(value, np.ndarray | np.random.Generator):
        items = []
    else:
        items = list(attributes(value).values())
    for item in items:
        held(item, found)
    return found


def test_a_copy_is_equal_and_goes_on_equally() -> None:
    circle, brain = driven(250)
    copy = copy_state(brain)
    assert copy.digest() == brain.digest()
    here = circle.angle
    drive(circle, brain, 60)
    after = circle.angle
    assert copy.digest() != brain.digest()
    circle.angle = here
    drive(circle, copy, 60)
    assert circle.angle == after
    assert copy.digest() == brain.digest()
    assert copy.rng.random() == brain.rng.random()


def test_a_copy_shares_nothing_that_can_change_and_what_is_one_object_stays_one() -> None:
    _, brain = driven(120)
    copy = copy_state(brain)
    mine, others = held(brain), held(copy)
    assert [type(value) for key, value in mine.items() if key in others] == []
    for array in (value for value in others.values() if isinstance(value, np.ndarray)):
        assert not any(np.shares_memory(array, other) for other in mine.values() if isinstance(other, np.ndarray))
    assert copy.local_view.params is copy.view_links.params
    assert len(others) == len(mine)


def test_snapshots_of_a_copy_are_those_of_the_brain_and_copy_no_array_again() -> None:
    """There is no room for three copies of a large brain."""
    _, brain = driven(50)
    copy = copy_state(brain)
    snapshot = encode(copy)
    assert snapshot.tree == take_snapshot(brain).tree
    assert snapshot.digest() == brain.digest().hex()
    assert restore_snapshot(snapshot).digest() == brain.digest()
    ours = {id(array) for array in held(copy).values() if isinstance(array, np.ndarray)}
    large = [array for array in snapshot.arrays if array.nbytes > 1000]
    assert large
    assert all(id(array) in ours for array in large)


def test_what_the_engine_does_not_own_is_not_copied() -> None:
    _, brain = driven(2)
    brain.experience_map.transitions.dropped.append(Path())  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"a state must not hold a pathlib\.\w*Path"):
        copy_state(brain)
