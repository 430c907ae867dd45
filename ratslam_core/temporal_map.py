"""The temporal map: how long it takes from any experience to any other, and the quickest route. ACRA 2006 section 4.

The papers' relaxation t_j <- min(t_j, t_i + t_ij) ends at the shortest times; Dijkstra's algorithm finds the same ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from ratslam_core.experience_map import ExperienceMap

LEAST_S = 1e-3  # a link of no time would vanish from a sparse matrix


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """The quickest way: experiences from here to the goal and the seconds at which each is reached."""

    experiences: NDArray[np.int64]
    arrival_s: NDArray[np.float64]


class TemporalMap:
    """Times over the links of an experience map, both ways along each link."""

    def __init__(self, experiences: ExperienceMap) -> None:
        n, links = len(experiences), experiences.links
        self._size = n
        self._answer: tuple[int, NDArray[np.float64], NDArray[np.int32]] | None = None
        time = np.maximum(experiences.link_times, LEAST_S)
        i = np.concatenate([links[:, 0], links[:, 1]])
        j = np.concatenate([links[:, 1], links[:, 0]])
        both = np.concatenate([time, time])
        order = np.lexsort((both, j, i))  # of parallel links the quickest comes first and is kept
        i, j, both = i[order], j[order], both[order]
        keep = np.ones(len(i), bool)
        keep[1:] = (i[1:] != i[:-1]) | (j[1:] != j[:-1])
        self._graph = csr_matrix((both[keep], (i[keep], j[keep])), (n, n))

    def times_to(self, experience: int) -> NDArray[np.float64]:
        """Seconds from every experience to this one (and back), shape (n,); inf where no way is known."""
        return self._tree(experience)[0]

    def route(self, start: int, goal: int) -> Route | None:
        """The quickest way, None when there is none."""
        self._require(start)
        times, following = self._tree(goal)
        if not np.isfinite(times[start]):
            return None
        path = [start]
        while path[-1] != goal:
            path.append(int(following[path[-1]]))
        nodes = np.array(path)
        return Route(nodes, times[start] - times[nodes])

    def _tree(self, goal: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Times to the goal and the next experience on the way there; the last answer is kept."""
        self._require(goal)
        if self._answer is None or self._answer[0] != goal:
            self._answer = (goal, *dijkstra(self._graph, indices=goal, return_predecessors=True))
        return self._answer[1:]

    def _require(self, experience: int) -> None:
        if not 0 <= experience < self._size:
            raise ValueError(f"experience must be from 0 to {self._size - 1}, got {experience!r}")
