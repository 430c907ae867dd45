"""Labels over a plate: none covers another, each is as near to where it belongs as that allows, and what is fixed stays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.web.bench import Bench
from tests.unit.web.crowded import crowded
from web.viewer.camera_views import View, camera_for, seen_by
from web.viewer.marks.place_names import HEIGHT, Z
from web.viewer.primitives.label_room import ERROR, GAP, GHOST, LEAN_RAD, NEAR, ROBOT, ROUTE, LabelRoom, clear_place

ROOM = np.array([(-5.0, -4.0), (5.0, 4.0)])
coordinates = st.floats(-6, 6)
bars = st.lists(st.tuples(coordinates, coordinates, st.floats(0.2, 3), st.floats(0.2, 1)), max_size=12)


def covered(at: np.ndarray, size: np.ndarray, taken: np.ndarray, gap: float) -> bool:
    apart = np.abs(taken[:, :2] - at) - (taken[:, 2:] + size) / 2
    return bool((apart < gap - 1e-6).all(1).any())


@settings(max_examples=200)
@given(bars, coordinates, coordinates, st.integers(0, 2**32 - 1))
def test_the_place_is_the_nearest_that_is_free(made: list[tuple[float, ...]], x: float, y: float, seed: int) -> None:
    taken, at, size = np.array(made).reshape(-1, 4), np.array((x, y)), np.array((1.6, 0.4))
    place = clear_place(at, size, taken, ROOM, GAP)
    low, high = ROOM[0] + size / 2, ROOM[1] - size / 2
    assert (place >= low - 1e-9).all()
    assert (place <= high + 1e-9).all()
    others = np.random.default_rng(seed).uniform(low, high, (300, 2))
    free = [other for other in others if not covered(other, size, taken, GAP)]
    if covered(place, size, taken, GAP):
        assert not free
    elif len(made) <= NEAR:
        best = np.clip(at, low, high)
        assert all(np.hypot(*(other - best)) >= np.hypot(*(place - best)) - 1e-6 for other in free)


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
        room.put(k, ROUTE, (0.5 * k, 0.0, 0.3), (1.0, 0.4), lambda at: moves.append(at))
    room.fix("robot", [((0.0, 0.0, 0.2), 1.0, 1.0)], ROBOT)
    assert len(moves) == 6  # the robot drives under what belongs to its route,
    room.put("ghost", GHOST, (0.0, 0.0, 0.5), (2.0, 0.4), lambda at: moves.append(at))
    assert len(moves) == 7  # and the ghost's name keeps clear of both
    bars = np.array([(x, y * np.cos(LEAN_RAD) + z * np.sin(LEAN_RAD)) for x, y, z in moves])
    sizes = np.array([(1.0, 0.4)] * 6 + [(2.0, 0.4)])
    for k in range(7):
        assert not covered(bars[k], sizes[k], np.hstack([bars[:k], sizes[:k]]), GAP)
    assert not covered(bars[6], sizes[6], np.array([(0.0, 0.2 * np.sin(LEAN_RAD), 1.0, 1.0)]), GAP)


# ---------------------------------------------------------------- on the stage


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.viewer.stop()


@pytest.mark.parametrize("view", ["all", "map"])
def test_on_the_map_no_label_covers_another(bench: Bench, view: View) -> None:
    bench.show(crowded(), 10.0)
    bench.settle()
    plate = bench.viewer._scenery.map
    labels = {
        "ghost": bench.viewer._layers._judged.ghost._label,
        "closure": plate.closures._label,
        "tag": plate._tags._pills[0],
        "error": bench.viewer._layers._judged.doubt._label,
    }
    ((_, x, y, wide),) = plate.names._boxes
    boxes = [(np.array((x, y, Z)), wide, HEIGHT)]
    for name, label in labels.items():
        assert label.frame.visible, name
        boxes.append((np.array(label.frame.position), label.width, label._height))
    middles, larger = seen_by(camera_for(view, 1.4), np.array([at for at, _, _ in boxes]) + plate.origin)
    seen = np.column_stack([middles, np.array([size for _, *size in boxes]) * larger[:, None]])
    for k, bar in enumerate(seen):
        assert not covered(bar[:2], bar[2:], seen[k + 1 :], -0.01)
