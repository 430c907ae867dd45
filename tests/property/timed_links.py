"""Links of an experience map as the temporal map needs them, made at random; and the papers' own relaxation over them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra as scipy_dijkstra

from ratslam_core import ExperienceMapParams, TemporalMap
from ratslam_core.pose_graph.transitions import Transitions

LEAST_S = 1e-3


@dataclass
class Links:
    """The part of an experience map that has to do with time."""

    poses: np.ndarray
    pace: float = 0.0
    params: ExperienceMapParams = field(default_factory=ExperienceMapParams)
    transitions: Transitions = field(default_factory=Transitions)

    def __post_init__(self) -> None:
        for _ in self.poses:
            self.transitions.graph.add_node()

    def __len__(self) -> int:
        return len(self.poses)

    def place(self, x: float, y: float) -> None:
        self.poses = np.concatenate([self.poses, [[x, y, 0.0]]])
        self.transitions.graph.add_node()

    def link(self, i: int, j: int, time_s: float) -> int:
        row = self.transitions.add(i, j, travelled=True)
        self.transitions.time_s[row] = time_s
        return row

    def unlink(self, row: int) -> None:
        i, j = self.transitions.ends[row].tolist()
        self.transitions.graph.remove_link(i, j, row)
        self.transitions.travelled[row] = False

    @property
    def quickest(self) -> dict[tuple[int, int], float]:
        """Seconds from one experience directly to another, by definition."""
        t, least = self.transitions, {}
        for row in range(t.count):
            i, j = t.ends[row].tolist()
            if t.travelled[row]:
                time = max(t.time_s[row], self.pace * math.dist(self.poses[i, :2], self.poses[j, :2]), LEAST_S)
                least[i, j] = least[j, i] = min(time, least.get((i, j), math.inf))
        apart = np.hypot(*(self.poses[:, None, :2] - self.poses[:, :2]).transpose(2, 0, 1))
        near = np.argwhere(apart < self.params.shortcut_m).tolist()
        shortcuts = {(i, j): max(LEAST_S, self.pace * apart[i, j]) for i, j in near if i != j and (i, j) not in least}
        return least | shortcuts


def links(n: int, of: list[tuple[int, int, float]]) -> Links:
    map_ = Links(np.zeros((n, 3)))
    for link in of:
        map_.link(*link)
    return map_


def ways_of(map_: Links) -> TemporalMap:
    return TemporalMap(map_)  # type: ignore[arg-type]


def relax(map_: Links, start: int) -> list[float]:
    """D10-12: t_j <- min(t_j, t_i + t_ij) over every link, both ways, until nothing changes."""
    times, quickest = [math.inf] * len(map_), map_.quickest
    times[start] = 0.0
    changed = True
    while changed:
        changed = False
        for (a, b), t in quickest.items():
            if times[a] + t < times[b]:
                times[b] = times[a] + t
                changed = True
    return times


def by_scipy(map_: Links, start: int) -> np.ndarray:
    quickest = map_.quickest
    ends = np.array(list(quickest), int).reshape(-1, 2)
    matrix = csr_matrix((list(quickest.values()), ends.T), (len(map_), len(map_)))
    return scipy_dijkstra(matrix, indices=start)


def check_route(map_: Links, ways: TemporalMap, start: int, goal: int) -> None:
    route, best, quickest = ways.route(start, goal), relax(map_, goal)[start], map_.quickest
    again = ways.route_again(start)
    assert (route is None) == (again is None)
    if route is not None and again is not None:
        assert np.array_equal(route.experiences, again.experiences)
        assert np.array_equal(route.arrival_s, again.arrival_s)
    if route is None:
        assert best == math.inf
        return
    nodes = route.experiences.tolist()
    assert (nodes[0], nodes[-1]) == (start, goal)
    assert len(set(nodes)) == len(nodes)
    at = 0.0
    for k, pair in enumerate(pairwise(nodes), start=1):
        at += quickest[pair]
        assert route.arrival_s[k] == pytest.approx(at)
    assert route.arrival_s[0] == 0.0
    assert route.arrival_s[-1] == pytest.approx(best)


def change(map_: Links, data: st.DataObject) -> None:
    """Change something in the map."""
    n, t = len(map_), map_.transitions
    node, seconds = st.integers(0, n - 1), st.floats(0, 30)
    what = data.draw(st.sampled_from(["place", "link", "link", "link", "unlink", "time", "move", "pace", "shortcut"]))
    if what == "place":
        map_.place(data.draw(st.floats(-3, 3)), data.draw(st.floats(-3, 3)))
    elif what == "link":
        map_.link(data.draw(node), data.draw(node), data.draw(seconds))
    elif what == "unlink" and t.travelled.any():
        map_.unlink(data.draw(st.sampled_from(np.flatnonzero(t.travelled).tolist())))
    elif what == "time" and t.count:
        t.time_s[data.draw(st.integers(0, t.count - 1))] = data.draw(seconds)
    elif what == "move":
        map_.poses[data.draw(node), :2] = data.draw(st.tuples(st.floats(-3, 3), st.floats(-3, 3)))
    elif what == "pace":
        map_.pace = data.draw(st.floats(0, 5))
    elif what == "shortcut":
        map_.params = replace(map_.params, shortcut_m=data.draw(st.sampled_from([0.0, 0.3, 2.0])))
