"""`state_hash` covers everything: each value of each part is changed by itself, and the hash differs each time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest

from app.session import Session
from disk.kinds import attributes, is_known
from ratslam_core import Pose2
from sim2d import load_world

Put = Callable[[Any], None]
PARTS = ("config", "simulator", "pilot", "brain", "evaluation")


def a_full_session() -> Session:
    """It contains everything: doors, people, a goal and its route, a bar, a kidnap, a laser."""
    made = Session(load_world("living"), 8)
    made.set_parameters({"robot.laser_beams": 11})
    for tick in range(300):
        if tick == 100:
            made.kidnap()
        if tick == 240:
            map_ = made.brain.experience_map
            made.pilot.set_goal(int(np.argmax(map_.submap_of == map_.submaps.current)))  # where it was put down
        made.tick()
    follower = made.pilot._follower
    assert follower is not None
    assert follower._route is not None
    made.pilot._bars.add(Pose2(0.0, 0.0, 0.0), 0.0, made.pilot.params)
    return made


def leaves(name: str, value: Any, put: Put, seen: set[int]) -> Iterator[tuple[str, Any, Put]]:
    """Path and value of each leaf, and how to replace it; of long lists, the first two and the last."""
    if isinstance(value, tuple):
        for k, part in enumerate(value[:6]):
            yield from leaves(f"{name}[{k}]", part, lambda new, k=k: put((*value[:k], new, *value[k + 1 :])), seen)
        return
    if id(value) in seen and (is_known(type(value)) or isinstance(value, list | dict)):
        return
    seen.add(id(value))
    if is_known(type(value)):
        for attribute, item in attributes(value).items():
            if attribute not in getattr(value, "CACHES", ()):
                set_it = lambda new, attribute=attribute: object.__setattr__(value, attribute, new)  # noqa: E731
                yield from leaves(f"{name}.{attribute}", item, set_it, seen)
    elif isinstance(value, list):
        for k in sorted({*range(len(value))} & {0, 1, len(value) - 1}):
            yield from leaves(f"{name}[{k}]", value[k], lambda new, k=k: value.__setitem__(k, new), seen)
    elif isinstance(value, dict):
        for key in [*value][:2]:
            yield from leaves(f"{name}[{key}]", value[key], lambda new, key=key: value.__setitem__(key, new), seen)
    else:
        yield name, value, put


def another(value: Any) -> Any:
    """Another value of the same kind."""
    if value is None:
        return 1.5
    if isinstance(value, bool | np.bool_):
        return not value
    if isinstance(value, str):
        return f"{value}."
    if isinstance(value, int | np.integer):
        return type(value)(int(value) ^ 1)
    if isinstance(value, float | np.floating):
        return type(value)(-value if np.isfinite(value) and value else 7.0)
    if isinstance(value, np.random.Generator):
        other = np.random.default_rng()
        other.bit_generator.state = value.bit_generator.state
        other.random()
        return other
    if isinstance(value, np.ndarray):
        changed = value.copy()
        if changed.size:
            changed.flat[changed.size // 2] = another(changed.flat[changed.size // 2])
            return changed
        return np.zeros((*changed.shape[:-1], 1) if changed.ndim > 1 else 1, changed.dtype)
    return type(value)([*value, 1])  # an empty set or queue


@pytest.mark.slow
def test_each_field_of_each_part_changes_the_hash() -> None:
    session = a_full_session()
    then, seen, count = session.state_hash(), set[int](), dict[str, int]()
    for part in ("seed", *PARTS):
        put_part = partial(setattr, session, part)
        for name, value, put in leaves(part, getattr(session, part), put_part, seen):
            put(another(value))
            assert session.state_hash() != then, f"{name} is not in the hash"
            put(value)
            count[part] = count.get(part, 0) + 1
    assert session.state_hash() == then
    assert count["seed"] == 1
    assert all(count[part] > least for part, least in zip(PARTS, (80, 60, 40, 80, 12), strict=True)), count
    session.office.world = load_world("office")
    assert session.state_hash() != then
