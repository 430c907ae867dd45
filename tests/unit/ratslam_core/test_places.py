"""Places, multiple representations and hash collisions, against loops over all pairs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMap, ExperienceMapParams, Packet, Pose2, find_places
from ratslam_core.experience_map import places
from ratslam_core.experience_map.places import HashCollision, MultipleRepresentation, Places

from .literal import also_interpreted

SHAPES = [(36, 64, 64), (36, 8, 8), (10, 9, 21)]
CELL_M = 0.25


def a_map(rows, shape=(36, 64, 64), **params: float) -> ExperienceMap:
    """rows: x, y (m), facing in the map; x', y' in cells, heading of the pose cells."""
    made = ExperienceMap(shape, CELL_M, ExperienceMapParams(**params))  # type: ignore[arg-type]
    for view, (x, y, facing, cell_x, cell_y, heading) in enumerate(rows):
        made._experiences.add(Packet(cell_x, cell_y, heading, 1.0), view, Pose2(x, y, facing))
    return made


def round_ring(a: float, b: float, ring: float) -> float:
    return min(abs(a - b), abs(a - b - ring), abs(a - b + ring))


def literal_places(made: ExperienceMap, radius: float) -> tuple[list[int], list[int], list, list]:
    """The result of `find_places`, straight from its definition."""
    poses, states, (n_theta, n_y, n_x) = made.poses, made.cell_states, made.shape
    zone_xy, zone_theta, n = made.params.zone_xy, made.params.zone_theta, len(made)

    def metres(i: int, j: int) -> float:
        return math.sqrt((poses[i, 0] - poses[j, 0]) ** 2 + (poses[i, 1] - poses[j, 1]) ** 2)

    def cells(i: int, j: int) -> float:
        dx, dy = round_ring(states[i, 0], states[j, 0], n_x), round_ring(states[i, 1], states[j, 1], n_y)
        return math.sqrt(dx**2 + dy**2)

    def layers(i: int, j: int) -> float:
        return round_ring(states[i, 2], states[j, 2], n_theta)

    def turned(i: int, j: int) -> float:
        return abs(math.remainder(poses[i, 2] - poses[j, 2], 2 * math.pi))

    def leaders(near, among=None) -> list[int]:
        leader: list[int] = []
        for i in range(n):
            own = [j for j in range(i) if leader[j] == j and near(i, j) and (among is None or among[i] == among[j])]
            leader.append(own[0] if own else i)
        return leader

    place = leaders(lambda i, j: metres(i, j) <= radius)
    first = sorted(set(place))
    facing = zone_theta * 2 * math.pi / n_theta
    wide = 2 * radius / CELL_M + zone_xy
    of_state = leaders(
        lambda i, j: cells(i, j) <= wide and layers(i, j) <= 2 * zone_theta and turned(i, j) <= facing, place
    )
    kinds = [i for i in range(n) if of_state[i] == i]
    multiple = []
    for k, name in enumerate(first):
        own = [i for i in kinds if place[i] == name]
        several = [i for i in own if any(i != j and turned(i, j) <= facing for j in own)]
        if several:
            multiple.append(MultipleRepresentation(k, tuple(several)))
    state = leaders(lambda i, j: cells(i, j) <= zone_xy and layers(i, j) <= zone_theta)
    far = 2 * radius + 2 * zone_xy * CELL_M
    apart = leaders(lambda i, j: metres(i, j) <= far, state)
    collisions = []
    for name in sorted(set(state)):
        own = [i for i in range(n) if state[i] == name and apart[i] == i]
        if len(own) > 1:
            collisions.append(HashCollision(*(float(v) for v in states[name]), experiences=tuple(own)))
    return first, [first.index(p) for p in place], multiple, collisions


def agree(found: Places, literal: tuple) -> None:
    assert found.first.tolist() == literal[0]
    assert found.place_of.tolist() == literal[1]
    assert list(found.multiple_representations) == literal[2]
    assert list(found.hash_collisions) == literal[3]


metre = st.one_of(st.floats(-3, 3), st.sampled_from([0.0, 0.5, 1.0, -1.0]))
angle = st.one_of(st.floats(-3.1, 3.1), st.sampled_from([0.0, math.pi, -3.0]))
cell = st.one_of(st.floats(0, 63.9), st.sampled_from([0.0, 8.0, 63.9, 20.0]))
rows = st.lists(st.tuples(metre, metre, angle, cell, cell, angle), max_size=30)


@settings(max_examples=200)
@given(rows, st.sampled_from(SHAPES), st.sampled_from([0.3, 0.5, 1.5]), st.sampled_from([0.5, 2.0, 20.0]))
@pytest.mark.slow
def test_places_are_those_of_a_loop_over_all(made, shape, radius: float, zone: float) -> None:
    known = a_map(made, shape, zone_xy=zone, zone_theta=min(zone, 5.0))
    agree(find_places(known, radius), literal_places(known, radius))


@also_interpreted(places)
def test_places_that_are_both_in_two_and_two_in_one_are_found() -> None:
    rng = np.random.default_rng(5)
    lows, highs = (-2, -2, -3, 0, 0, -3), (2, 2, 3, 12, 12, 3)
    known = a_map(rng.uniform(lows, highs, (60, 6)).tolist(), zone_theta=9.0)
    found = find_places(known, 0.5)
    agree(found, literal_places(known, 0.5))
    assert found.multiple_representations
    assert found.hash_collisions


def test_a_corridor_with_two_paths_through_the_cells_has_two_representations() -> None:
    """B figure 4, D and E: the same corridor, driven the same way, in two parts of the pose cells."""
    one = [(0.6 * k, 0.0, 0.0, 10 + 2.4 * k, 10.0, 0.0) for k in range(5)]
    other = [(0.6 * k, 0.1, 0.05, 10 + 2.4 * k, 40.0, 0.3) for k in range(5)]
    back = [(0.6 * k, 0.1, math.pi, 10 + 2.4 * k, 10.0, math.pi) for k in range(5)]  # facing the other way
    found = find_places(a_map(one + other + back), 0.5)
    assert len(found.first) == 5
    assert [m.experiences for m in found.multiple_representations] == [(k, 5 + k) for k in range(5)]
    assert [m.place for m in found.multiple_representations] == list(range(5))
    assert found.hash_collisions == ()
    assert np.flatnonzero(found.place_of == found.place_of[7]).tolist() == [2, 7, 12]


def test_cells_that_stand_for_two_places_collide() -> None:
    """B figure 4, F for B and C: the same pose cells, two places of the floor."""
    here = [(0.5 * k, 0.0, 0.0, 20 + 2.0 * k, 20.0, 0.0) for k in range(4)]
    there = [(0.5 * k, 9.0, 1.0, 20 + 2.0 * k, 20.3, 0.1) for k in range(4)]
    elsewhere = [(0.5 * k, 20.0, 1.0, 20 + 2.0 * k, 50.0, 0.1) for k in range(4)]
    found = find_places(a_map(here + there + elsewhere), 0.5)
    assert found.multiple_representations == ()
    assert len(found.hash_collisions) == 2  # the zone of the first holds the second
    for collision in found.hash_collisions:
        i, j = collision.experiences
        assert i < 4 <= j < 8
        assert collision.y == 20.0


def test_what_is_no_radius_is_refused() -> None:
    for radius in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="radius_m must be a positive number of metres, got"):
            find_places(a_map([]), radius)


FACING = math.pi / 2  # 9 layers of 36


def test_what_is_just_as_far_as_a_limit_is_within_it(subtests: pytest.Subtests) -> None:
    """Places, states, facings and distances in the map; a little beyond, the answer is another."""

    def counts(zones: dict[str, float], changed: dict[str, float]) -> tuple[int, int, int]:
        first = {"x": 0.0, "y": 0.0, "facing": 0.0, "cell_x": 20.0, "cell_y": 20.0, "heading": 0.0}
        made = find_places(a_map([tuple(first.values()), tuple((first | changed).values())], **zones), 0.5)
        return len(made.first), len(made.multiple_representations), len(made.hash_collisions)

    for zone_theta, other, what, at, beyond, found in (
        (2.0, {}, "x", 0.5, 0.51, (1, 0, 0)),
        (2.0, {}, "y", -0.5, -0.51, (1, 0, 0)),
        (2.0, {}, "cell_x", 26.0, 26.1, (1, 0, 0)),  # the width of a place, 4 cells, and a zone of 2
        (2.0, {}, "cell_y", 26.0, 26.1, (1, 0, 0)),
        (4.5, {}, "heading", FACING, FACING + 0.1, (1, 0, 0)),
        (9.0, {"cell_x": 40.0}, "facing", FACING, FACING + 0.1, (1, 1, 0)),
        (2.0, {"x": 9.0}, "cell_x", 22.0, 22.1, (2, 0, 1)),
        (2.0, {"x": 9.0}, "cell_y", 18.0, 17.9, (2, 0, 1)),
        (9.0, {"x": 9.0}, "heading", FACING, FACING + 0.1, (2, 0, 1)),
        (2.0, {}, "y", 2.0, 2.1, (2, 0, 0)),  # the widths of a place, 1 m, and of a zone, 1 m
    ):
        with subtests.test(what, at=at, **other):
            assert counts({"zone_theta": zone_theta}, other | {what: at}) == found
            assert counts({"zone_theta": zone_theta}, other | {what: beyond}) != found
    assert counts({"zone_theta": 9.0}, {"facing": FACING}) == (1, 0, 0)  # one state, facing just within the limit
