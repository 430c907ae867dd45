"""The temporal map: how long it takes from any experience to any other, and the quickest route. ACRA 2006 section 4.

The papers' relaxation t_j <- min(t_j, t_i + t_ij) ends at the shortest times; Dijkstra's algorithm finds the same ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from disk import kind
from ratslam_core.pose_graph.pose_graph import PoseGraph
from ratslam_core.solvers import dijkstra
from ratslam_core.types import Floats, Ints, Ints32


@kind("route/1")
@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """The quickest way: experiences from here to the goal and the seconds at which each is reached."""

    experiences: Ints
    arrival_s: Floats


@kind("temporal map/1")
class TemporalMap:
    """Times over the links of an experience map, both ways along each link; of parallel links the quickest counts.

    It lives as long as its map and reads the map's own links, so nothing is rebuilt when links are added or removed.
    Every answer is exact for the links, their times and the places at the moment of asking. A goal may be several
    experiences, as those that stand for one place; then the quickest of them counts, at the cost of one. The tree of the
    last goal is kept. If nothing has changed, the answer is ready. Otherwise the tree is mended, at the cost of a pass over the
    links and of the nodes that have become quicker to reach. A mended answer equals a fresh one to the bit, so it does
    not matter who asks in between.

    [ours] With `experience_map.shortcut_m`, experiences that are closer than this in the map count as linked even
    without a link; the time is that of their distance at the robot's average pace (named as future work in IROS 2005).
    test_temporal_map.py::test_a_shortcut_saves_the_way_round.
    """

    CACHES = ("_goal", "_asked", "_times", "_parent")  # snapshots of the brain leave them out

    def __init__(self, graph: PoseGraph) -> None:
        self._map = graph
        self._goal: tuple[int, ...] | None = None
        self._asked: _Asked | None = None  # the links and places that the answer holds for
        self._times = np.zeros(0)
        self._parent = np.zeros(0, np.int32)

    def times_to(self, goal: int | Sequence[int], delays: Floats | None = None) -> Floats:
        """Seconds from every experience to this one (and back), or to the nearest in time of several, shape (n,); inf
        where no way is known. test_temporal_map.py::test_of_several_goals_the_quickest_counts.

        delays: seconds by which each row of the transitions takes longer now, shape (rows,); [ours], for what the robot
        knows to be in its way. test_temporal_map.py::test_a_delay_sends_the_robot_round.
        """
        self._answer(goal, delays)
        return self._times.copy()

    def route(self, start: int, goal: int | Sequence[int], delays: Floats | None = None) -> Route | None:
        """The quickest way, None when there is none. Among equal ways, the one over experiences with lower numbers."""
        self._require(start)
        self._answer(goal, delays)
        return self.route_again(start)

    def route_again(self, start: int) -> Route | None:
        """The quickest way to the goal that was asked for last, by the times of then. ValueError when none was."""
        self._require(start)
        if self._goal is None or self._asked is None or start >= len(self._times):
            raise ValueError(f"no times are known for experience {start!r}; ask for `times_to` a goal first")
        if not np.isfinite(self._times[start]):
            return None
        nodes = dijkstra.trace(start, self._times, self._asked.links, self._asked.near)
        return Route(nodes, self._times[start] - self._times[nodes])

    def _answer(self, goal: int | Sequence[int], delays: Floats | None) -> _Asked:
        """Bring times and tree up to date for this goal; returns what they hold for."""
        goals = (goal,) if isinstance(goal, int | np.integer) else tuple(goal)
        if not goals:
            raise ValueError("goal must be an experience or several, got none")
        for experience in goals:
            self._require(experience)
        asked, before, n = _Asked(self._map, delays), self._asked, len(self._map)
        if goals != self._goal or before is None:
            self._times, self._parent = np.empty(n), np.empty(n, np.int32)
            dijkstra.fresh(np.array(goals, np.int64), self._times, self._parent, asked.links, asked.near)
        elif not asked.same_as(before):
            new = np.full(n - len(self._parent), -1, np.int32)
            self._times, self._parent = np.empty(n), np.concatenate([self._parent, new])
            dijkstra.mend(np.array(goals, np.int64), self._times, self._parent, asked.links, asked.near)
        self._goal, self._asked = goals, asked
        return asked

    def _require(self, experience: int) -> None:
        if not 0 <= experience < len(self._map):
            raise ValueError(f"experience must be from 0 to {len(self._map) - 1}, got {experience!r}")


class _Asked:
    """Links, their times, and for shortcuts the places, as they are now."""

    def __init__(self, map_: PoseGraph, delays: Floats | None) -> None:
        graph, reach = map_.transitions.graph, float(map_.params.shortcut_m)
        self.seconds = np.maximum(map_.transitions.seconds(map_.poses, map_.pace), dijkstra.LEAST_S)
        if delays is not None:
            self.seconds += delays
        self.changes, self.reach, self.pace = graph.changes, reach, map_.pace
        self.poses = map_.poses.copy() if reach > 0 else map_.poses
        none: tuple[Ints32, Ints32] = np.zeros(0, np.int32), np.zeros(0, np.int32)
        grid = dijkstra.buckets(self.poses, reach) if reach > 0 else none
        self.links = graph.start, graph.used, graph.half, graph.other, self.seconds
        self.near = self.poses, reach, self.pace, *grid

    def same_as(self, other: _Asked) -> bool:
        same = self.changes == other.changes and self.reach == other.reach
        if not same or not np.array_equal(self.seconds, other.seconds):
            return False
        return self.reach == 0 or (self.pace == other.pace and np.array_equal(self.poses, other.poses))
