"""Labels over a plate: none covers another, each is as near to where it belongs as that allows, and what is fixed stays."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.web.bench import Bench
from tests.unit.web.crowded import crowded
from web.viewer.camera_views import camera_for, seen_by
from web.viewer.primitives.labels import ERROR, GAP, GHOST, LEAN_RAD, NEAR, ROBOT, ROUTE, LabelRoom, clear_place

ROOM = np.array([(-5.0, -4.0), (5.0, 4.0)])
coordinates = st.floats(-6, 6)
bars = st.lists(st.tuples(coordinates, coordinates, st.floats(0.2, 3), st.floats(0.2, 1)), max_size=12)


def covered(at: np.ndarray, size: np.ndarray, taken: np.ndarray, gap: float = GAP) -> Any:
    """(n,) whether a bar at each place (n, 2), or at one (2,), would be nearer than a gap to one that is there."""
    apart = np.abs(taken[:, :2] - at[..., None, :]) - (taken[:, 2:] + size) / 2
    return (apart < gap - 1e-6).all(-1).any(-1)


@settings(max_examples=150)
@given(bars, coordinates, coordinates, st.integers(0, 2**32 - 1))
def test_the_place_is_the_nearest_that_is_free(made: list[tuple[float, ...]], x: float, y: float, seed: int) -> None:
    taken, at, size = np.array(made).reshape(-1, 4), np.array((x, y)), np.array((1.6, 0.4))
    place = clear_place(at, size, taken, ROOM, GAP)
    low, high = ROOM[0] + size / 2, ROOM[1] - size / 2
    assert ((place >= low - 1e-9) & (place <= high + 1e-9)).all()
    others = np.random.default_rng(seed).uniform(low, high, (300, 2))
    free = others[~covered(others, size, taken)]
    if covered(place, size, taken):
        assert not len(free)
    elif len(made) <= NEAR:
        best = np.clip(at, low, high)
        assert np.hypot(*(free - best).T).min(initial=np.inf) >= np.hypot(*(place - best)) - 1e-6


def test_who_comes_later_gives_way_and_returns_when_there_is_room_again() -> None:
    room = LabelRoom((5.0, 4.5))
    places: dict[str, tuple[float, float, float]] = {}

    def put(name: str, rank: int) -> None:
        room.put(name, rank, (0.0, 0.0, 0.5), (2.0, 0.4), lambda at: places.update({name: at}))

    put("ghost", GHOST)
    assert places["ghost"] == pytest.approx((0.0, 0.0, 0.5))
    put("error", ERROR)
    assert abs(places["error"][1]) > 0.4
    room.fix("names", [((0.1, 0.0, 0.5), 2.0, 0.4)])
    assert abs(places["ghost"][1]) > 0.4
    room.leave("ghost")
    room.fix("names", [])
    assert places["error"] == pytest.approx((0.0, 0.0, 0.5))


def test_no_label_lies_on_what_comes_before_it_and_none_moves_without_need() -> None:
    room, moves = LabelRoom((5.0, 4.5)), []
    for k in range(6):
        room.put(k, ROUTE, (0.5 * k, 0.0, 0.3), (1.0, 0.4), moves.append)
    room.fix("robot", [((0.0, 0.0, 0.2), 1.0, 1.0)], ROBOT)
    assert len(moves) == 6  # the robot drives under what belongs to its route,
    room.put("ghost", GHOST, (0.0, 0.0, 0.5), (2.0, 0.4), moves.append)
    assert len(moves) == 7  # and the ghost's name keeps clear of both
    seen = np.array([
        (x, y * np.cos(LEAN_RAD) + z * np.sin(LEAN_RAD), wide, 0.4)
        for (x, y, z), wide in zip(moves, [1.0] * 6 + [2.0], strict=True)
    ])  # fmt: skip
    robot = (0.0, 0.2 * np.sin(LEAN_RAD), 1.0, 1.0)
    assert not any(covered(seen[k, :2], seen[k, 2:], seen[:k]) for k in range(1, 7))
    assert not covered(seen[6, :2], seen[6, 2:], np.array([robot]))


def test_on_the_map_of_the_stage_no_label_covers_another(shared: Bench) -> None:
    shared.show(crowded(), 10.0)
    shared.settle()
    nodes = shared.nodes()
    pills = [f"/map/{name}" for name in ("ghost_label", "closure_label", "tags_0_pill", "error_label")]
    assert all(shared.visible(pill, nodes) for pill in pills)
    sign = nodes["/map/name_0"]
    places = np.array([sign["position"], *(nodes[pill]["position"] for pill in pills)])
    bars = [np.ptp(nodes[f"{pill}/bar"]["vertices"], 0)[:2] for pill in pills]
    sizes = np.array([(sign["render_width"], sign["render_height"]), *bars])
    for view in ("all", "map"):
        middles, larger = seen_by(camera_for(view, 1.4), places + nodes["/map"]["position"])
        seen = np.column_stack([middles, sizes * larger[:, None]])
        assert not any(covered(bar[:2], bar[2:], seen[:k], -0.01) for k, bar in enumerate(seen) if k)
