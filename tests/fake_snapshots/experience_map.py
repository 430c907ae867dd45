"""What the robot made of its way: a bent map, times over it, and a route to a goal."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from web.messages import Goal, MapLayer, Pose, TimesLayer

from .office import frozen, long_walk, truth_at

NODES = 1500
SPACING_M = 0.25  # between experiences


def to_map(xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Office to map frame, with the bends that a map has."""
    start = long_walk()[0]
    moved = xy - start
    bend = np.column_stack([0.25 * np.sin(xy[:, 1] * 0.9), 0.2 * np.sin(xy[:, 0] * 0.7 + 1)])
    bend0 = np.array([0.25 * math.sin(start[1] * 0.9), 0.2 * math.sin(start[0] * 0.7 + 1)])
    return moved + bend - bend0


@lru_cache(maxsize=4)
def map_layer(second: int, nodes: int) -> MapLayer:
    way = long_walk()
    rows = (np.arange(nodes) * int(SPACING_M / 0.05)) % (len(way) - 8)
    xy = to_map(way[rows])
    rng = np.random.default_rng(1)
    xy += rng.normal(0, 0.05, xy.shape)
    xy += 0.03 * np.sin(second * 0.3 + np.arange(nodes) * 0.01)[:, None]
    ahead = way[rows + 7] - way[rows]
    return MapLayer(
        ids=frozen(np.arange(nodes, dtype=np.int32)),
        xy=frozen(xy.astype(np.float32)),
        heading_rad=frozen(np.arctan2(ahead[:, 1], ahead[:, 0]).astype(np.float32)),
        links=_links(nodes),
    )


@lru_cache(maxsize=4)
def _links(nodes: int) -> NDArray[np.int32]:
    way = long_walk()
    xy = way[(np.arange(nodes) * int(SPACING_M / 0.05)) % (len(way) - 8)]
    chain = np.column_stack([np.arange(nodes - 1), np.arange(1, nodes)])
    closures = []
    for i in range(40, nodes, 2):
        gaps = np.hypot(*(xy[: i - 30] - xy[i]).T) if i > 40 else np.array([9.0])
        if gaps.min() < 0.16:
            closures.append((int(gaps.argmin()), i))
    return frozen(np.vstack([chain, np.array(closures, dtype=np.int64).reshape(-1, 2)]).astype(np.int32))


def _goal_row(nodes: int) -> int:
    xy = map_layer(0, nodes).xy
    return int(np.hypot(*(xy - to_map(np.array([[9.1, 7.2]]))[0]).T).argmin())


@lru_cache(maxsize=8)
def _search(second: int, nodes: int, row: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    layer = map_layer(second, nodes)
    a, b = layer.links.T
    seconds = np.hypot(*(layer.xy[a] - layer.xy[b]).T) / 0.3 + 0.05
    graph = coo_matrix((seconds, (a, b)), shape=(nodes, nodes)).tocsr()
    return dijkstra(graph, directed=False, indices=row, return_predecessors=True)


@lru_cache(maxsize=4)
def times_layer(second: int, nodes: int, to_goal: bool) -> TimesLayer:
    row = _goal_row(nodes) if to_goal else _near(second, nodes)
    return TimesLayer(to_goal, frozen(_search(second, nodes, row)[0].astype(np.float32)))


def _near(second: int, nodes: int) -> int:
    truth = truth_at(second * 10)
    return int(np.hypot(*(map_layer(second, nodes).xy - to_map(np.array([[truth.x, truth.y]]))[0]).T).argmin())


@lru_cache(maxsize=4)
def goal_layer(tick: int, nodes: int, estimate: Pose, lost: bool) -> Goal:
    second = tick // 10
    target = _goal_row(nodes)
    seconds, before = _search(second, nodes, target)
    row = _near(second, nodes)
    chain = [row]
    while chain[-1] != target and before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    layer = map_layer(second, nodes)
    route = np.vstack([[estimate.x, estimate.y], layer.xy[chain]]).astype(np.float32)
    arrival = np.r_[0.0, seconds[row] - seconds[chain] + 0.2].astype(np.float32)
    x, y = layer.xy[target].tolist()
    way_m = float(np.hypot(*np.diff(route, axis=0).T).sum())
    return Goal(
        experience=target, x=x, y=y, state="tracking", eta_s=float(arrival[-1]), remaining_m=way_m,
        route_xy=frozen(route), route_arrival_s=frozen(arrival), lost=lost,
    )  # fmt: skip
