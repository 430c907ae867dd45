"""Times and routes against the papers' own relaxation."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import TemporalMap


class Links:
    """As much of an experience map as has to do with time."""

    def __init__(self, n: int, links: list[tuple[int, int, float]]) -> None:
        self._n = n
        self.links = np.array([(i, j) for i, j, _ in links], np.int64).reshape(-1, 2)
        self.link_times = np.array([t for _, _, t in links])

    def __len__(self) -> int:
        return self._n


def relax(n: int, links: list[tuple[int, int, float]], start: int) -> list[float]:
    """D10-12: t_j <- min(t_j, t_i + t_ij) over every link, both ways, until nothing changes."""
    times = [math.inf] * n
    times[start] = 0.0
    changed = True
    while changed:
        changed = False
        for i, j, t in links:
            for a, b in ((i, j), (j, i)):
                if times[a] + t < times[b]:
                    times[b] = times[a] + t
                    changed = True
    return times


@st.composite
def maps(draw: st.DrawFn) -> tuple[int, list[tuple[int, int, float]]]:
    n = draw(st.integers(1, 15))
    node = st.integers(0, n - 1)
    return n, draw(st.lists(st.tuples(node, node, st.floats(0.01, 100)), max_size=40))


@settings(max_examples=150, deadline=None)
@given(maps(), st.data())
def test_times_are_the_fixed_point_of_the_papers_relaxation(
    map_: tuple[int, list[tuple[int, int, float]]], data: st.DataObject
) -> None:
    n, links = map_
    times = TemporalMap(Links(n, links))  # type: ignore[arg-type]
    for goal in data.draw(st.lists(st.integers(0, n - 1), min_size=1, max_size=4)):
        assert times.times_to(goal) == pytest.approx(relax(n, links, goal))


@settings(max_examples=150, deadline=None)
@given(maps(), st.data())
def test_a_route_is_a_way_along_links_and_the_quickest(
    map_: tuple[int, list[tuple[int, int, float]]], data: st.DataObject
) -> None:
    n, links = map_
    ways = TemporalMap(Links(n, links))  # type: ignore[arg-type]
    for _ in range(3):
        start, goal = data.draw(st.integers(0, n - 1)), data.draw(st.integers(0, n - 1))
        route = ways.route(start, goal)
        best = relax(n, links, start)[goal]
        if route is None:
            assert best == math.inf
            continue
        nodes = route.experiences.tolist()
        assert (nodes[0], nodes[-1]) == (start, goal)
        assert len(set(nodes)) == len(nodes)
        quickest = {}
        for i, j, t in links:
            for pair in ((i, j), (j, i)):
                quickest[pair] = min(t, quickest.get(pair, math.inf))
        at = 0.0
        for k, pair in enumerate(pairwise(nodes), start=1):
            at += quickest[pair]
            assert route.arrival_s[k] == pytest.approx(at)
        assert route.arrival_s[0] == 0.0
        assert route.arrival_s[-1] == pytest.approx(best)


def test_of_parallel_links_the_quickest_counts() -> None:
    ways = TemporalMap(Links(2, [(0, 1, 5.0), (1, 0, 2.0), (0, 1, 3.0)]))  # type: ignore[arg-type]
    assert ways.times_to(1).tolist() == [2.0, 0.0]
    assert ways.times_to(0).tolist() == [0.0, 2.0]


def test_a_link_of_no_time_is_a_link() -> None:
    ways = TemporalMap(Links(3, [(0, 1, 0.0), (1, 2, 1.0)]))  # type: ignore[arg-type]
    assert ways.times_to(2) == pytest.approx([1.0, 1.0, 0.0], abs=0.01)
    route = ways.route(0, 2)
    assert route is not None
    assert route.experiences.tolist() == [0, 1, 2]


def test_what_cannot_be_reached() -> None:
    ways = TemporalMap(Links(4, [(0, 1, 1.0), (2, 3, 1.0)]))  # type: ignore[arg-type]
    assert ways.times_to(3).tolist() == [math.inf, math.inf, 1.0, 0.0]
    assert ways.route(0, 3) is None
    stay = ways.route(2, 2)
    assert stay is not None
    assert (stay.experiences.tolist(), stay.arrival_s.tolist()) == ([2], [0.0])


@pytest.mark.parametrize("bad", [-1, 4])
def test_unknown_experiences_are_refused(bad: int) -> None:
    ways = TemporalMap(Links(4, [(0, 1, 1.0)]))  # type: ignore[arg-type]
    message = f"experience must be from 0 to 3, got {bad}"
    for ask in (lambda: ways.times_to(bad), lambda: ways.route(bad, 0), lambda: ways.route(0, bad)):
        with pytest.raises(ValueError, match=message):
            ask()
