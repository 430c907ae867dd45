"""What goes in comes out again. What has no kind is refused in a sentence that says how to give it one."""

from __future__ import annotations

import io
import json
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from disk import State, copy_state, decode, encode, kind, read_state, write_state


@kind("test walk/1")
class Walk:
    CACHES = ("_drawn",)

    def __init__(self, seed: int = 0) -> None:
        self.rng = np.random.default_rng(seed)
        self.way = np.zeros((3, 2))
        self.behind: deque[int] = deque([1, 2], maxlen=2)
        self.seen = {3, 1}
        self.other: Walk | None = None
        self._drawn: object = "a picture"


@kind("test step/1")
@dataclass(frozen=True, slots=True)
class Step:
    length_m: float

    def __post_init__(self) -> None:
        if self.length_m < 0:
            raise ValueError(f"length_m must be at least 0, got {self.length_m}")


def there_and_back(value: Any) -> Any:
    file = io.BytesIO()
    write_state(encode(value), file)
    return decode(read_state(file))


PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
TREES = st.recursive(
    PLAIN | st.builds(deque, st.lists(PLAIN, max_size=3)),
    lambda inner: st.lists(inner, max_size=40) | st.tuples(inner, inner) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=12,
)


@given(TREES | st.sets(st.integers(), max_size=40))
def test_plain_values_come_back_as_they_were(value: Any) -> None:
    for back in (there_and_back(value), copy_state(value)):
        assert back == value if isinstance(value, set) else repr(back) == repr(value)  # as text, nan equals nan
    assert encode(there_and_back(value)).digest() == encode(value).digest()


def test_objects_come_back_with_all_but_their_caches() -> None:
    walk = Walk(7)
    walk.other, walk.rng = walk, np.random.default_rng(9)
    walk.rng.random()
    for back in (there_and_back(walk), copy_state(walk)):
        assert back.other is back
        assert back._drawn is None
        assert (back.behind, back.behind.maxlen, back.seen) == (deque([1, 2]), 2, {1, 3})
        assert back.way is not walk.way
        assert encode(back).digest() == encode(walk).digest()
    assert there_and_back(walk).rng.random() == copy_state(walk).rng.random() == walk.rng.random()


def test_a_state_names_kinds_and_no_module() -> None:
    text = json.dumps(encode([Walk(), Step(1.0)]).tree)
    assert __name__ not in text
    assert '"test walk/1"' in text


def test_what_a_state_must_not_hold_is_refused_and_told_how_it_may() -> None:
    class Foreign:
        pass

    for use in (encode, copy_state):
        with pytest.raises(TypeError, match=r'must not hold a .*\.Foreign: name its class with @kind\("name/1"\)'):
            use([Foreign()])
    for array in (np.ones(2, complex), np.array(["a"]), np.array([None])):
        with pytest.raises(
            TypeError, match=r"a state must not hold an array of .*: numbers, true or false, nothing else"
        ):
            encode([array])


def test_a_kind_has_a_name_and_a_version_and_is_one_class_which_may_be_read_again_after_a_reload() -> None:
    for name in ("walk", "walk/0", "Walk/1", "/1", "a" * 99 + "/1", "walk/1/2", "wälk/1"):
        with pytest.raises(ValueError, match="a kind must be a name and a version"):
            kind(name)
    with pytest.raises(ValueError, match=r"the kind 'test walk/1' is .*\.Walk; give Other another"):
        kind("test walk/1")(type("Other", (), {}))
    again = type("Walk", (Walk,), {"__module__": Walk.__module__, "__qualname__": Walk.__qualname__})
    assert kind("test walk/1")(again) is again
    assert type(there_and_back(Walk())) is again
    kind("test walk/1")(Walk)


def changed(value: Any, **change: Any) -> State:
    state = encode(value)
    state.tree["state"].update(change)
    return state


def test_what_cannot_be_taken_back_is_named(subtests: pytest.Subtests) -> None:
    wider = {"length_m": 1.0, "width_m": 2.0}
    for state, words in (
        (changed(Step(1.0), kind="test step/2"), "test step/2 was made by another version .* has test step/1"),
        (changed(Step(1.0), kind="their step/1"), "no class is of the kind 'their step/1': .* import its file first"),
        (changed(Step(1.0), state={"length_m": -1.0}), "length_m must be at least 0"),
        (changed(Step(1.0), state=wider), "Step differs in width_m: made by another version"),
        (changed(Walk(), state={"_drawn": 3}), r"Walk\._drawn must be left out"),
        (State({"format": 1, "brain": {}}, []), "of format 1, which an unreleased version wrote"),
        (State({}, []), "format must be 3, got None"),
    ):
        with subtests.test(words), pytest.raises((ValueError, AttributeError), match=words):
            decode(state)
